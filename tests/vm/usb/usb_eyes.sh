#!/bin/sh
# Tests the whole stereo path: two grey USB cameras show the surface of a stored recording under a dotted light, the unmodified uvcvideo
# makes video nodes for them, and the daemon matches their pictures. An enrolled face switches the relay of gpio-sim, and a stranger does
# not.
. "$VM_SOURCE/tests/vm/usb/usb_camera.sh"
. "$VM_SOURCE/tests/vm/daemon.sh"
. "$VM_SOURCE/tests/vm/visitors.sh"

"$VM_BUILD/tests/vm/vm_usb_eyes" bench >nodes &
both_nodes() {
    [ "$(wc -l <nodes)" -eq 2 ]
}
wait_for 60 'no two video nodes' both_nodes
# Each request at the shutter makes one pair, even on a slow machine.
configure "backend = v4l2-stereo
left = $(sed -n 1p nodes)
right = $(sed -n 2p nodes)
calibration = $VM_DIRECTORY/bench/rig.ini
pair_ms = 1000
$(patient_sensor_conf)" <<END
[door]
unlock_ms = 20000
refused_ms = 20000
$(patience_conf)
END

wake_up
p01_is_enrolled
a_stranger_is_refused
p01_is_let_in
kill -TERM $daemon
wait $daemon || die 'the daemon ends with a failure'
is_at $RELAY 0 || die 'the relay is on after the end'
say 'the daemon has ended, the relay is off'
