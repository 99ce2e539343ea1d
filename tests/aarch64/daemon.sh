#!/bin/bash
# Runs the arm64 daemon and its client on a private bus: a person is enrolled and let in, and a stranger is refused.
#
#   daemon.sh BUILD
set -euo pipefail
source_dir=$(cd "$(dirname "$0")/../.." && pwd)
build=$(cd "$1" && pwd)
corpus=$source_dir/sim/stored
export OPENBLAS_NUM_THREADS=1 QEMU_LD_PREFIX=$source_dir/build/aarch64-root
run=$(mktemp -d)
daemon='' bus=''
finish() {
    code=$?
    trap - EXIT
    for process in $daemon $bus; do
        kill "$process" 2>/dev/null || true
    done
    [ $code -eq 0 ] || tail -n 20 "$run/daemon.log" >&2 || true
    rm -rf "$run"
    exit $code
}
trap finish EXIT

# wait_for SECONDS WHAT COMMAND...: waits until the command succeeds. An idle machine needs at most SECONDS; it fails after six times as
# many.
wait_for() {
    local end=$((SECONDS + 6 * $1)) what=$2
    shift 2
    until "$@" >/dev/null 2>&1; do
        [ $SECONDS -lt "$end" ] || {
            echo "arm64: $what" >&2
            return 1
        }
        sleep 0.2
    done
}

story_directory=$run story_source=$source_dir
client() {
    qemu-aarch64-static "$build/enroll/isotherm" --bus "$story_address" "$@"
}
. "$source_dir/tests/support/door_story.sh"
bus_conf >"$run/bus.conf"
dbus-daemon --config-file="$run/bus.conf" --nofork --nopidfile &
bus=$!
# The daemon cannot confine itself here, because the emulator has no filter of system calls.
cat >"$run/isotherm.conf" <<END
[sensor]
backend = replay
path = $run/slot
repeats = yes
$(patient_sensor_conf)
[door]
backend = null
[process]
confine = no
$(patience_conf)
$(stores_conf)
END
stand() {
    ln -sfn "$corpus/$1" "$run/slot"
}
count_allowed() {
    count_logged '"person":"p01","verdict":"allow"'
}
lets_in_again() {
    [ "$(count_allowed)" -gt "$allowed" ]
}

wait_for 10 'no bus' test -S "$run/bus"
qemu-aarch64-static "$build/firmware/isothermd" --config "$run/isotherm.conf" 2>"$run/daemon.log" &
daemon=$!
wait_for 60 'the daemon does not answer' client status
# The daemon computes a frame for seconds, so ask it only while nobody is before the camera.
mkfifo "$run/hints"
client enroll p01 --quick --timeout 500 >"$run/hints" 2>&1 &
tool=$!
exec 3<"$run/hints"
read -r _ <&3
stand p01-enrol
cat <&3
wait $tool
rm "$run/slot"
sleep 1
stand x01-v1
wait_for 90 'no verdict about a stranger' has_logged '"verdict":"deny"'
rm "$run/slot"
allowed=$(count_allowed) # the last frames of the enrolment may have opened already
stand p01-v1
wait_for 90 'an enrolled face is not let in' lets_in_again
[ "$(count_logged '"verdict":"allow"')" = "$(count_allowed)" ] # no other person was let in
kill -TERM $daemon
wait $daemon
daemon=''
echo 'arm64: the daemon enrolled p01, refused a stranger and let p01 in'
