#!/bin/sh
# The messages of isotherm-sim if the modules are missing that its commands need: modules_missing.sh PROGRAM LIBRARY [NAME...]
# NAME: the modules that are built. The program runs on a copy of the library, which has no modules beside it.
set -u
simulator=$1 library=$2
shift 2
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
failures=0
mkdir "$work/isotherm"
cp "$library" "$work/isotherm"

# misses NAME COMMAND...: exit code 3, one line that names the module's package, and nothing is written
misses() {
    name=$1
    shift
    LD_LIBRARY_PATH=$work/isotherm "$simulator" "$@" --out "$work/out" >"$work/stdout" 2>"$work/stderr"
    got=$?
    wanted="the module $work/isotherm/isotherm-$name.so is missing: install the package isotherm-$name"
    if [ "$got" -ne 3 ] || [ "$(wc -l <"$work/stderr")" -ne 1 ] || ! grep -qF "$wanted" "$work/stderr"; then
        echo "isotherm-sim $*: exit code $got:"
        cat "$work/stderr"
        failures=$((failures + 1))
    fi
}

"$simulator" shapes generate --classes 2 --shapes 6 --vertices 300 --out "$work/corpus" >/dev/null || exit 1
for module in "$@"; do
    case $module in
    stereo)
        "$simulator" calibrate --render "$work/board" --pairs 1 >/dev/null || exit 1
        misses stereo calibrate --pictures "$work/board"
        misses stereo generate --sensor stereo --ict "$work/nowhere"
        ;;
    trees)
        misses trees shapes eval --corpus "$work/corpus" --classifier decision-tree
        # `all` leaves out the classifier of a missing module, and says so.
        LD_LIBRARY_PATH=$work/isotherm "$simulator" shapes eval --corpus "$work/corpus" --method shape-dna --classifier all \
            --pictures 0 --out "$work/all" >"$work/stdout" 2>"$work/stderr"
        if [ $? -ne 0 ] || ! grep -q '^isotherm-sim: decision-tree left out: the module ' "$work/stderr" ||
            grep -q '^shape-dna *decision-tree' "$work/stdout" || ! grep -q '^shape-dna *nn-l1' "$work/stdout"; then
            echo 'isotherm-sim shapes eval --classifier all:'
            cat "$work/stdout" "$work/stderr"
            failures=$((failures + 1))
        fi
        ;;
    esac
done
[ "$failures" -eq 0 ]
