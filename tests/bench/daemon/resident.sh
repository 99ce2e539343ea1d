#!/bin/bash
# Measures the daemon with many enrolled people: the seconds from its start until it answers, and its memory after some frames, now and at
# most. It checks no limit.
# usage: resident.sh BUILD PEOPLE [FRAMES [TEMPLATES [ADAPT]]]    (BUILD with bench_gallery, isothermd, isotherm)
# TEMPLATES of each person (1); ADAPT (no): whether the metric adapts to the people
set -euo pipefail
build=$(cd "$1" && pwd)
people=$2
frames=${3:-100}
templates=${4:-1}
adapt=${5:-no}
source_dir=$(cd "$(dirname "$0")/../../.." && pwd)
run=$(mktemp -d -p "${TMPDIR:-/var/tmp}")
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

"$build/tests/bench/bench_gallery" --dir "$run" --people "$people" --templates "$templates" --metric "$source_dir/core/data/face.metric" --keep 1

story_directory=$run story_source=$source_dir
. "$source_dir/tests/support/door_story.sh"
bus_conf >"$run/bus.conf"
dbus-daemon --config-file="$run/bus.conf" --nofork --nopidfile 2>/dev/null &
bus_pid=$!
until [ -S "$run/bus" ]; do
    kill -0 "$bus_pid"
    sleep 0.02
done

cp -r "$source_dir/sim/stored/p01-v1" "$run/frames"
cp "$source_dir/core/data/head.model" "$source_dir/core/data/face.metric" "$run"
cat >"$run/isotherm.conf" <<END
[sensor]
backend = replay
path = $run/frames
pace = asap
loop = yes
repeats = yes
[lockout]
failures = 0
attacks = 0
[gallery]
path = $run/gallery.db
capacity = $people
[log]
path = $run/audit.log
sync = no
[bus]
address = $story_address
[match]
adapt = $adapt
[model]
head = $run/head.model
metric = $run/face.metric
END

status() {
    "$build/enroll/isotherm" --bus "$story_address" --json status 2>/dev/null
}
begin=$(date +%s%N)
"$build/firmware/isothermd" --config "$run/isotherm.conf" 2>"$run/isothermd.log" &
daemon_pid=$!
until status >/dev/null; do
    kill -0 "$daemon_pid"
    sleep 0.02
done
ready=$(date +%s%N)
# The processor time until then: user and system time, in ticks.
ticks=$(sed 's/.*) //' "/proc/$daemon_pid/stat" | awk '{ print $12 + $13 }')

seen=0
while [ "${seen:-0}" -lt "$frames" ]; do
    kill -0 "$daemon_pid"
    sleep 0.2
    seen=$(status | sed -n 's/^ *"frames": \([0-9]*\),\{0,1\}$/\1/p')
done
echo "isothermd, $people people with $templates templates each, adapt = $adapt: answers after $(((ready - begin) / 1000000)) ms ($((ticks * 1000 / $(getconf CLK_TCK))) ms of processor time)"
awk '/^VmRSS|^RssAnon/ { printf "%s %.1f MiB\n", $1, $2 / 1024 } /^VmHWM/ { printf "at most %.1f MiB\n", $2 / 1024 }' \
    "/proc/$daemon_pid/status"
