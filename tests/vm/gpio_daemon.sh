#!/bin/sh
# The daemon on lines of the kernel: stored frames in front of the camera, our hands on the wires.
. "$VM_SOURCE/tests/vm/gpio_sim.sh"
corpus=$VM_SOURCE/sim/stored
isotherm=$VM_BUILD/enroll/isotherm
isothermd=$VM_BUILD/firmware/isothermd
sim=/sys/kernel/config/gpio-sim/door

die() {
    echo "FAILED: $1"
    tail -n 20 daemon.log
    "$isotherm" --bus $address doctor || true
    exit 1
}

# ---- the wires ----

RELAY=0 GRANTED=1 REFUSED=2 BUZZER=3 CONTACT=5 BUTTON=6 TAMPER=7
mkdir -p $sim/bank
echo 10 >$sim/bank/num_lines
# By name, as boards have them: the number of a chip is another one when it comes back.
for number in 0 1 2 3 4 5 6 7; do
    mkdir $sim/bank/line$number
    echo DOOR$number >$sim/bank/line$number/name
done
echo 1 >$sim/live

line() {
    echo "/sys/devices/platform/$(cat $sim/dev_name)/$(cat $sim/bank/chip_name)/sim_gpio$1"
}

voltage() {
    cat "$(line "$1")/value"
}

pull() {
    echo "pull-$2" >"$(line "$1")/pull"
}

# Shut, not pressed, closed; as wired below.
rest_inputs() {
    pull $CONTACT down
    pull $BUTTON up
    pull $TAMPER down
}

uptime_s() {
    cut -d . -f 1 /proc/uptime
}

# wait_for SECONDS WHAT COMMAND...: until the command is true
wait_for() {
    until_s=$(($(uptime_s) + $1)) what=$2
    shift 2
    until "$@"; do
        [ "$(uptime_s)" -le $until_s ] || die "$what"
        sleep 0.05
    done
}

is_at() {
    [ "$(voltage "$1")" = "$2" ]
}

# ---- the appliance ----

cat >bus.conf <<END
<!DOCTYPE busconfig PUBLIC "-//freedesktop//DTD D-Bus Bus Configuration 1.0//EN"
 "http://www.freedesktop.org/standards/dbus/1.0/busconfig.dtd">
<busconfig>
  <listen>unix:path=$VM_DIRECTORY/bus</listen>
  <policy context="default">
    <allow send_destination="*"/>
    <allow receive_sender="*"/>
    <allow own="*"/>
  </policy>
</busconfig>
END
address=unix:path=$VM_DIRECTORY/bus
dbus-daemon --config-file=bus.conf --fork --nopidfile

# A frame takes seconds here: few of them, and patience. The scores that decide are as they are.
sed "s#^path = .*#path = $VM_DIRECTORY/slot#" "$VM_SOURCE/board/qemu/isotherm.conf" >isotherm.conf
cat >>isotherm.conf <<END
[door]
unlock_ms = 3000
refused_ms = 2000
retry_ms = 100
[decision]
agree = 1
max_frames = 1
gap_ms = 60000
refractory_ms = 1000
[enroll]
stages = 2
timeout_ms = 600000
[gallery]
path = $VM_DIRECTORY/gallery.db
[log]
path = $VM_DIRECTORY/audit.log
[bus]
address = $address
[model]
head = $VM_SOURCE/core/data/head.model
cohort = $VM_SOURCE/core/data/cohort.templates
END

answers() {
    "$isotherm" --bus $address status >/dev/null 2>&1
}

start() {
    "$isothermd" --config isotherm.conf 2>>daemon.log &
    daemon=$!
    wait_for 60 'the daemon does not answer' answers
}

stand_before_the_camera() {
    ln -s "$corpus/$1" slot.next
    mv -T slot.next slot
}

has_logged() {
    grep -q "$1" audit.log
}

door_is() {
    "$isotherm" --bus $address status --json | grep -q "\"door-state\": *\"$1\""
}

# Nobody stands there any more, and what was seen until now has come to its end.
clear_camera() {
    rm -f slot
    for _ in 1 2 3; do
        wait_for 60 'the daemon does not answer' answers
        sleep 0.1
    done
    wait_for 30 'the door does not lock' door_is locked
}

count_allowed() {
    grep -c '"verdict":"allow"' audit.log || true
}

told() {
    printf '%6.1f s  %s\n' "$(cut -d ' ' -f 1 /proc/uptime)" "$1"
}

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
cat <&3 >enroll.txt
wait $tool || die "p01 is not enrolled: $hint $(cat enroll.txt)"
exec 3<&-
clear_camera # the last frames may have opened the door already
told 'p01 is enrolled'

allowed=$(count_allowed)
stand_before_the_camera x01-v1
wait_for 90 'no verdict about a stranger' has_logged '"verdict":"deny"'
is_at $RELAY 0 || die 'a stranger pulls the relay'
wait_for 5 'the red light does not show the refusal' is_at $REFUSED 0
clear_camera
[ "$(count_allowed)" = "$allowed" ] || die 'a stranger is let in'
is_at $RELAY 0 || die 'a stranger pulls the relay'
told 'a stranger was refused: the relay is off'

stand_before_the_camera p01-v1
wait_for 90 'an enrolled face does not pull the relay' is_at $RELAY 1
is_at $GRANTED 1 || die 'the green light is not on'
[ "$(count_allowed)" -gt "$allowed" ] && has_logged '"person":"p01","verdict":"allow"' || die 'the visit is not on record'
told 'p01 pulls the relay'
pull $CONTACT up
wait_for 10 'the relay is on although the door is open' is_at $RELAY 0
wait_for 5 'the door is not opened' door_is opened
rm slot
pull $CONTACT down
wait_for 10 'the door does not lock' door_is locked
told 'p01 has passed'

pull $BUTTON down
sleep 0.1
pull $BUTTON up
wait_for 10 'the exit button does not pull the relay' is_at $RELAY 1
wait_for 20 'the relay does not drop after unlock_ms' is_at $RELAY 0
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
