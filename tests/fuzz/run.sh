#!/bin/bash
# Runs every fuzz target of a build for some seconds, as many targets at a time as there are processors. It stops when an input breaks a
# target, and keeps the input. For each target it prints the number of inputs, the reached edges of the program and features (edges with
# their counts), and the seconds of processor time.
# usage: run.sh BUILD SECONDS [SEED]      SEED 0: another seed each time; default 1, so that a short run can be repeated
set -euo pipefail
build=$(cd "$1" && pwd)
seconds=$2
seed=${3:-1}
here=$(cd "$(dirname "$0")" && pwd)
work=$build/fuzz
mkdir -p "$work"

# Runs one target. Its log and its result line go to separate files.
run_target() {
    local program=$1 target=${1##*/fuzz_}
    local corpus=$work/$target log=$work/$target.log TIMEFORMAT='%U %S'
    mkdir -p "$corpus"
    [ ! -d "$here/seeds/$target" ] || cp "$here/seeds/$target"/* "$corpus/"
    { time "$program" -seed="$seed" -max_total_time="$seconds" -max_len=8192 -timeout=20 -rss_limit_mb=2048 \
        -artifact_prefix="$work/broken-$target-" -print_final_stats=1 "$corpus" >"$log" 2>&1; } 2>"$work/$target.time" || {
        tail -40 "$log" >&2
        echo "$target: broken; the input is in $work" >&2
        return 1
    }
    local runs reached spent
    runs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
    reached=$(sed -n 's/.* cov: \([0-9]*\) ft: \([0-9]*\) .*/\1 edges \2 features/p' "$log" | tail -n 1)
    spent=$(awk 'END { printf "%.0f", $1 + $2 }' "$work/$target.time")
    printf '%-15s %10s inputs %6s %s %8s %s %5s s\n' "$target" "$runs" $reached "$spent"
}

"$build/tests/fuzz/fuzz_seeds" "$work"
running=0 broken=0
for program in "$build"/tests/fuzz/fuzz_*; do
    [ "${program##*/}" != fuzz_seeds ] && [ -x "$program" ] && [ -f "$program" ] || continue
    if [ "$running" -eq "$(nproc)" ]; then
        wait -n || broken=1
        running=$((running - 1))
    fi
    [ "$broken" -eq 0 ] || break
    run_target "$program" &
    running=$((running + 1))
done
while [ "$running" -gt 0 ]; do
    wait -n || broken=1
    running=$((running - 1))
done
exit "$broken"
