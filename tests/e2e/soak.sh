#!/bin/bash
# Runs the whole daemon under load for a long time: one person is enrolled, stored visits are repeated as fast as the daemon takes frames,
# and a client asks for its state. The script prints the memory in use at intervals. It fails if the memory has grown by more than a few
# percent after the first quarter, or if the daemon prints anything unexpected (such as a sanitizer's report) or ends with a failure.
# usage: soak.sh BUILD FRAMES [RECORDING...]      of sim/stored; default: two people, a stranger, nobody, a photograph
# Set GAP_MS=5000 in the environment for a build so slow that frames are seconds apart, so that a visit does not end between two frames.
set -euo pipefail
build=$(cd "$1" && pwd)
frames=$2
shift 2
source_dir=$(cd "$(dirname "$0")/../.." && pwd)
export TSAN_OPTIONS=suppressions=$source_dir/tests/support/devices/openni2_locks.supp
# The sanitizer must not keep freed memory, which would look like growth.
export ASAN_OPTIONS=${ASAN_OPTIONS:-quarantine_size_mb=8}
recordings=("$@")
[ $# -gt 0 ] || recordings=(p01-v1 p02-v1 x01-v1 none-nobody1 none-photo1)
run=$(mktemp -d)
bus_pid='' daemon_pid=''

clean_up() {
    status=$?
    trap - EXIT
    for pid in $daemon_pid $bus_pid; do
        kill "$pid" 2>/dev/null || true
        wait "$pid" 2>/dev/null || true
    done
    [ "$status" -eq 0 ] || tail -n 30 "$run/isothermd.log" >&2 || true
    rm -rf "$run"
    exit "$status"
}
trap clean_up EXIT

cat >"$run/bus.conf" <<END
<!DOCTYPE busconfig PUBLIC "-//freedesktop//DTD D-Bus Bus Configuration 1.0//EN"
 "http://www.freedesktop.org/standards/dbus/1.0/busconfig.dtd">
<busconfig><type>soak</type><listen>unix:path=$run/bus</listen><auth>EXTERNAL</auth>
<policy context="default"><allow send_destination="*"/><allow receive_sender="*"/><allow own="*"/></policy></busconfig>
END
mkfifo "$run/address"
dbus-daemon --config-file="$run/bus.conf" --nofork --nopidfile --print-address=1 >"$run/address" 2>/dev/null &
bus_pid=$!
read -r address <"$run/address"

ln -s "$source_dir/sim/stored/p01-enrol" "$run/slot"
cat >"$run/isotherm.conf" <<END
[sensor]
backend = replay
path = $run/slot
pace = asap
loop = yes
repeats = yes
stale_ms = 5000
pause_ms = 5000
[door]
unlock_ms = 200
[decision]
gap_ms = ${GAP_MS:-1000}
refractory_ms = 500
[lockout]
failures = 0
attacks = 0
[gallery]
path = $run/gallery.db
[log]
path = $run/audit.log
sync = no
[bus]
address = $address
[model]
head = $source_dir/core/data/head.model
metric = $source_dir/core/data/face.metric
END
"$build/firmware/isothermd" --config "$run/isotherm.conf" 2>"$run/isothermd.log" &
daemon_pid=$!

# Enrol a person, so that the metric has a template to compare with.
for _ in $(seq 600); do
    ! "$build/enroll/isotherm" --bus "$address" status >/dev/null 2>&1 || break
    kill -0 "$daemon_pid"
    sleep 0.1
done
"$build/enroll/isotherm" --bus "$address" enroll p01 --quick --timeout 100 >"$run/enroll.txt" 2>&1 || {
    cat "$run/enroll.txt" >&2
    exit 1
}

state() { # one number of the status; nothing if the daemon is too busy to tell
    { "$build/enroll/isotherm" --bus "$address" --json status 2>/dev/null || true; } |
        sed -n "s/^ *\"$1\": \([0-9]*\),\{0,1\}\$/\1/p"
}

memory_kb() {
    sed -n 's/^VmRSS:[^0-9]*\([0-9]*\) kB/\1/p' "/proc/$daemon_pid/status"
}

seen=0 next=0 turn=0 settled='' largest=0
step=$(((frames + 19) / 20))
while [ "$seen" -lt "$frames" ]; do
    kill -0 "$daemon_pid"
    sleep 1
    turn=$((turn + 1))
    ln -sfn "$source_dir/sim/stored/${recordings[$((turn % ${#recordings[@]}))]}" "$run/slot.new"
    mv -T "$run/slot.new" "$run/slot"
    seen=$(state frames)
    seen=${seen:-0}
    if [ "$seen" -ge "$next" ]; then
        now=$(memory_kb)
        printf '%7d frames %8d kB\n' "$seen" "$now"
        next=$((seen + step))
        [ "$seen" -lt $((frames / 4)) ] || settled=${settled:-$now}
        [ "$now" -le "$largest" ] || largest=$now
    fi
done
# The log is sealed on the disk, so the daemon must read it. While visits go on, the log has no end.
rm "$run/slot"
records=$("$build/enroll/isotherm" --bus "$address" log --count 100000 --json | tr -d ' \n')
count() {
    { grep -o "$1" <<<"$records" || true; } | wc -l
}
visits=$(count '"event":"visit"')
allowed=$(count '"verdict":"allow"')
kill -TERM "$daemon_pid"
wait "$daemon_pid" || { echo "the daemon ended with $?" >&2; exit 1; }
daemon_pid=''
if grep -E 'ERROR: |WARNING: ThreadSanitizer|runtime error' "$run/isothermd.log" >&2; then
    exit 1
fi
echo "$seen frames, $visits visits, $allowed let in; settled at $settled kB, at most $largest kB"
[ "$allowed" -gt 0 ] || { echo 'the enrolled person was never let in' >&2; exit 1; }
[ "$largest" -le $((settled + settled / 20)) ] || { echo 'memory has grown' >&2; exit 1; }
