#!/bin/bash
# Measures a fleet: the hub, PostgreSQL and mosquitto from Debian in a directory of their own, and many simulated doors with the code of
# the fleet and of the link (memory_door.h). For each size: the first connection of all doors, a time of rest, enrolments, revocations,
# visits, an outage of the broker, one of the hub, and the naive way. Then fleet_law.py fits the law to it.
# usage: fleet_bench.sh BUILD RESULTS SIZE...      RESULTS: a folder for SIZE.txt, with lines "NAME VALUE"
# The exit status is 1 if a measurement is void, and 77 if a program is missing.
set -euo pipefail
build=$(cd "$1" && pwd)
mkdir -p "$2"
results=$(cd "$2" && pwd)
rm -f "$results"/*.txt # the law takes all files, so those of an earlier run would count
shift 2
here=$(cd "$(dirname "$0")" && pwd)
. "$here/../../fleet/fleet_parts.sh"

# Doors of one process share an event loop, which asks the kernel for all sockets again after each message. With 500 doors a process that
# took half of the processor time of the doors; a real door has one socket.
A_PROCESS=100 OUTAGE_S=20

bench() { "$build/tests/bench/fleet_bench" "$work/table" "$conninfo" "$work/hub" "$work/pids" "$broker_port" "$@"; }
now_ns() { "$build/tests/bench/fleet_bench" now; }
pin() { grep -v "^$1 " "$work/pids" >"$work/pids.new" || true; echo "$1 $2" >>"$work/pids.new"; mv "$work/pids.new" "$work/pids"; }

# One step: its figures go into the file of the results.
step() {
    echo "  $(date +%H:%M:%S) $*"
    bench "$@" >>"$out" || give_up "the step $* has failed"
}

start_servers() {
    make_database fleet-bench
    : >"$work/pids"
    pin postgres "$pid_of_postgres"
}

# Two processes, because joining is work for the processor; each has its own part of the table.
join_doors() {
    local half=$((doors / 2)) pids=() begin=$(now_ms)
    bench make "$doors" hq
    bench join 0 "$half" "$work/doors" >"$work/log/join" &
    pids+=($!)
    bench join "$half" $((doors - half)) "$work/doors" >>"$work/log/join" &
    pids+=($!)
    wait "${pids[0]}" && wait "${pids[1]}" || give_up "the doors cannot join"
    cp "$work/broker/ca.pem" "$work/doors/ca.pem"
    hub broker-config >>"$work/log/init"
    echo "join_a_second $((doors * 1000 / ($(now_ms) - begin)))" >>"$out"
}

start_doors() {
    local first n
    for ((first = 0; first < doors; first += A_PROCESS)); do
        n=$((doors - first < A_PROCESS ? doors - first : A_PROCESS))
        "$build/tests/bench/fleet_crowd" "$work/table" "$first" "$n" "$work/doors" localhost "$broker_port" \
            "https://localhost:${https_port[1]}" 2>>"$work/log/doors" &
        echo "doors $!" >>"$work/pids"
    done
}

start_and_pin_broker() {
    start_broker
    pin broker "$pid_of_broker"
}

start_and_pin_hub() {
    start_hub 1
    pin hub "$pid_of_hub1"
}

# How a broker and a hub come back. In between somebody is revoked.
outages() {
    local since
    echo "  $(date +%H:%M:%S) the broker is away for $OUTAGE_S s"
    kill -9 "$pid_of_broker"
    wait "$pid_of_broker" 2>/dev/null || true
    sleep $((OUTAGE_S / 2))
    bench revoke-one
    sleep $((OUTAGE_S / 2))
    since=$(now_ns)
    start_and_pin_broker
    step recovery broker_outage "$since"
    echo "  $(date +%H:%M:%S) the hub is away for $OUTAGE_S s"
    kill -9 "$pid_of_hub1"
    wait "$pid_of_hub1" 2>/dev/null || true
    sleep $((OUTAGE_S / 2))
    bench revoke-one
    sleep $((OUTAGE_S / 2))
    since=$(now_ns)
    start_and_pin_hub
    step answered hub_outage "$since"
}

# The naive way, with nothing else on the machine; each interval N times.
naive() {
    local interval before after
    for interval in 5 1; do
        echo "  $(date +%H:%M:%S) every door polls a table each $interval s"
        before=$(bench use)
        "$build/tests/bench/fleet_poll" "$conninfo" "$doors" "$interval" 4 | sed "s/^poll/poll$interval/" >>"$out"
        after=$(bench use)
        echo "poll${interval}_cpu_s $(echo "$before $after" | awk '{ print $2 - $1 }')" >>"$out"
    done
}

stop_all() {
    local word pid
    stop_postgres
    while read -r word pid; do
        kill -9 "$pid" 2>/dev/null || true
    done <"$work/pids"
    wait 2>/dev/null || true
    rm -rf "$work"
}

measure() {
    # With more doors fewer changes, so that each size takes some minutes.
    local revoked=$((10000 / doors)) enrolled=$((60000 / doors)) visits=$((16000 / doors)) since
    revoked=$((revoked < 2 ? 2 : revoked > 10 ? 10 : revoked))
    enrolled=$((enrolled < revoked + 2 ? revoked + 2 : enrolled > 60 ? 60 : enrolled)) # two more are revoked in the outages
    visits=$((visits < 2 ? 2 : visits > 16 ? 16 : visits))
    out=$results/$doors.txt
    echo "doors $doors" >"$out"
    echo "$doors doors"
    start_servers
    join_doors
    start_and_pin_broker
    start_and_pin_hub
    sleep 2
    since=$(now_ns)
    start_doors
    step recovery start "$since"
    step idle 60 # so long it takes until every door has asked
    step enrol "$enrolled"
    step revoke "$revoked"
    step visits visit 1
    step visits visits "$visits"
    outages
    while read -r word pid; do
        [ "$word" != doors ] || kill "$pid"
    done <"$work/pids"
    sleep 2
    naive
    grep -h "isotherm-hub:.*has taken" "$work/log/hub1" | sort | uniq -c | sort -rn | head -n 4 || true
    stop_all
}

pg=$(ls -d /usr/lib/postgresql/*/bin 2>/dev/null | tail -n 1)
for program in "$pg/initdb" /usr/sbin/mosquitto; do
    [ -x "$program" ] || {
        echo "fleet_bench: $program is missing: skipped"
        exit 77
    }
done
trap clean_up EXIT
ulimit -n "$(ulimit -Hn)"
for doors in "$@"; do
    most=$(($(ulimit -Hn) - 100)) # one broker has a descriptor for each door
    if [ "$doors" -gt "$most" ]; then
        echo "$doors doors need more than the $(ulimit -Hn) descriptors that a process may have here: $most doors"
        doors=$most
    fi
    measure
done
python3 "$here/fleet_law.py" "$results"/*.txt
