#!/bin/sh
# Gate: each diagram of the documents is drawn from its present source.
#   - the texts and the arrows of FILE.svg are those of FILE.dot next to it (places and fonts are not compared: they depend on the
#     fonts of the machine that drew the diagram)
#   - every path that a label names exists
# Draw a diagram that differs again by sim/gallery/draw.sh diagrams.
# usage: pictures.sh [ROOT]
set -eu
cd "${1:-$(dirname "$0")/../..}"
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
faults=0

fault() {
    echo "$*" >&2
    faults=$((faults + 1))
}

# source_texts FILE.dot: prints the lines of all labels; each field of a record is a label, without its port
source_texts() {
    grep -v '^[[:space:]]*//' "$1" | grep -o 'label="[^"]*"' | sed 's/^label="//; s/"$//; s/\\n/\n/g' |
        sed 's/|/\n/g' | sed 's/^<[a-z_]*> *//; s/^ *//; s/ *$//' | sort
}

# source_arrows FILE.dot: prints the arrows as FROM->TO, one a line, without ports
source_arrows() {
    grep -v '^[[:space:]]*//' "$1" | sed 's/"[^"]*"//g; s/\[.*//; s/;.*//' | grep -e '->' | sed 's/:[a-z_]*//g; s/[[:space:]]//g' |
        awk -F'->' '{ for (i = 1; i < NF; i++) print $i "->" $(i + 1) }' | sort
}

plain() {
    sed 's/&#45;/-/g; s/&#39;/'"'"'/g; s/&quot;/"/g; s/&lt;/</g; s/&gt;/>/g; s/&#160;/ /g; s/&amp;/\&/g; s/^ *//; s/ *$//' | sort
}

drawn_texts() {
    sed -n 's/^<text[^>]*>\(.*\)<\/text>$/\1/p' "$1" | plain
}

drawn_arrows() {
    sed -n 's/^<title>\(.*&gt;.*\)<\/title>$/\1/p' "$1" | sed 's/:[a-z_]*//g' | plain
}

# same texts|arrows SOURCE DRAWING: compares those of the source with those of the drawing
same() {
    "source_$1" "$2" >"$scratch/source"
    "drawn_$1" "$3" >"$scratch/drawn"
    [ -s "$scratch/source" ] || fault "$2: no $1 found"
    diff "$scratch/source" "$scratch/drawn" >"$scratch/diff" ||
        fault "$3: its $1 are not those of $2 (draw it by sim/gallery/draw.sh diagrams):
$(cat "$scratch/diff")"
}

for source in $(find . -name '*.dot' -not -path './build/*' -not -path './out/*'); do
    drawing=${source%.dot}.svg
    if [ -f "$drawing" ]; then
        same texts "$source" "$drawing"
        same arrows "$source" "$drawing"
    else
        fault "$source: there is no $drawing"
    fi
    for path in $(source_texts "$source" | grep -oE '\<(core|drivers|firmware|enroll|sim|board|tests|cmake)/[A-Za-z0-9_./-]+' | sort -u); do
        [ -e "$path" ] || fault "$source: a label names $path, which does not exist"
    done
done

[ "$faults" -eq 0 ]
