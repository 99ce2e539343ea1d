#!/bin/bash
# Counts the instructions of a visit, from the first frame until the door is locked again: what a visitor costs on a battery, whatever the
# machine does besides. The appliance runs on stored frames and a virtual clock, once with one visit and once with two; the difference is the
# second one. It checks no limit.
# usage: visit.sh BUILD    (BUILD with isotherm-sim; needs valgrind)
set -euo pipefail
build=$(cd "$1" && pwd)
source_dir=$(cd "$(dirname "$0")/../../.." && pwd)
run=$(mktemp -d)
trap 'rm -rf "$run"' EXIT

command -v valgrind >/dev/null || {
    echo 'visit.sh: not counted: valgrind is not installed'
    exit 0
}

# count VISIT...: prints the instructions of the enrolment of p01 and these visits
count() {
    rm -rf "$run/corpus" "$run/out"
    mkdir "$run/corpus"
    head -n 1 "$source_dir/sim/stored/manifest.csv" >"$run/corpus/manifest.csv"
    for recording in p01-enrol "$@"; do
        cp -r "$source_dir/sim/stored/$recording" "$run/corpus"
        grep "^$recording," "$source_dir/sim/stored/manifest.csv" >>"$run/corpus/manifest.csv"
    done
    OPENBLAS_NUM_THREADS=1 valgrind --tool=callgrind --toggle-collect=iso_appliance_step --callgrind-out-file="$run/counts" "$build/sim/isotherm-sim" replay --corpus "$run/corpus" \
        --out "$run/out" --model "$source_dir/core/data/head.model" --metric "$source_dir/core/data/face.metric" >"$run/log" 2>&1 || {
        tail -n 5 "$run/log" >&2
        exit 1
    }
    sed -n 's/^summary: //p' "$run/counts"
}

for second in p01-v2 none-nobody2; do
    one=$(count p01-v1)
    both=$(count p01-v1 $second)
    frames=$(find "$source_dir/sim/stored/$second/depth" -type f | wc -l)
    awk -v one="$one" -v both="$both" -v frames="$frames" -v name=$second 'BEGIN {
        printf "a visit, %s: %.0f million instructions, %d frames before the camera\n", name, (both - one) / 1e6, frames }'
done
