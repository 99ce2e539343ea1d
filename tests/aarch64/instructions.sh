#!/bin/bash
# Counts the instructions of one frame in each stage, on arm64 and on x86-64 without and with AVX2, in the same way: by the emulator's log.
# The face is searched in the whole frame, and the ten best of 1,000 people are found by the metric. It measures and does not judge; it
# takes some minutes.
#
#   instructions.sh             builds one_frame in build/aarch64 and build/dev, with the same optimisation
set -euo pipefail
source_dir=$(cd "$(dirname "$0")/../.." && pwd)
arm64=$source_dir/build/aarch64/tests/bench/one_frame
x86=$source_dir/build/dev/tests/bench/one_frame
recording=p01-v1
run=$(mktemp -d)
trap 'rm -rf "$run"' EXIT

[ "$(uname -m)" = x86_64 ] || {
    echo 'instructions.sh: the other side of the comparison has to be x86-64' >&2
    exit 1
}
cd "$source_dir"
cmake/aarch64_root.sh build/aarch64-root
for preset in aarch64 dev; do
    cmake --preset $preset
    cmake --build --preset $preset --target one_frame
done >"$run/build.log" || {
    tail -n 20 "$run/build.log" >&2
    exit 1
}

# One thread; the dynamic linker binds all names before the first stage.
export OPENBLAS_NUM_THREADS=1 LD_BIND_NOW=1

# count NAME PROGRAM EMULATOR...: writes the names of the stages to NAME.stages and their instructions to NAME.counts
count() {
    local name=$1 program=$2
    shift 2
    "$@" -d in_asm,exec,nochain "$program" "$source_dir/sim/stored" "$source_dir/core/data/head.model" \
        "$source_dir/core/data/face.metric" $recording 2>&1 >"$run/$name.stages" |
        awk -v mark=one_frame_mark -f "$source_dir/tests/aarch64/instructions.awk" >"$run/$name.counts"
}

# Three processors of the emulator: that of a Raspberry Pi 4, the first of x86-64, and one with AVX2.
count neon "$arm64" env QEMU_LD_PREFIX="$source_dir/build/aarch64-root" qemu-aarch64-static -cpu cortex-a72
count sse2 "$x86" qemu-x86_64-static -cpu qemu64
count avx2 "$x86" qemu-x86_64-static -cpu max

echo "instructions of a frame, millions ($recording, one thread)"
paste -d ' ' "$run/neon.stages" "$run/neon.counts" "$run/sse2.counts" "$run/avx2.counts" | awk '
    function row(name, arm64, sse2, avx2) {
        printf "%-10s %12.3f %12.3f %12.3f %12.2f\n", name, arm64 / 1e6, sse2 / 1e6, avx2 / 1e6, arm64 / sse2
    }
    BEGIN { printf "%-10s %12s %12s %12s %12s\n", "stage", "arm64 NEON", "x86-64 SSE2", "x86-64 AVX2", "arm64 / SSE2" }
    NF != 4 { exit failed = 1 }
    { row($1, $2, $3, $4); arm64 += $2; sse2 += $3; avx2 += $4 }
    END { if (failed) exit 1; row("all", arm64, sse2, avx2) }'
