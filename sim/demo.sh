#!/bin/bash
# Runs the whole product on stored frames: starts a daemon on a private bus with an empty gallery, enrols everybody with
# the command line tool, plays the visitors at the door, and draws pictures. Tables go to files; the last lines are the
# summary of the visits and the path of the picture of one visit.
#
#   sim/demo.sh BUILD_DIR OUT_DIR [CORPUS_DIR]    (sim/stored)
#
# The exit status is not 0 if an enrolled person was refused at every visit or admitted under another name, if a stranger
# was admitted, or if a step fails. Needs the program dbus-daemon, but no system bus, no init and no terminal.
set -euo pipefail

if [ $# -lt 2 ] || [ $# -gt 3 ]; then
    echo "usage: $0 BUILD_DIR OUT_DIR [CORPUS_DIR]" >&2
    exit 2
fi
source_dir=$(cd "$(dirname "$0")/.." && pwd)
mkdir -p "$2"
build=$(cd "$1" && pwd)
out=$(cd "$2" && pwd)
corpus=$(cd "${3:-$source_dir/sim/stored}" && pwd)
model=$source_dir/core/data/head.model
metric=$source_dir/core/data/face.metric
isotherm=$build/enroll/isotherm
isothermd=$build/firmware/isothermd
simulator=$build/sim/isotherm-sim

run=$(mktemp -d)
slot=$run/slot # the link to the recording that stands in front of the camera
bus_pid='' daemon_pid=''

# shellcheck disable=SC2317 # called by the trap
clean_up()
{
    local status=$?

    trap - EXIT
    for pid in $daemon_pid $bus_pid; do
        kill "$pid" 2>/dev/null || true
        wait "$pid" 2>/dev/null || true
    done
    if [ "$status" -ne 0 ]; then
        echo "demo: failed (exit $status); the end of the daemon's log:" >&2
        tail -n 5 "$out/isothermd.log" >&2 || true
    fi
    rm -rf "$run"
    exit "$status"
}
trap clean_up EXIT
trap 'exit 130' INT
trap 'exit 143' TERM

# Prints the next step, and the file of its results in the output directory.
step()
{
    printf '%-48s  %s\n' "$1" "$out/$2"
}

start_bus()
{
    cat >"$run/bus.conf" <<END
<!DOCTYPE busconfig PUBLIC "-//freedesktop//DTD D-Bus Bus Configuration 1.0//EN"
 "http://www.freedesktop.org/standards/dbus/1.0/busconfig.dtd">
<busconfig>
  <type>isotherm-demo</type>
  <listen>unix:path=$run/bus</listen>
  <auth>EXTERNAL</auth>
  <policy context="default">
    <allow send_destination="*"/>
    <allow receive_sender="*"/>
    <allow own="*"/>
  </policy>
</busconfig>
END
    mkfifo "$run/address" "$run/hints"
    dbus-daemon --config-file="$run/bus.conf" --nofork --nopidfile --print-address=1 \
        >"$run/address" 2>"$out/dbus-daemon.log" &
    bus_pid=$!
    read -r address <"$run/address" # the bus writes this line when it listens
}

start_daemon()
{
    mkdir -p "$run/state"
    cat >"$out/isotherm.conf" <<END
[sensor]
backend = replay
path = $slot
stale_ms = 5000
pause_ms = 5000
[door]
backend = null
unlock_ms = 200
[gallery]
path = $run/state/gallery.db
[decision]
gap_ms = 150
[lockout]
failures = 0
attacks = 0
[log]
path = $run/state/audit.log
[bus]
address = $address
[model]
head = $model
metric = $metric
END
    "$isothermd" --config "$out/isotherm.conf" 2>>"$out/isothermd.log" &
    daemon_pid=$!
    for _ in $(seq 100); do
        if "$isotherm" --bus "$address" status >/dev/null 2>&1; then
            return
        fi
        kill -0 "$daemon_pid" # ends the script if the daemon has ended
        sleep 0.1
    done
    echo 'demo: the daemon does not answer' >&2
    exit 5
}

stand_before_the_camera()
{
    ln -s "$corpus/$1" "$slot.next"
    mv -T "$slot.next" "$slot"
}

# The tool prints its first line when the camera looks. Only then does the person come, so that no frame is missed.
enroll()
{
    local recording=$1 person=$2 line tool hints status=0

    "$isotherm" --bus "$address" enroll "$person" --quick --timeout 20 >"$run/hints" 2>&1 &
    tool=$!
    exec {hints}<"$run/hints"
    read -r line <&"$hints"
    stand_before_the_camera "$recording"
    { echo "$line" && cat; } <&"$hints" >"$run/enroll.txt"
    exec {hints}<&-
    wait "$tool" || status=$?
    rm -f "$slot"
    if [ "$status" -ne 0 ]; then
        cat "$run/enroll.txt" >&2
        return "$status"
    fi
    tail -n 1 "$run/enroll.txt"
}

enroll_everybody()
{
    local recording subject role rest

    while IFS=, read -r recording _ _ subject _ role rest; do
        if [ "$role" = gallery ]; then
            enroll "$recording" "$subject"
        fi
    done <"$corpus/manifest.csv"
}

# colour CODE TEXT: prints a line, in colour if standard output is a terminal and NO_COLOR (https://no-color.org) is not set.
colour()
{
    if [ -t 1 ] && [ -z "${NO_COLOR:-}" ] && [ "${TERM:-dumb}" != dumb ]; then
        printf '\033[1;%sm%s\033[0m\n' "$1" "$2"
    else
        printf '%s\n' "$2"
    fi
}

# Prints the summary of the visits, green if the door did what it should (their exit status is 0), else red.
verdict()
{
    local outcome

    outcome=$(tail -n 2 "$out/visits.txt" | tr '\n' ' ' | sed 's/ *$//')
    if [ "$visits" -eq 0 ]; then
        colour 32 "$outcome"
    else
        colour 31 "$outcome"
    fi
}

# The first recording of a role in the corpus.
first_of()
{
    awk -F, -v role="$1" '$6 == role { print $1; exit }' "$corpus/manifest.csv"
}

# Stores a policy that lets nobody in at this hour, asks what the door would decide about the first person, sends this person to the door,
# and removes the policy. Fails if the person is not refused for this reason. The daemon is started again, because it ignores frames that it
# has seen in the last ten minutes.
keep_out_by_schedule()
{
    local person visit hour

    hour=$(date -u +%H)
    person=$(awk -F, '$6 == "gallery" { print $4; exit }' "$corpus/manifest.csv")
    visit=$(first_of probe)
    # Every day, from an hour after this one to two hours after it; or in the morning, if that would pass midnight.
    if [ "$hour" -lt 21 ]; then
        printf -v hours '%02d:00-%02d:00' "$((10#$hour + 1 + 1))" "$((10#$hour + 3))"
    else
        hours=05:00-06:00
    fi
    cat >"$out/policy.json" <<END
{
  "schedules": [{"token": "other hours", "zone": "Etc/UTC", "weekly": {"monday-sunday": ["$hours"]}}],
  "access_points": [{"token": "front"}],
  "access_profiles": [{"token": "staff", "policies": [{"access_point": "front", "schedule": "other hours"}]}],
  "default_profile": "staff"
}
END
    "$isotherm" --bus "$address" policy import "$out/policy.json"
    kill "$daemon_pid"
    wait "$daemon_pid" || true
    start_daemon
    "$isotherm" --bus "$address" policy show
    "$isotherm" --bus "$address" policy test --person "$person" --at "${hours%%-*}"
    "$isotherm" --bus "$address" policy test --person "$person" && return 1
    stand_before_the_camera "$visit"
    sleep 3
    rm -f "$slot"
    sleep 1
    "$isotherm" --bus "$address" log --event visit >"$run/log.txt"
    tail -n 1 "$run/log.txt"
    tail -n 1 "$run/log.txt" | grep -q 'not-now'
    "$isotherm" --bus "$address" policy remove
}

started=$(date +%s)
rm -f "$out/isothermd.log"
start_bus
start_daemon

step 'enrolling people through the command line tool' enrolled.txt
enroll_everybody >"$out/enrolled.txt"
"$isotherm" --bus "$address" list >"$out/list.txt"

step 'visitors come to the door' visits.txt
visits=0
"$simulator" visit --corpus "$corpus" --slot "$slot" --bus "$address" --out "$out" --settle-ms 250 \
    >"$out/visits.txt" || visits=$?
"$isotherm" --bus "$address" status >"$out/status.txt"

step 'a policy with a schedule keeps a person out' policy.txt
keep_out_by_schedule >"$out/policy.txt" 2>&1

step 'accuracy on the stored frames, by the same code' eval/report.txt
mkdir -p "$out/eval"
"$simulator" eval --corpus "$corpus" --model "$model" --metric "$metric" --out "$out/eval" >"$out/eval/report.txt"

step 'pictures of a face and of a visit' isotherms.png
"$simulator" show --recording "$corpus/$(first_of gallery)" --frame 0 --what isotherms --model "$model" --out "$out/isotherms.png"
"$simulator" replay --corpus "$corpus" --visit "$(first_of probe)" --model "$model" --metric "$metric" --out "$run/replay" \
    --picture "$out/visit.png" >"$out/visit.txt"

printf '%d seconds\n\n' $(($(date +%s) - started))
verdict
echo "a visit: $out/visit.png"
exit "$visits"
