#!/bin/sh
# Gate: the rooms, which are the folders of sources.
#   - no folder holds more than 25 files; board/debian may, because debhelper looks for all its files there
#   - no room of the product (core, drivers, firmware, enroll) has more than a fifth of its lines
#   - no file includes itself through others, and no room includes itself through other rooms
# Generated and downloaded files are not examined.
# usage: rooms.sh [ROOT]           prints each fault, exits 1 if there is one
set -eu
cd "${1:-$(dirname "$0")/../..}"
faults=0

fault() {
    echo "$*" >&2
    faults=1
}

# The files of the project: in a checkout those that git knows or would add, elsewhere all files.
files=$(git ls-files --cached --others --exclude-standard 2>/dev/null || true)
[ -n "$files" ] || files=$(find . -type f | sed 's#^\./##')

crowded=$(printf '%s\n' "$files" | sed 's#/[^/]*$##' | sort | uniq -c | awk '$1 > 25 && $2 != "board/debian" { print $2 ": " $1 " files, more than 25" }')
[ -z "$crowded" ] || fault "$crowded"

sources=$(printf '%s\n' "$files" | grep -E '^(core|drivers|firmware|enroll|sim|tests)/.*\.(c|h|cc|hh|inc)$' | while read -r file; do
    [ ! -f "$file" ] || echo "$file"
done)

# Lines of each room of the product.
large=$(printf '%s\n' "$sources" | grep -vE '^(sim|tests)/' | xargs wc -l | awk '
    $2 != "total" {
        room = $2
        sub(/\/[^\/]*$/, "", room)
        lines[room] += $1
        all += $1
    }
    END {
        for (room in lines) {
            if (lines[room] * 5 > all && all > 1000) {
                printf "%s: %d of %d lines, more than a fifth of the product\n", room, lines[room], all
            }
        }
    }')
[ -z "$large" ] || fault "$large"

# tsort names the members of a circle on its standard error.
circle() {
    tsort 2>&1 >/dev/null | sed 's/^tsort: //' | grep -v '^-:' || true
}

includes=$(printf '%s\n' "$sources" | xargs grep -HE '^[[:space:]]*#[[:space:]]*include[[:space:]]*"' |
    sed -E 's/^([^:]*):[^"]*"([^"]*)".*/\1 \2/; s# isotherm/# core/include/isotherm/#')
found=$(printf '%s\n' "$includes" | awk 'NF == 2 && $1 != $2' | circle)
[ -z "$found" ] || fault "files that include each other in a circle:
$found"
found=$(printf '%s\n' "$includes" | sed -E 's#/[^/ ]*( |$)#\1#g' | awk 'NF == 2 && $1 != $2' | sort -u | circle)
[ -z "$found" ] || fault "rooms that include each other in a circle:
$found"

[ "$faults" -eq 0 ]
