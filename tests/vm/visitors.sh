# For scripts of tests with visitors before a camera: `. "$VM_SOURCE/tests/vm/visitors.sh"`, after daemon.sh. It makes a bench
# (tests/openni2/virtual_camera.h) with a shutter, and has functions that play visitors of the stored corpus and check their visits.
corpus=$VM_SOURCE/sim/stored
mkdir bench
mkfifo bench/shutter
: >bench/noise # the recordings are repeated: without noise the daemon would report a stuck camera
cp "$corpus/p01-enrol/recording.ini" bench/camera.ini
exec 4<>bench/shutter

stand_before_the_camera() {
    ln -s "$corpus/$1" slot.next
    mv -T slot.next bench/slot
}

door_is() {
    client status --json | grep -q "\"door-state\": *\"$1\""
}

# Makes the camera take a picture; the daemon answers when it has computed the frame.
frame() {
    printf f >&4
    sleep 0.2
    wait_for 60 'the daemon does not answer' answers
}

# sees COMMAND...: takes another picture, and runs the command
sees() {
    frame
    "$@"
}

# Clears the scene, and waits until the visit has ended.
clear_camera() {
    rm -f bench/slot
    for _ in 1 2 3; do
        frame
    done
    wait_for 30 'the door does not lock' door_is locked
}

count_allowed() {
    count_logged '"verdict":"allow"'
}

# ---- checks for every camera ----

wake_up() {
    rest_inputs
    start
    is_at $RELAY 0 || die 'the relay is on at the start'
    is_at $REFUSED 1 || die 'the red light is on at the start'
    say 'the daemon answers'
}

p01_is_enrolled() {
    mkfifo hints
    client enroll p01 --quick --timeout 200 >hints 2>&1 &
    local tool=$!
    exec 3<hints
    read -r hint <&3
    stand_before_the_camera p01-enrol
    cat <&3 >enroll.txt &
    while kill -0 $tool 2>/dev/null; do
        frame
    done
    wait $tool || die "p01 is not enrolled: $hint $(cat enroll.txt)"
    exec 3<&-
    clear_camera # the last frames may have unlocked the door already
    say 'p01 is enrolled'
}

a_stranger_is_refused() {
    allowed=$(count_allowed)
    stand_before_the_camera x01-v1
    wait_for 90 'no verdict about a stranger' sees has_logged '"verdict":"deny"'
    is_at $RELAY 0 || die 'a stranger switches the relay'
    wait_for 5 'the red light does not show the refusal' is_at $REFUSED 0
    clear_camera
    [ "$(count_allowed)" = "$allowed" ] || die 'a stranger is let in'
    is_at $RELAY 0 || die 'a stranger switches the relay'
    say 'a stranger was refused: the relay is off'
}

p01_is_let_in() {
    allowed=$(count_allowed)
    stand_before_the_camera p01-v1
    wait_for 90 'an enrolled face does not switch the relay' sees is_at $RELAY 1
    is_at $GRANTED 1 || die 'the green light is not on'
    pull $CONTACT up # do this first: the door may lock again before the daemon answers a question
    say 'p01 switches the relay'
    wait_for 10 'the relay is on although the door is open' is_at $RELAY 0
    wait_for 5 'the door is not opened' door_is opened
    [ "$(count_allowed)" -gt "$allowed" ] && has_logged '"person":"p01","verdict":"allow"' || die 'the visit is not on record'
    rm bench/slot
    pull $CONTACT down
    wait_for 10 'the door does not lock' door_is locked
    say 'p01 has passed'
}
