#!/bin/sh
# `isotherm-sim shapes describe` against NumPy and SciPy, which read its files and compute the same
# from the mesh alone: describe.sh PROGRAM SOURCE_DIRECTORY. Exit code 77: there is no SciPy.
set -u
simulator=$1 source=$2
# shellcheck source=tests/support/verdict.sh
. "$source/tests/support/verdict.sh"
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
failures=0 why='a file or a message of shapes describe is not as it should be'
# Debian's Python has the packages; another one may come first in PATH.
python=/usr/bin/python3
if ! "$python" -c 'import numpy, scipy' 2>/dev/null; then
    echo 'skipped: python3-numpy or python3-scipy is missing'
    exit 77
fi

fail() {
    why=$*
    echo "$why"
    failures=$((failures + 1))
}

# refuse CODE WORDS COMMAND...: the exit code, and words of the last line on stderr
refuse() {
    code=$1 words=$2
    shift 2
    "$simulator" shapes "$@" >"$work/stdout" 2>"$work/stderr"
    got=$?
    [ "$got" -eq "$code" ] || fail "shapes $*: exit code $got, not $code: $(tail -n 1 "$work/stderr")"
    tail -n 1 "$work/stderr" | grep -qF -- "$words" || fail "shapes $*: '$(tail -n 1 "$work/stderr")' lacks '$words'"
}

"$simulator" shapes generate --classes 3 --shapes 3 --vertices 400 --out "$work/plain" >/dev/null 2>&1 || fail 'generate'
"$simulator" shapes generate --preset textured --classes 1 --vertices 300 --out "$work/coats" >/dev/null 2>&1 || fail 'generate textured'
mesh=$work/plain/dog-01.off
coat=$(find "$work/coats" -name '*.ply' | sort | head -n 1)
for format in npy csv mat5; do
    "$simulator" shapes describe "$mesh" --format $format --pairs 40 --times 7 --energies 30 --out "$work/deep/below/$format" \
        >"$work/stdout" 2>"$work/stderr" || fail "describe --format $format: $(cat "$work/stderr")"
done
[ -s "$work/deep/below/npy/dog-01/functions.png" ] || fail 'no picture'
"$simulator" shapes describe "$coat" --what w-hks2 --no-pictures --out "$work/coloured" >/dev/null 2>&1 || fail 'describe of a coloured mesh'
"$simulator" shapes describe "$mesh" --laplacian robust --what eigen,stiffness,mass --pairs 40 --no-pictures --out "$work/robust" \
    >/dev/null 2>&1 || fail 'describe --laplacian robust'
"$python" "$source/tests/sim/shapes/describe.py" "$mesh" "$work/deep/below" "$work/coloured" "$work/robust" || fail 'the arrays are not what NumPy computes'

refuse 2 'no mesh is given' describe --out "$work/o"
refuse 2 '--out is needed' describe "$mesh"
refuse 2 "--what: 'hat' is unknown" describe "$mesh" --out "$work/o" --what hks,hat
refuse 2 "--format: 'xls' is none of npy, csv, mat5" describe "$mesh" --out "$work/o" --format xls
refuse 2 "--laplacian: 'best' is none of plain, robust" describe "$mesh" --out "$work/o" --laplacian best
refuse 2 'would both be described in' describe "$mesh" "$mesh" --out "$work/o"
refuse 2 '--times, --time-first' describe "$mesh" --out "$work/o" --time-first 5 --time-last 4
refuse 3 'nowhere.off' describe "$work/nowhere.off" --out "$work/o"
refuse 4 'a method needs colours, and the file has none' describe "$mesh" --out "$work/o" --what w-hks1
refuse 4 'not a directory' describe "$mesh" --out "$mesh"

# A tetrahedron, a flat one, and two spheres of which the smaller one has over 1 % of the area.
printf 'OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n' >"$work/tiny.off"
printf 'OFF\n3 1 0\n0 0 0\n1 0 0\n2 0 0\n3 0 1 2\n' >"$work/line.off"
"$python" - "$mesh" "$work/two.off" "$work/crumb.off" <<'PYTHON' || fail 'two parts'
import sys
lines = open(sys.argv[1]).read().split('\n')
n, m = (int(word) for word in lines[1].split()[:2])
vertices, faces = lines[2:2 + n], lines[2 + n:2 + n + m]
for path, scale in ((sys.argv[2], 0.5), (sys.argv[3], 0.05)):
    small = [' '.join(repr(1000 + scale * float(x)) for x in v.split()) for v in vertices]
    moved = ['3 ' + ' '.join(str(int(c) + n) for c in f.split()[1:]) for f in faces]
    with open(path, 'w') as out:
        out.write('\n'.join(['OFF', '%d %d 0' % (2 * n, 2 * m)] + vertices + small + faces + moved) + '\n')
PYTHON
refuse 4 'its largest part has 4 vertices, 32 are needed' describe "$work/tiny.off" --out "$work/o"
refuse 4 'none of its 1 triangles has an area' describe "$work/line.off" --out "$work/o"
refuse 4 '2 parts, and without all but the largest 20.0 % of the area and 400 vertices are lost; --mend accepts this' \
    describe "$work/two.off" --out "$work/o"
"$simulator" shapes describe "$work/two.off" "$work/crumb.off" "$work/tiny.off" --mend --what eigen --out "$work/o" \
    >"$work/stdout" 2>"$work/stderr" || fail 'describe does not leave out one bad mesh'
grep -q 'left out: .*tiny.off: its largest part' "$work/stderr" || fail 'the bad mesh is not named'
grep -q 'two.off: 400 vertices, .* 1 part left out: 20 % of the area, 400 vertices' "$work/stdout" || fail "no report of two parts: $(cat "$work/stdout")"
grep -q 'crumb.off: 400 vertices, .* 1 part left out: 0.25 % of the area' "$work/stdout" || fail "no report of a small part: $(cat "$work/stdout")"
refuse 4 'tiny.off: its largest part' describe "$work/two.off" "$work/tiny.off" --mend --strict --threads 1 --out "$work/o"

[ "$failures" -eq 0 ] || {
    paint bad "$failures failed; the last: $why"
    echo
    exit 1
}
