#!/bin/sh
# Runs every fuzz target of a build for some seconds each; stops at the first input that breaks one and keeps it.
# usage: run.sh BUILD SECONDS [SEED]      SEED 0: another one each time; default 1, so that a short run can be repeated
set -eu
build=$(cd "$1" && pwd)
seconds=$2
seed=${3:-1}
here=$(cd "$(dirname "$0")" && pwd)
work=$build/fuzz
mkdir -p "$work"

"$build/tests/fuzz/fuzz_seeds" "$work"
for program in "$build"/tests/fuzz/fuzz_*; do
    target=${program##*/fuzz_}
    [ "$target" != seeds ] && [ -x "$program" ] && [ -f "$program" ] || continue
    corpus=$work/$target
    mkdir -p "$corpus"
    [ ! -d "$here/seeds/$target" ] || cp "$here/seeds/$target"/* "$corpus/"
    "$program" -seed="$seed" -max_total_time="$seconds" -max_len=8192 -timeout=20 -rss_limit_mb=2048 \
        -artifact_prefix="$work/broken-$target-" -verbosity=0 -print_final_stats=1 \
        "$corpus" >"$work/$target.log" 2>&1 || {
        tail -40 "$work/$target.log" >&2
        echo "$target: broken; the input is in $work" >&2
        exit 1
    }
    runs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$work/$target.log")
    edges=$(sed -n 's/.* cov: \([0-9]*\) .*/\1/p' "$work/$target.log" | tail -n 1)
    printf '%-12s %9s inputs %6s edges\n' "$target" "$runs" "$edges"
done
