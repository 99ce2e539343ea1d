#!/bin/sh
# The Python module against NumPy, SciPy and what isotherm-sim writes:
#
#   python.sh LIBRARY LAYOUT PROGRAM SOURCE_DIRECTORY      LIBRARY: libisotherm.so; LAYOUT: tests/core/python/layout.c, built
#   python.sh LIBRARY --examples SOURCE_DIRECTORY          runs the examples instead
#
# Exit code 77: there is no NumPy, SciPy or Pillow, or the library needs the run time of clang's sanitizers, which Python does not have.
set -eu
library=$1 what=$2
# isotherm-sim has one thread of OpenBLAS; with more, sums are in another order.
export OPENBLAS_NUM_THREADS=1
# Debian's Python has the packages; another one may come first in PATH.
python=/usr/bin/python3
if ! "$python" -c 'import numpy, scipy, PIL' 2>/dev/null; then
    echo 'skipped: python3-numpy, python3-scipy or python3-pil is missing'
    exit 77
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# python SCRIPT...: with the module of the source and the library of the build. A library with gcc's sanitizers needs their run time from
# the start of the program. Python itself keeps memory until its end.
preload=''
if readelf --dynamic "$library" | grep -q 'NEEDED.*libasan'; then
    preload=$(ldd "$library" | sed -n 's/.*libasan[^ ]* => \([^ ]*\).*/\1/p')
elif nm --dynamic "$library" | grep -q ' U __\(asan\|ubsan\|msan\|tsan\|sanitizer\)_'; then
    echo 'skipped: the library needs the run time of sanitizers that Python cannot load'
    exit 77
fi
python() {
    env LD_PRELOAD="$preload" ASAN_OPTIONS="${ASAN_OPTIONS:-}:detect_leaks=0" LD_LIBRARY_PATH="${library%/*}" PYTHONPATH="$source/core/python" \
        PYTHONDONTWRITEBYTECODE=1 ISOTHERM_SANITIZED="$preload" "$python" "$@"
}

if [ "$what" = --examples ]; then
    source=$3 drawn=''
    "$python" -c 'import matplotlib' 2>/dev/null && drawn=yes
    for example in spectrum signatures heat geodesics clouds matching retrieval; do
        echo "== $example.py"
        picture=''
        case $example in signatures | heat | geodesics | clouds | matching) picture=$work/$example.png ;; esac
        # shellcheck disable=SC2086
        python "$source/core/python/examples/$example.py" $picture
        [ -z "$picture" ] || [ -z "$drawn" ] || [ -s "$picture" ] || {
            echo "$example.py: no picture"
            exit 1
        }
    done
    echo '== faces.py'
    stored=$source/sim/stored
    python "$source/core/python/examples/faces.py" --data "$source/core/data" --picture "$work/face.png" \
        "$stored/p01-enrol" "$stored/p01-v1" "$stored/p02-v1" >"$work/faces"
    cat "$work/faces"
    grep -q 'p01-v1: .* the same person$' "$work/faces"
    grep -q 'p02-v1: .* somebody else$' "$work/faces"
    [ -z "$drawn" ] || [ -s "$work/face.png" ] || {
        echo 'faces.py: no picture'
        exit 1
    }
    exit 0
fi

simulator=$3 source=$4
quietly() {
    "$@" >"$work/log" 2>&1 || {
        cat "$work/log"
        exit 1
    }
}
quietly "$simulator" shapes generate --classes 3 --shapes 6 --vertices 400 --out "$work/plain"
quietly "$simulator" shapes generate --preset textured --classes 1 --vertices 300 --out "$work/coats"
coat=$(find "$work/coats" -name '*.ply' | sort | head -n 1)
for format in npy csv mat5; do
    quietly "$simulator" shapes describe "$work/plain/dog-01.off" --format $format --pairs 40 --times 7 --energies 30 --no-pictures \
        --out "$work/$format"
done
quietly "$simulator" shapes describe "$coat" --no-pictures --out "$work/coloured"
quietly "$simulator" shapes describe "$work/plain/dog-01.off" --what views --views 3 --no-pictures --out "$work/views"
quietly "$simulator" shapes match "$work/plain/dog-01.off" "$work/plain/dog-02.off" --pairs 60 --out "$work/match"
corpus=$work/corpus
mkdir "$corpus"
head -n 1 "$source/sim/stored/manifest.csv" >"$corpus/manifest.csv"
for recording in p01-enrol p01-v1 p02-enrol p02-v1; do
    ln -s "$source/sim/stored/$recording" "$corpus"
    grep "^$recording," "$source/sim/stored/manifest.csv" >>"$corpus/manifest.csv"
done
quietly "$simulator" eval --corpus "$corpus" --out "$work/scores" --method hfpc-metric --fuse 1 --gallery-frames 1 --probe-frames 1 --threads 1
quietly "$simulator" landmarks --corpus "$corpus" --out "$work/faces" --pictures 0 --threads 1
"$what" >"$work/layout"
ln -s "$coat" "$work/coat.ply"
mv "$work/coloured/$(basename "$coat" .ply)" "$work/coloured/coat"
ISOTHERM_PYTHON_TEST=$work ISOTHERM_PYTHON_DATA=$source/core/data
export ISOTHERM_PYTHON_TEST ISOTHERM_PYTHON_DATA
python -m unittest discover --start-directory "$source/tests/core/python"
