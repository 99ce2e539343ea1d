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

# Clouds: random points of a sphere, in each format that may have points alone.
"$python" - "$work" <<'PYTHON' || fail 'clouds'
import sys
import numpy as np
random = np.random.default_rng(5)
point = random.normal(size=(1500, 3))
point *= 3 / np.linalg.norm(point, axis=1)[:, None]
point[:, 2] += 10
np.savetxt(sys.argv[1] + '/ball.xyz', np.vstack([point, point[:7]]), fmt='%.9g', header='x y z')
np.savetxt(sys.argv[1] + '/ball.off', point, fmt='%.9g', header='OFF\n1500 0 0', comments='')
with open(sys.argv[1] + '/ball.ply', 'wb') as out:
    out.write(b'ply\nformat binary_little_endian 1.0\nelement vertex 1500\nproperty double x\nproperty double y\n'
              b'property double z\nend_header\n')
    rounded = np.loadtxt(sys.argv[1] + '/ball.xyz')[:1500]
    out.write(rounded.astype('<f8').tobytes())
PYTHON
for ending in xyz off ply; do
    "$simulator" shapes describe "$work/ball.$ending" --what eigen,mass,heat --source 4 --pairs 20 --out "$work/cloud-$ending" \
        >"$work/stdout" 2>"$work/stderr" || fail "describe of a cloud: $(cat "$work/stderr")"
    grep -q "ball.$ending: 1500 points, 20 eigenpairs" "$work/stdout" || fail "no report of a cloud: $(cat "$work/stdout")"
    cmp -s "$work/cloud-xyz/ball/phi.npy" "$work/cloud-$ending/ball/phi.npy" || fail "$ending: other eigenvectors than those of the XYZ"
    [ -s "$work/cloud-$ending/ball/functions.png" ] || fail 'no picture of a cloud'
done
"$simulator" shapes describe "$work/ball.xyz" --what all --no-pictures --out "$work/o" >/dev/null 2>&1 || fail 'describe --what all of a cloud'
"$simulator" shapes describe "$mesh" --what views --views 3 --view-score divergence --out "$work/views" >/dev/null 2>&1 || fail 'describe --what views'
[ -s "$work/views/dog-01/views.png" ] || fail 'no picture of the views'
"$python" - "$work" <<'PYTHON' || fail 'a cloud or views are not as they should be'
import json
import sys
import numpy as np
cloud, views = sys.argv[1] + '/cloud-xyz/ball/', sys.argv[1] + '/views/dog-01/'
values = np.load(cloud + 'lambda.npy')
known = np.repeat([l * (l + 1) / 9 for l in range(1, 4)], [3, 5, 7])
assert np.abs(values[1:16] / known - 1).max() < 0.04, values[1:16] / known
told = json.load(open(cloud + 'parameters.json'))
assert told['shape']['laplacian'] == 'cloud' and told['shape']['neighbours'] == 30, told['shape']
assert told['source']['points_of_cloud'] == 1500 and told['source']['merged_vertices'] == 7, told['source']
heat, time, area = np.load(cloud + 'heat.npy'), np.load(cloud + 'heat_time.npy'), np.load(cloud + 'area.npy')
point = np.load(cloud + 'vertices.npy')
assert heat.shape == (1500, 4) and (np.linalg.norm(point[heat.argmax(axis=0)] - point[4], axis=1) < 0.5).all()
assert np.allclose(area @ heat, 1) and np.allclose(time[2], area.sum() / 64) and np.allclose(time[1:] / time[:-1], 4)
view, divergence = np.load(views + 'view.npy'), np.load(views + 'view_divergence.npy')
assert view.shape == (3, 3) and np.allclose(np.linalg.norm(view, axis=1), 1)
assert (np.diff(divergence) >= 0).all() and (divergence > 0.9).all() and np.load(views + 'view_entropy.npy').shape == (3,)
assert (view @ view.T)[np.triu_indices(3, 1)].max() <= np.cos(np.radians(40)) + 1e-9
PYTHON
"$python" -c 'import sys; lines = open(sys.argv[1]).read().split("\n")[1:1501]; open(sys.argv[2], "w").write("\n".join(lines + [" ".join(str(0.3 * float(w) + 100) for w in l.split()) for l in lines[:200]]))' \
    "$work/ball.xyz" "$work/apart.xyz"
refuse 4 '200 of its 1700 points are not joined to the largest part; --mend accepts this' describe "$work/apart.xyz" --out "$work/o" --what eigen
refuse 4 'a cloud of points, which cannot be thinned' describe "$work/ball.xyz" --out "$work/o" --vertices 500
refuse 4 'a cloud of points, which cannot be smoothed' describe "$work/ball.xyz" --out "$work/o" --smooth 1
refuse 4 'views: a cloud of points has no surface to look at' describe "$work/ball.xyz" --out "$work/o" --what views
refuse 2 '--neighbours: 5 is not in 6..200' describe "$work/ball.xyz" --out "$work/o" --neighbours 5
refuse 2 '--views: 17 is not in 1..16' describe "$mesh" --out "$work/o" --views 17
refuse 2 "--view-score: 'best' is none of entropy, divergence" describe "$mesh" --out "$work/o" --view-score best
refuse 2 '--source is out of range: the shape has the vertices 0 to 399' describe "$mesh" --out "$work/o" --what heat --source 400
"$simulator" shapes describe "$work/apart.xyz" --out "$work/apart" --what eigen --mend --no-pictures >"$work/stdout" 2>"$work/stderr" ||
    fail "describe --mend of a cloud: $(cat "$work/stderr")"
grep -q 'apart.xyz: 1500 points, .* 200 points left out' "$work/stdout" || fail "no report of points left out: $(cat "$work/stdout")"
grep -q '"points_of_cloud": 1700' "$work/apart/apart/parameters.json" && grep -q '"points_left_out": 200' "$work/apart/apart/parameters.json" ||
    fail 'parameters.json does not say how many points are left out'
refuse 2 '--neighbours: 201 is not in 6..200' match "$work/ball.xyz" "$mesh" --out "$work/o" --neighbours 201

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

# Memory by vertices: what everything but views needs on 12,000 vertices more than on 400, without and with colours
# (tests/bench/shapes/cost.sh has more sizes).
# Sanitizers keep memory of their own.
if ! nm "$simulator" | grep -q ' __\(asan\|tsan\|msan\)_init'; then
    "$simulator" shapes generate --classes 1 --shapes 1 --vertices 12000 --out "$work/large" >/dev/null 2>&1 || fail 'generate a large shape'
    "$python" - "$simulator" "$mesh" "$(find "$work/large" -name '*.off')" "$work/o" <<'PYTHON' || fail 'a description needs over 5 kB a vertex'
import os
import subprocess
import sys
plain = 'eigen,mass,stiffness,hks,si-hks,wks,hms,segments,heat,critical,shape-dna,td,cp-td,srcp-td,srcp-td-one,cp-hk,cp-hk-plain,shape-google'
def paint(mesh, painted):
    lines = open(mesh).read().split('\n')
    n = int(lines[1].split()[0])
    with open(painted, 'w') as out:
        out.write('\n'.join(['COFF', lines[1]] + [v + ' %d %d %d 255' % tuple(int(float(x)**2) % 256 for x in v.split())
                                                 for v in lines[2:2 + n]] + lines[2 + n:]))
    return painted
def most(mesh, what):
    child = subprocess.Popen([sys.argv[1], 'shapes', 'describe', mesh, '--what', what, '--threads', '1', '--no-pictures', '--out', sys.argv[4]],
                             stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, usage = os.wait4(child.pid, 0)
    assert status == 0, status
    return 1.024 * usage.ru_maxrss
def needed(name, small, large, what):
    kilobytes = (most(large, what) - most(small, what)) / (12000 - 400)
    print('%s: %.2f kB a vertex' % (name, kilobytes))
    return kilobytes
small, large = sys.argv[2:4]
without = needed('without colours', small, large, plain)
coloured = needed('with colours', paint(small, sys.argv[4] + '-400.off'), paint(large, sys.argv[4] + '-12000.off'),
                  plain + ',w-hks1,w-hks2,si-hk-colour')
sys.exit(max(without, coloured) > 5.0)
PYTHON
fi

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
refuse 4 'of its 2 parts only the largest is used, which leaves out 20.0 % of the area and 400 vertices; --mend accepts this' \
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
