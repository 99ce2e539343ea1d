#!/bin/sh
# Runs the programs with little memory: with rising limits of the address space and with stacks of 8192 and of 256 KiB. Each program must
# do its work or end with one line and an exit code. It must not end by a signal, hang (OpenBLAS's threads at the exit), or print a message
# of several lines. The daemon serves its client on a bus; a corpus is enrolled, played to the appliance, and evaluated with two threads.
# usage: limits.sh SOURCE BUILD
set -eu
story_source=$(cd "$1" && pwd)
build=$(cd "$2" && pwd)
story_directory=$(mktemp -d)
. "$story_source/tests/support/door_story.sh"
unset OPENBLAS_NUM_THREADS OMP_NUM_THREADS
command -v dbus-daemon >/dev/null || {
    echo "no dbus-daemon" >&2
    exit 77
}

bus_conf >"$story_directory/bus.conf"
dbus-daemon --config-file="$story_directory/bus.conf" --nofork --nosyslog 2>/dev/null &
bus=$!
trap 'kill "$bus"; rm -rf "$story_directory"' EXIT

# A corpus of two people and of a photograph, all from the stored corpus.
corpus=$story_directory/corpus
mkdir "$corpus"
for recording in p01-enrol p01-v1 p02-enrol p02-v1 none-photo1; do
    ln -s "$story_source/sim/stored/$recording" "$corpus/$recording"
done
grep -E '^(recording|p01-enrol|p01-v1|p02-enrol|p02-v1|none-photo1),' "$story_source/sim/stored/manifest.csv" >"$corpus/manifest.csv"
{
    printf '[sensor]\npath = %s/p01-v1\nloop = yes\n' "$corpus"
    stores_conf
} >"$story_directory/isotherm.conf"

tried=0
worked=0
faults=0

# try SECONDS COMMAND...: runs the command under the limits $stack_kib and $memory_mib. A command that does not end gets SIGTERM after
# SECONDS.
try() {
    patience=$1
    shift
    code=0
    (
        ulimit -c 0
        ulimit -s "$stack_kib"
        ulimit -v $((memory_mib * 1024))
        exec timeout -k 60 "$patience" "$@"
    ) >"$story_directory/out" 2>"$story_directory/err" || code=$?
    judge "$@"
}

# 124: timeout ended it, which is right for a daemon; 137: it ignored SIGTERM. Lines with the progress of a long command are not faults.
judge() {
    tried=$((tried + 1))
    lines=$(grep -cvE ' left$|: [0-9]+ of [0-9]+' "$story_directory/err" || true)
    if [ "$code" -eq 0 ] || [ "$code" -eq 124 ]; then
        worked=$((worked + 1))
    elif [ "$code" -gt 5 ] || [ "$lines" -ne 1 ]; then
        faults=$((faults + 1))
        echo "stack $stack_kib KiB, memory $memory_mib MiB: exit $code: $*" >&2
        head -5 "$story_directory/err" >&2
    fi
}

run_all() {
    try 60 "$build/firmware/isothermd" --check-config --config "$story_directory/isotherm.conf"
    try 60 "$build/enroll/isotherm" --bus "unix:path=$story_directory/nobody" list
    try 60 "$build/enroll/isotherm" --help
    rm -rf "$story_directory/replay" "$story_directory/eval"
    try 120 "$build/sim/isotherm-sim" replay --corpus "$corpus" --out "$story_directory/replay"
    try 120 "$build/sim/isotherm-sim" eval --corpus "$corpus" --threads 2 --out "$story_directory/eval"
    try 2 "$build/firmware/isothermd" --config "$story_directory/isotherm.conf"
}

for stack_kib in 8192 256; do
    for memory_mib in 100 125 150 175 200 250 300 400; do
        run_all
    done
done

# The smallest permitted stack is enough for the deepest calls of the main thread and of the other threads.
stack_kib=256
memory_mib=1000
before=$((tried - worked))
run_all
[ $((tried - worked)) -eq $((before + 1)) ] || { # no daemon is on the client's bus
    echo "not everything works with a stack of $stack_kib KiB" >&2
    faults=$((faults + 1))
}

# A smaller stack is refused with one line.
stack_kib=192
before=$worked
try 60 "$build/sim/isotherm-sim" replay --corpus "$corpus" --out "$story_directory/replay"
[ "$worked" -eq "$before" ] && grep -q 'the stack is limited to 192 KiB' "$story_directory/err" || {
    echo "a stack of $stack_kib KiB is not refused" >&2
    faults=$((faults + 1))
}

# A client and a daemon, both with little memory.
stack_kib=8192
memory_mib=300
(
    ulimit -c 0
    ulimit -v $((memory_mib * 1024))
    exec timeout -k 10 60 "$build/firmware/isothermd" --config "$story_directory/isotherm.conf"
) >/dev/null 2>"$story_directory/daemon" &
daemon=$!
for _ in 1 2 3 4 5 6 7 8 9 10; do
    sleep 1
    ! grep -q 'ready$' "$story_directory/daemon" || break
done
for memory_mib in 100 150 200 400; do
    try 60 "$build/enroll/isotherm" --bus "$story_address" list
    try 60 "$build/enroll/isotherm" --bus "$story_address" log
    try 60 "$build/enroll/isotherm" --bus "$story_address" status
    try 60 "$build/enroll/isotherm" --bus "$story_address" enroll --quick p01
done
kill "$daemon"
code=0
wait "$daemon" || code=$?
[ "$code" -eq 0 ] || [ "$code" -eq 124 ] || {
    echo "the daemon ended with $code" >&2
    faults=$((faults + 1))
}

echo "$tried runs under limits, $worked did their work, $faults violations"
[ "$faults" -eq 0 ] && [ "$worked" -gt 20 ] && [ "$worked" -lt "$tried" ]
