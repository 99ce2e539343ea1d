#!/bin/sh
# The daemon, the kernel's cameras and lines: a stored Z16 recording is played by a USB camera to the unmodified uvcvideo, an
# enrolled face pulls the relay of gpio-sim and a stranger does not; and what else a door has to go through.
. "$VM_SOURCE/tests/vm/usb_camera.sh"
. "$VM_SOURCE/tests/vm/daemon.sh"
corpus=$VM_SOURCE/sim/stored

# ---- the camera ----

mkdir bench
mkfifo bench/shutter
cp "$corpus/p01-enrol/recording.ini" bench/camera.ini
"$VM_BUILD/tests/vm/vm_usb_camera" bench >node &
exec 4<>bench/shutter

stand_before_the_camera() {
    ln -s "$corpus/$1" slot.next
    mv -T slot.next bench/slot
}

# The log is sealed on the disk: the daemon has to read it.
log_records() {
    "$isotherm" --bus $address log --count 100000 --json | tr -d ' \n'
}

has_logged() {
    log_records | grep -q "$1"
}

door_is() {
    "$isotherm" --bus $address status --json | grep -q "\"door-state\": *\"$1\""
}

# The camera takes a picture; the daemon answers when it has looked at it.
frame() {
    printf f >&4
    sleep 0.2
    wait_for 60 'the daemon does not answer' answers
}

# sees COMMAND...: whether it is true, after another picture
sees() {
    frame
    "$@"
}

# Nobody stands there any more, and what was seen until now has come to its end.
clear_camera() {
    rm -f bench/slot
    for _ in 1 2 3; do
        frame
    done
    wait_for 30 'the door does not lock' door_is locked
}

count_allowed() {
    log_records | grep -o '"verdict":"allow"' | wc -l
}

# A frame takes seconds here: few of them, and patience. The scores that decide are as they are.
wait_for 30 'no video node' test -s node
configure "backend = v4l2
device = $(cat node)
camera = $VM_DIRECTORY/bench/camera.ini
pause_ms = 600000
silence_ms = 600000
stale_ms = 600000" <<END
[door]
unlock_ms = 20000
refused_ms = 20000
retry_ms = 100
[decision]
agree = 2
max_frames = 2
gap_ms = 60000
refractory_ms = 1000
[enroll]
stages = 2
timeout_ms = 600000
END

# ---- the story ----

rest_inputs
start
is_at $RELAY 0 || die 'the relay is on at the start'
is_at $REFUSED 1 || die 'the red light is on at the start'
told 'the daemon answers'

mkfifo hints
"$isotherm" --bus $address enroll p01 --timeout 200 >hints 2>&1 &
tool=$!
exec 3<hints
read -r hint <&3
stand_before_the_camera p01-enrol
cat <&3 >enroll.txt &
while kill -0 $tool 2>/dev/null; do
    frame
done
wait $tool || die "p01 is not enrolled: $hint $(cat enroll.txt)"
exec 3<&-
clear_camera # the last frames may have opened the door already
told 'p01 is enrolled'

allowed=$(count_allowed)
stand_before_the_camera x01-v1
wait_for 90 'no verdict about a stranger' sees has_logged '"verdict":"deny"'
is_at $RELAY 0 || die 'a stranger pulls the relay'
wait_for 5 'the red light does not show the refusal' is_at $REFUSED 0
clear_camera
[ "$(count_allowed)" = "$allowed" ] || die 'a stranger is let in'
is_at $RELAY 0 || die 'a stranger pulls the relay'
told 'a stranger was refused: the relay is off'

stand_before_the_camera p01-v1
wait_for 90 'an enrolled face does not pull the relay' sees is_at $RELAY 1
is_at $GRANTED 1 || die 'the green light is not on'
pull $CONTACT up # at once: whoever asks the daemon first may come when the door has locked again
told 'p01 pulls the relay'
wait_for 10 'the relay is on although the door is open' is_at $RELAY 0
wait_for 5 'the door is not opened' door_is opened
[ "$(count_allowed)" -gt "$allowed" ] && has_logged '"person":"p01","verdict":"allow"' || die 'the visit is not on record'
rm bench/slot
pull $CONTACT down
wait_for 10 'the door does not lock' door_is locked
told 'p01 has passed'

pull $BUTTON down
sleep 0.1
pull $BUTTON up
wait_for 10 'the exit button does not pull the relay' is_at $RELAY 1
wait_for 60 'the relay does not drop after unlock_ms' is_at $RELAY 0
told 'the exit button lets out'

pull $TAMPER up
wait_for 10 'the buzzer is silent while the housing is open' is_at $BUZZER 1
pull $TAMPER down
wait_for 10 'the buzzer does not stop' is_at $BUZZER 0
told 'the housing is watched'

echo 0 >$sim/live
wait_for 10 'a chip that goes is no fault' door_is fault
names_lines() {
    "$isotherm" --bus $address doctor >doctor.txt && die 'the doctor is content without lines'
    grep -q 'door gpiod: relay:' doctor.txt
}
wait_for 30 'the doctor does not say what is wrong' names_lines
grep -A 1 'fault.*door' doctor.txt
echo 1 >$sim/live
rest_inputs
wait_for 20 'the door does not recover' door_is locked
kill -0 $daemon || die 'the daemon has ended'
told 'the chip went and came'

pull $BUTTON down
wait_for 10 'the exit button does not pull the relay' is_at $RELAY 1
pull $BUTTON up
kill -KILL $daemon
wait $daemon || true
"$isothermd" --config isotherm.conf --rest-door || die '--rest-door fails'
is_at $RELAY 0 || die 'the relay is on after a crash'
told 'after a crash the relay is off'

start
pull $BUTTON down
wait_for 10 'the exit button does not pull the relay' is_at $RELAY 1
"$isothermd" --config isotherm.conf --rest-door 2>busy.txt && die 'two have the lines'
grep -q "in use by 'isotherm'" busy.txt || die "who has the lines is not said: $(cat busy.txt)"
kill -TERM $daemon
wait $daemon || die 'the daemon does not end well'
is_at $RELAY 0 || die 'the relay is on after the end'
told 'ended, the relay is off'
