#!/bin/bash
# Measures what the description of a shape costs by its number of vertices: seconds of processor time, and the largest memory in all and for a
# vertex, for each kind of description, for all that need no colours, and for everything that a shape with colours has. At its end it prints
# as which power of the vertices the seconds of each kind grow, from the last size but one to the last one. The shape is a creature of
# `shapes generate`, painted by its coordinates. One thread. It checks no limit.
# usage: cost.sh BUILD [VERTICES...]    (BUILD with isotherm-sim; 3000 12000 50000 200000)
set -euo pipefail
build=$(cd "$1" && pwd)
sizes=("${@:2}")
[ ${#sizes[@]} -gt 0 ] || sizes=(3000 12000 50000 200000)
run=$(mktemp -d -p "${TMPDIR:-/var/tmp}")
trap 'rm -rf "$run"' EXIT
export OPENBLAS_NUM_THREADS=1
plain=shape-dna,td,cp-td,srcp-td,srcp-td-one,cp-hk,cp-hk-plain,shape-google
quantities=eigen,mass,stiffness,hks,si-hks,wks,hms,segments,heat,critical
kinds=(eigen hks wks segments views "$plain" "$quantities,$plain" "$quantities,$plain,w-hks1,w-hks2,si-hk-colour")
names=(eigen hks wks segments views 'the methods without colours' 'everything without colours and views' 'everything without views')

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

# usage: paint OFF COFF
paint() {
    awk 'FNR == 1 { print "COFF"; next }
        FNR == 2 { n = $1; print; next }
        FNR <= 2 + n { print $0, int($1 * $1) % 256, int($2 * $2) % 256, int($3 * $3) % 256, 255; next }
        { print }' "$1" >"$2"
}

printf '%9s  %-37s %9s %9s %12s\n' vertices what seconds MiB 'kB a vertex'
for size in "${sizes[@]}"; do
    "$build/sim/isotherm-sim" shapes generate --out "$run/$size" --classes 1 --shapes 1 --vertices "$size" --threads 1 >"$run/said" 2>&1
    paint "$(find "$run/$size" -name '*.off')" "$run/painted.off"
    for i in "${!kinds[@]}"; do
        read -r seconds kib <<<"$(measure "$run/painted.off" "${kinds[i]}")"
        printf '%d,%d,%s\n' "$size" "$i" "$seconds" >>"$run/all"
        awk -v n="$size" -v what="${names[i]}" -v s="$seconds" -v kib="$kib" 'BEGIN {
            printf "%9d  %-37s %9.1f %9.0f %12.1f\n", n, what, s, kib / 1024, kib * 1024 / 1000 / n }'
    done
    rm -rf "${run:?}/$size"
done
[ ${#sizes[@]} -lt 2 ] || for i in "${!kinds[@]}"; do
    awk -F, -v kind="$i" -v what="${names[i]}" '$2 == kind { from = to; s = last; to = $1; last = $3 }
        END { printf "%s: seconds grow as the power %.2f of the vertices, from %d to %d\n", what, log(last / s) / log(to / from), from, to }' \
        "$run/all"
done
