#!/bin/sh
# The example program identify names an enrolled person in every frame and a stranger in none, and it refuses a photograph.
# usage: identify.sh PROGRAM SOURCE_DIR
set -eu
program=$1
stored=$2/sim/stored
out=$("$program" "$2/core/data" "$stored/p01-enrol" "$stored/p02-enrol" "$stored/p03-enrol" -- \
    "$stored/p01-v1" "$stored/p03-v2" "$stored/x01-v1" "$stored/none-photo1" | sed "s#$stored/##g")

# count N PATTERN: fails unless N lines of the output match
count() {
    n=$(echo "$out" | grep -cE "$2" || true)
    [ "$n" -eq "$1" ] || {
        echo "$out"
        echo "$n lines are like '$2', not $1"
        exit 1
    } >&2
}
count 15 '^p0[123]-enrol, frame [0-4]: enrolled as p0[123]-enrol$'
count 3 '^p01-v1, frame [0-2]: p01-enrol \('
count 3 '^p03-v2, frame [0-2]: p03-enrol \('
count 3 '^x01-v1, frame [0-2]: nobody \('
count 3 '^none-photo1, frame [0-2]: flat$'

# A recording that cannot be read is reported, and the exit status is not 0.
for wrong in "$2/core $stored/p01-enrol -- $stored/p01-v1" "$2/core/data $stored/nowhere -- $stored/p01-v1" "$2/core/data --"; do
    # shellcheck disable=SC2086
    if message=$("$program" $wrong 2>&1 >/dev/null) || [ -z "$message" ]; then
        echo "accepts: $wrong" >&2
        exit 1
    fi
done
