#!/bin/sh
# isotherm-screen on the kernel's mode setting: the monitor shows the picture that the program writes as PNG, pixel for pixel. It does so
# after the monitor was lost and found, upright and turned, and the program outlives a machine without a card.
set -eu
screen=$VM_BUILD/enroll/screen/isotherm-screen
same=$VM_BUILD/tests/vm/vm_same_picture
line=/dev/ttyS2
shots=$VM_BUILD/vm # of the host: QEMU writes there
export HOME=/root XDG_CACHE_HOME=/run/test/cache

fail() {
    echo "screen_monitor: $1"
    exit 1
}

# wait_for SECONDS COMMAND...: until the command succeeds. The machine is slow.
wait_for() {
    left=$1
    shift
    until "$@"; do
        left=$((left - 1))
        [ "$left" -gt 0 ] || return 1
        sleep 1
    done
}

start() {
    : >screen.log
    "$screen" --bus unix:path=/nonexistent --verbose "$@" >screen.log 2>&1 &
    pid=$!
}

shows_picture() {
    grep -q '^out-of-service: ' screen.log
}

# Asks for a picture and looks whether it is there. The empty line ends what the greeting of QEMU's command line, echoed before `stty`,
# may have left there.
has_shot() {
    [ ! -s "/run/host$shots/$1.ppm" ] || return 0
    printf '\nscreendump %s/%s.ppm gpu0 0\n' "$shots" "$1" >$line
    return 1
}

# shoot NAME: a picture of what the monitor shows. QEMU writes it on the host; run.sh has removed those of an earlier run.
shoot() {
    wait_for 60 has_shot "$1" || fail "no picture $1"
    sleep 2
}

stop() {
    kill -TERM "$pid"
    wait "$pid" || fail "the program ended with $?"
}

# Before there is a card: the program waits for one.
start --seconds 120
sleep 3
kill -0 "$pid" || fail 'the program ended without a graphics card'
! shows_picture || fail 'it shows a picture without a graphics card'

modprobe -d "$VM_CACHE/root" virtio_gpu || fail 'no driver'
wait_for 60 test -e /dev/dri/card0 || fail 'no graphics card'
stty -F $line raw -echo
mkdir -p /run/host
mount -t 9p -o trans=virtio,version=9p2000.L,ro,cache=none host /run/host

wait_for 60 shows_picture || fail 'it does not find the card that was added'
status=$(echo /sys/class/drm/card0-*/status)
[ "$(cat "$status")" = connected ] || fail "the monitor is $(cat "$status")"
for turn in 0 180; do
    "$screen" --bus unix:path=/nonexistent --png "png$turn" --size 800x480 --rotate $turn --seconds 2
done
shoot screen_monitor_1
"$same" png0/00000.png "/run/host$shots/screen_monitor_1.ppm" || fail 'the monitor shows another picture than the file'
! "$same" png180/00000.png "/run/host$shots/screen_monitor_1.ppm" || fail 'a turned picture counts as the same'

# The monitor is lost and found.
echo off >"$status"
sleep 4
kill -0 "$pid" || fail 'the program ended when the monitor was lost'
: >screen.log
echo on >"$status"
sleep 6
kill -0 "$pid" || fail 'the program ended when the monitor was found'
shoot screen_monitor_2
"$same" png0/00000.png "/run/host$shots/screen_monitor_2.ppm" || fail 'another picture after the monitor was lost'
stop

start --rotate 180
wait_for 60 shows_picture || fail 'no turned picture'
shoot screen_monitor_3
"$same" png180/00000.png "/run/host$shots/screen_monitor_3.ppm" || fail 'the turned picture differs'
stop
echo 'the monitor shows what the files have'
