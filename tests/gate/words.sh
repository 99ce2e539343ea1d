#!/bin/sh
# Gate: sources, comments and documents use the words of the field, one word for one thing. words.txt lists the words that were invented
# here or that meant two things. The history in CHANGELOG.md and the figures in sim/results may keep them.
# usage: words.sh [ROOT]           prints file, line and the word to write instead; exits 1 if there is a hit
set -eu
cd "${1:-$(dirname "$0")/../..}"
list=tests/gate/words.txt
faults=0

# Not read: what a program wrote (pictures, models, recordings), and the two files that have to name the words.
files=$(mktemp)
trap 'rm -f "$files"' EXIT
find . \( -path ./build -o -path ./out -o -path ./.git -o -path ./sim/results \) -prune -o -type f \
    ! -name CHANGELOG.md ! -path "./$list" ! -path ./tests/gate/gates_bite.sh -print0 >"$files"

grep -vE '^(#|$)' "$list" | {
    while read -r word instead; do
        pattern=$(printf '%s' "$word" | sed 's/_/[ _-]?/g')
        found=$(xargs -0 grep -IHniE -e "(^|[^A-Za-z])${pattern}s?([^A-Za-z]|\$)" <"$files" || true)
        [ -z "$found" ] || {
            printf '%s\n' "$found" | sed 's#^\./##'
            echo "  instead of \"$word\": $instead"
            faults=$((faults + 1))
        }
    done
    [ "$faults" -eq 0 ]
} >&2
