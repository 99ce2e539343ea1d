#!/bin/bash
# Measures what the description of a shape costs by its number of vertices: seconds of processor time, and the largest memory in all and for a
# vertex, for each kind of description and for all that need no colours. The shape is a creature of `shapes generate`. One thread. It checks
# no limit.
# usage: cost.sh BUILD [VERTICES...]    (BUILD with isotherm-sim; 3000 12000 50000)
set -euo pipefail
build=$(cd "$1" && pwd)
sizes=("${@:2}")
[ ${#sizes[@]} -gt 0 ] || sizes=(3000 12000 50000)
run=$(mktemp -d -p "${TMPDIR:-/var/tmp}")
trap 'rm -rf "$run"' EXIT
export OPENBLAS_NUM_THREADS=1
plain=shape-dna,td,cp-td,srcp-td,srcp-td-one,cp-hk,cp-hk-plain,shape-google

# usage: measure MESH WHAT, which prints: seconds, KiB
measure() {
    /usr/bin/time -f '%U %S %M' -o "$run/cost" "$build/sim/isotherm-sim" shapes describe "$1" --out "$run/out" --what "$2" --threads 1 \
        --no-pictures >"$run/said" 2>&1 || {
        cat "$run/said" >&2
        return 1
    }
    rm -rf "$run/out"
    awk 'END { print $1 + $2, $3 }' "$run/cost"
}

printf '%9s  %-45s %9s %9s %12s\n' vertices what seconds MiB 'kB a vertex'
for size in "${sizes[@]}"; do
    "$build/sim/isotherm-sim" shapes generate --out "$run/$size" --classes 1 --shapes 1 --vertices "$size" --format ply --threads 1 >"$run/said" 2>&1
    mesh=$(find "$run/$size" -name '*.ply')
    for what in eigen hks wks segments views "$plain" "eigen,mass,stiffness,hks,si-hks,wks,hms,segments,heat,critical,$plain"; do
        name=$what
        [ "$what" != "$plain" ] || name='the methods without colours'
        [ "${what#eigen,mass}" = "$what" ] || name='everything without colours and views'
        read -r seconds kib <<<"$(measure "$mesh" "$what")"
        awk -v n="$size" -v what="$name" -v s="$seconds" -v kib="$kib" 'BEGIN {
            printf "%9d  %-45s %9.1f %9.0f %12.1f\n", n, what, s, kib / 1024, kib * 1024 / 1000 / n }'
    done
    rm -rf "${run:?}/$size"
done
