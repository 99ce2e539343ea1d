#!/bin/sh
# Draws the pictures that the documents show. test_documents compares isotherms.png with a fresh drawing, and tests/gate/pictures.sh
# compares the text of each diagram (FILE.svg) with its source (FILE.dot).
#
#   draw.sh isotherms ISOTHERM_SIM OUT.png   a stored face with one of the four isotherms about each of its landmarks
#   draw.sh diagrams                         pipeline.svg here and wiring.svg of the boards, by Graphviz (Debian package graphviz)
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)

usage() {
    sed -n 's/^#   //p' "$0" >&2
    exit 64
}

case ${1:-} in
isotherms)
    [ $# -eq 3 ] || usage
    exec "$2" show --what isotherms --recording "$root/sim/stored/p02-enrol" --frame 0 --radii 20 \
        --model "$root/core/data/head.model" --out "$3"
    ;;
diagrams)
    [ $# -eq 1 ] || usage
    for source in sim/gallery/pipeline.dot board/wiring.dot; do
        dot -Tsvg "$root/$source" -o "$root/${source%.dot}.svg"
    done
    ;;
*) usage ;;
esac
