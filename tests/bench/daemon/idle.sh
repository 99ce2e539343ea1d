#!/bin/bash
# Measures what the daemon needs while nobody is before its camera: processor time, wake-ups and examined frames a second, first with
# every frame examined (rest_s = 0), then at rest. The camera is a stored room, played at the rate of its time stamps. It checks no limit.
# usage: idle.sh BUILD [SECONDS [RECORDING...]]    (BUILD with isothermd and isotherm; recordings of sim/stored)
set -euo pipefail
build=$(cd "$1" && pwd)
seconds=${2:-30}
recordings=("${@:3}")
[ ${#recordings[@]} -gt 0 ] || recordings=(none-nobody1 none-nobody2)
source_dir=$(cd "$(dirname "$0")/../../.." && pwd)
run=$(mktemp -d -p "${TMPDIR:-/var/tmp}")
bus_pid='' daemon_pid=''

end() {
    local pid=$1
    [ -z "$pid" ] || kill "$pid" 2>/dev/null || true
    [ -z "$pid" ] || wait "$pid" 2>/dev/null || true
}

clean_up() {
    status=$?
    trap - EXIT
    end "$daemon_pid"
    end "$bus_pid"
    [ "$status" -eq 0 ] || tail -n 30 "$run/isothermd.log" >&2 || true
    rm -rf "$run"
    exit "$status"
}
trap clean_up EXIT

story_directory=$run story_source=$source_dir
. "$source_dir/tests/support/door_story.sh"
bus_conf >"$run/bus.conf"
dbus-daemon --config-file="$run/bus.conf" --nofork --nopidfile 2>/dev/null &
bus_pid=$!
until [ -S "$run/bus" ]; do
    kill -0 "$bus_pid"
    sleep 0.02
done

status() {
    "$build/enroll/isotherm" --bus "$story_address" --json status 2>/dev/null
}

# Prints: ticks of the processor, times that a thread waited for something, frames from the sensor.
counts() {
    local ticks waits frames
    ticks=$(sed 's/.*) //' "/proc/$daemon_pid/stat" | awk '{ print $12 + $13 }')
    waits=$(cat "/proc/$daemon_pid"/task/*/status | awk '/^voluntary_ctxt_switches/ { n += $2 } END { print n }')
    frames=$(status | sed -n 's/^ *"frames": \([0-9]*\),\{0,1\}$/\1/p')
    echo "$ticks $waits $frames"
}

# usage: measure RECORDING REST_S
measure() {
    local recording=$1 rest_s=$2 before after
    rm -rf "$run/frames" "$run"/gallery.db* "$run"/audit.log*
    cp -r "$source_dir/sim/stored/$recording" "$run/frames"
    cat >"$run/isotherm.conf" <<END
[sensor]
backend = replay
path = $run/frames
loop = yes
repeats = yes
rest_s = $rest_s
$(stores_conf)
END
    "$build/firmware/isothermd" --config "$run/isotherm.conf" 2>"$run/isothermd.log" &
    daemon_pid=$!
    until status >/dev/null; do
        kill -0 "$daemon_pid"
        sleep 0.1
    done
    sleep 5 # rest_s, and some time
    before=$(counts)
    sleep "$seconds"
    after=$(counts)
    end "$daemon_pid"
    daemon_pid=''
    echo "$before $after" | awk -v seconds="$seconds" -v tick="$(getconf CLK_TCK)" -v what="$recording, rest_s = $rest_s" '{
        printf "%s: %.1f %% of a core, %.0f wake-ups a second, %.1f frames a second from the sensor\n",
            what, 100 * ($4 - $1) / tick / seconds, ($5 - $2) / seconds, ($6 - $3) / seconds }'
}

for recording in "${recordings[@]}"; do
    measure "$recording" 0
    measure "$recording" 2
done
