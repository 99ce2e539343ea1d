#!/bin/bash
# The arm64 daemon and its client on a private bus: somebody is enrolled, is let in, and a stranger is not.
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

# wait_for SECONDS WHAT COMMAND...
wait_for() {
    local end=$((SECONDS + $1)) what=$2
    shift 2
    until "$@" >/dev/null 2>&1; do
        [ $SECONDS -lt "$end" ] || {
            echo "arm64: $what" >&2
            return 1
        }
        sleep 0.2
    done
}

cat >"$run/bus.conf" <<END
<!DOCTYPE busconfig PUBLIC "-//freedesktop//DTD D-Bus Bus Configuration 1.0//EN"
 "http://www.freedesktop.org/standards/dbus/1.0/busconfig.dtd">
<busconfig>
  <listen>unix:path=$run/bus</listen>
  <policy context="default">
    <allow send_destination="*"/>
    <allow receive_sender="*"/>
    <allow own="*"/>
  </policy>
</busconfig>
END
dbus-daemon --config-file="$run/bus.conf" --nofork --nopidfile &
bus=$!
# Confined, the daemon would not start: the emulator knows no filter of calls.
cat >"$run/isotherm.conf" <<END
[sensor]
backend = replay
path = $run/slot
stale_ms = 5000
pause_ms = 5000
[door]
backend = null
[decision]
agree = 2
max_frames = 2
gap_ms = 60000
refractory_ms = 1000
[enroll]
stages = 2
timeout_ms = 300000
[process]
confine = no
[gallery]
path = $run/gallery.db
[log]
path = $run/audit.log
[bus]
address = unix:path=$run/bus
[model]
head = $source_dir/core/data/head.model
metric = $source_dir/core/data/face.metric
END
client() {
    qemu-aarch64-static "$build/enroll/isotherm" --bus "unix:path=$run/bus" "$@"
}
stand() {
    ln -sfn "$corpus/$1" "$run/slot"
}
# The log is sealed on the disk: the daemon has to read it.
records() {
    client log --count 100000 --json | tr -d ' \n'
}
saw() {
    records | grep -q "$1"
}
# count RECORD: how many there are
count() {
    records | { grep -o "$1" || true; } | wc -l
}
count_allowed() {
    count '"person":"p01","verdict":"allow"'
}
lets_in_again() {
    [ "$(count_allowed)" -gt "$allowed" ]
}

wait_for 10 'no bus' test -S "$run/bus"
qemu-aarch64-static "$build/firmware/isothermd" --config "$run/isotherm.conf" 2>"$run/daemon.log" &
daemon=$!
wait_for 60 'the daemon does not answer' client status
# The daemon is busy with a frame for seconds: who asks while nobody stands there is answered.
mkfifo "$run/hints"
client enroll p01 --timeout 280 >"$run/hints" 2>&1 &
tool=$!
exec 3<"$run/hints"
read -r _ <&3
stand p01-enrol
cat <&3
wait $tool
rm "$run/slot"
sleep 1
stand x01-v1
wait_for 90 'no verdict about a stranger' saw '"verdict":"deny"'
rm "$run/slot"
allowed=$(count_allowed) # the last frames of the enrolment may have opened already
stand p01-v1
wait_for 90 'an enrolled face is not let in' lets_in_again
[ "$(count '"verdict":"allow"')" = "$(count_allowed)" ] # nobody else
kill -TERM $daemon
wait $daemon
daemon=''
echo 'arm64: the daemon enrolled p01, refused a stranger and let p01 in'
