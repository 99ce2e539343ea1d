#!/bin/sh
# The example program heat_on_mesh, on a sphere. A circle on the sphere that encloses the area of a flat disc of radius r has the
# distance r from its centre, straight through the sphere (Archimedes). The amount of heat is kept.
# usage: heat_on_mesh.sh PROGRAM SOURCE_DIR
set -eu
program=$1
mesh=$2/core/examples/sphere.off
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

for vertex in 0 11 300; do
    "$program" "$mesh" "$vertex" 400 40 >"$work/points" 2>"$work/said"
    grep -qx 'heat on the surface: 1.000000' "$work/said" &&
        awk '/^isotherm: 1 curve/ { near = $7 > 39.6 && $7 < 40.4 } END { exit !near }' "$work/said" &&
        awk 'NF != 3 { exit 1 } { r = sqrt($1 * $1 + $2 * $2 + $3 * $3); if (r < 48.5 || r > 50.01) exit 1 } END { exit NR < 50 }' "$work/points" || {
        echo "vertex $vertex:"
        cat "$work/said" "$work/points"
        exit 1
    } >&2
done

echo 'OFF 1 1 0' >"$work/cut.off"
for wrong in "$work/cut.off 0 400 40" "$mesh 642 400 40" "$mesh 0 400 400" "$work/nowhere 0 400 40" "$mesh"; do
    # shellcheck disable=SC2086
    if message=$("$program" $wrong 2>&1 >/dev/null) || [ -z "$message" ]; then
        echo "accepts: $wrong" >&2
        exit 1
    fi
done
