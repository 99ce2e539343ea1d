#!/bin/bash
# Compares the time of a frame, stage by stage, with that of an earlier commit, which is built from the history. Both programs work on the
# same frames with the same model, in turn, each with one thread, so that other work of the machine concerns both alike. It measures and
# does not judge.
# usage: before.sh BUILD [RUNS]    (BUILD with bench_frame; RUNS of each program, 3)
set -euo pipefail
commit=94f967581df76f228ba2d74a65443851849700d3
build=$(cd "$1" && pwd)
runs=${2:-3}
source_dir=$(cd "$(dirname "$0")/../.." && pwd)
short=${commit:0:7}
before=$source_dir/build/before-$short
run=$(mktemp -d)
trap 'rm -rf "$run"' EXIT

if ! git -C "$source_dir" cat-file -e "$commit^{commit}" 2>"$run/git.log"; then
    echo "before.sh: not compared: commit $short is not in the history of $source_dir (a shallow clone, or no clone)"
    exit 0
fi

# The archive is complete once its folder has this name.
if [ ! -d "$before/source" ]; then
    rm -rf "$before"
    mkdir -p "$before/partial"
    git -C "$source_dir" archive "$commit" | tar -x -C "$before/partial"
    mv "$before/partial" "$before/source"
fi
type=$(sed -n 's/^CMAKE_BUILD_TYPE:[A-Z]*=//p' "$build/CMakeCache.txt")
{
    cmake -S "$before/source" -B "$before/build" -G Ninja -DCMAKE_BUILD_TYPE="$type" -DBUILD_TESTING=ON
    cmake --build "$before/build" --target bench_frame
} >"$run/build.log" 2>&1 || {
    tail -n 20 "$run/build.log" >&2
    echo "before.sh: commit $short cannot be built" >&2
    exit 1
}

# measure NAME PROGRAM: appends the median processor time of each stage, in milliseconds, to the list: name, stage, time
measure() {
    OPENBLAS_NUM_THREADS=1 "$2" --corpus "$source_dir/sim/stored" --model "$source_dir/core/data/head.model" \
        --metric "$source_dir/core/data/face.metric" >"$run/table"
    awk -v name="$1" '$1 ~ /^(region|clean|fit|patch|mesh|heat|isotherm|total)$/ { print name, $1, $4 }' "$run/table" >>"$run/times"
}

for ((i = 0; i < runs; i++)); do
    measure before "$before/build/tests/bench/bench_frame"
    measure now "$build/tests/bench/bench_frame"
done

echo "The same frames before ($short) and now, $runs runs of each in turn, one thread: medians of the processor time"
echo
echo 'stage       before ms    now ms   now / before'
for stage in region clean fit patch mesh heat isotherm total; do
    for name in before now; do
        awk -v name=$name -v stage=$stage '$1 == name && $2 == stage { print $3 }' "$run/times" | sort -n | sed -n "$(((runs + 1) / 2))p"
    done | paste -sd ' ' | awk -v stage=$stage '{ printf "%-10s %10.2f %9.2f %14.2f\n", stage, $1, $2, ($1 > 0 ? $2 / $1 : 0) }'
done
