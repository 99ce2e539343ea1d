#!/bin/sh
# Tests the daemon with cameras and lines of the kernel. A USB camera plays a stored Z16 recording to the unmodified uvcvideo; an enrolled
# face switches the relay of gpio-sim, and a stranger does not. Then it tests button, contact, tamper switch, and a chip that is unplugged.
. "$VM_SOURCE/tests/vm/usb/usb_camera.sh"
. "$VM_SOURCE/tests/vm/daemon.sh"
. "$VM_SOURCE/tests/vm/visitors.sh"

"$VM_BUILD/tests/vm/vm_usb_camera" bench >node &
wait_for 30 'no video node' test -s node
configure "backend = v4l2
device = $(cat node)
camera = $VM_DIRECTORY/bench/camera.ini
$(patient_sensor_conf)" <<END
[door]
unlock_ms = 20000
refused_ms = 20000
retry_ms = 100
$(patience_conf)
END

wake_up
p01_is_enrolled
a_stranger_is_refused
p01_is_let_in

pull $BUTTON down
sleep 0.1
pull $BUTTON up
wait_for 10 'the exit button does not switch the relay' is_at $RELAY 1
wait_for 60 'the relay does not drop after unlock_ms' is_at $RELAY 0
say 'the exit button switches the relay'

pull $TAMPER up
wait_for 10 'the buzzer is silent while the housing is open' is_at $BUZZER 1
pull $TAMPER down
wait_for 10 'the buzzer does not stop' is_at $BUZZER 0
say 'the tamper switch switches the buzzer'

echo 0 >$sim/live
wait_for 10 'an unplugged chip is not reported as a fault' door_is fault
names_lines() {
    client doctor >doctor.txt && die 'the doctor finds no fault without lines'
    grep -q 'door gpiod: relay:' doctor.txt
}
wait_for 30 'the doctor does not name the lines' names_lines
grep -A 1 'fault.*door' doctor.txt
echo 1 >$sim/live
rest_inputs
wait_for 20 'the door does not recover' door_is locked
kill -0 $daemon || die 'the daemon has ended'
say 'the daemon has recovered after the chip was unplugged'

pull $BUTTON down
wait_for 10 'the exit button does not switch the relay' is_at $RELAY 1
pull $BUTTON up
kill -KILL $daemon
wait $daemon || true
"$isothermd" --config isotherm.conf --rest-door || die '--rest-door fails'
is_at $RELAY 0 || die 'the relay is on after a crash'
say 'after a crash the relay is off'

start
pull $BUTTON down
wait_for 10 'the exit button does not switch the relay' is_at $RELAY 1
"$isothermd" --config isotherm.conf --rest-door 2>busy.txt && die 'two processes have the lines'
grep -q "in use by 'isotherm'" busy.txt || die "the message does not name the owner of the lines: $(cat busy.txt)"
kill -TERM $daemon
wait $daemon || die 'the daemon ends with a failure'
is_at $RELAY 0 || die 'the relay is on after the end'
say 'the daemon has ended, the relay is off'
