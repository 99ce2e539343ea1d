#!/bin/bash
# Measures what the daemon needs while nobody is before its camera: processor time, wake-ups and examined frames a second, first with
# every frame examined (rest_s = 0), then at rest; in all, and for each of its threads. Each stored room is first played from its PNG files at the
# rate of its time stamps, and then stands before the virtual camera of the tests (tests/openni2), if BUILD has it, which OpenNI2 runs at 30
# frames a second. The thread of that camera, "virtual", reads PNG files where a camera has hardware: it is printed, but left out of the sums.
# It checks no limit.
# usage: idle.sh BUILD [SECONDS [RECORDING...]]    (BUILD with isothermd, isotherm and the virtual camera; recordings of sim/stored)
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

# Prints a line for each thread: its id and name, the time that it ran (ns), and how often it waited for something.
threads() {
    local task
    for task in "/proc/$daemon_pid"/task/*; do
        echo "${task##*/} $(tr ' ' _ <"$task/comm") $(cut -d ' ' -f 1 "$task/schedstat") \
            $(sed -n 's/^voluntary_ctxt_switches:[[:blank:]]*//p' "$task/status")"
    done
}

# Prints how many frames the sensor has given.
frames() {
    status | sed -n 's/^ *"frames": \([0-9]*\),\{0,1\}$/\1/p'
}

# The options of the sensor that plays the PNG files in $run/frames.
replay_conf() {
    printf '%s\n' 'backend = replay' "path = $run/frames" 'loop = yes' 'repeats = yes'
}

# The options of the virtual camera, before which the recording is, each frame with noise of its own.
camera_conf() {
    echo 'backend = openni2'
}

set_up_camera() {
    rm -rf "$run/bench"
    mkdir "$run/bench"
    cp "$run/frames/recording.ini" "$run/bench/camera.ini"
    ln -s "$run/frames" "$run/bench/slot"
    touch "$run/bench/noise"
    export ISOTHERM_BENCH=$run/bench LD_LIBRARY_PATH=$build/tests/openni2/runtime
}

# usage: measure RECORDING SENSOR REST_S    (SENSOR is replay or camera)
measure() {
    local recording=$1 sensor=$2 rest_s=$3 before
    rm -f "$run"/gallery.db* "$run"/audit.log*
    cat >"$run/isotherm.conf" <<END
[sensor]
$("${sensor}_conf")
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
    before=$(frames)
    threads >"$run/before"
    sleep "$seconds"
    threads >"$run/after"
    awk -v seconds="$seconds" -v frames="$(($(frames) - before))" -v what="$recording, $sensor, rest_s = $rest_s" '
        FNR == NR { ran[$1] = $3; waited[$1] = $4; next }
        {
            share[FNR] = ($3 - ran[$1]) / seconds / 1e7; wakes[FNR] = ($4 - waited[$1]) / seconds; name[FNR] = $2
            if (name[FNR] != "virtual") { all_share += share[FNR]; all_wakes += wakes[FNR] }
        }
        END {
            printf "%s: %.1f %% of a core, %.0f wake-ups a second, %.1f frames a second from the sensor\n",
                what, all_share, all_wakes, frames / seconds
            for (i = 1; i <= FNR; i++) {
                printf "    thread %-16s %5.2f %% of a core, %5.1f wake-ups a second\n", name[i], share[i], wakes[i]
            }
        }' "$run/before" "$run/after"
    end "$daemon_pid"
    daemon_pid=''
}

for recording in "${recordings[@]}"; do
    rm -rf "$run/frames"
    cp -r "$source_dir/sim/stored/$recording" "$run/frames"
    sensors=replay
    if [ -d "$build/tests/openni2/runtime" ]; then
        set_up_camera
        sensors='replay camera'
    fi
    for sensor in $sensors; do
        measure "$recording" "$sensor" 0
        measure "$recording" "$sensor" 2
    done
done
