#!/bin/sh
# Tests the daemon under the address sanitizer while cables are unplugged, cameras stall and lines disappear: the daemon keeps running, and
# it has no leak at its end.
. "$VM_SOURCE/tests/vm/usb/usb_camera.sh"
. "$VM_SOURCE/tests/vm/daemon.sh"

# A small empty picture, because this test needs no faces.
mkdir -p wall
cat >wall/recording.ini <<END
[recording]
format = 1
sensor = astra
[depth]
projection = pinhole
width_px = 160
height_px = 120
fx_px = 144
fy_px = 144
cx_px = 79.5
cy_px = 59.5
unit_mm = 1
END
configure "backend = v4l2
device = /dev/video0
camera = $VM_DIRECTORY/wall/recording.ini
silence_ms = 1000
retry_ms = 50
retry_max_ms = 200" <<END
[door]
unlock_ms = 1000
retry_ms = 50
END
export ASAN_OPTIONS=exitcode=66:detect_leaks=1
start
say 'the daemon answers'
"$VM_BUILD/tests/vm/vm_usb_endurance" || die 'see above'
kill -0 $daemon || die 'the daemon has ended'
kill -TERM $daemon
code=0
wait $daemon || code=$?
! grep -A 40 'Sanitizer' daemon.log || die 'the sanitizer has reported a fault'
[ $code -eq 0 ] || die "the daemon ends with $code"
is_at $RELAY 0 || die 'the relay is on after the end'
say 'the daemon has run all the time and has no leak'
