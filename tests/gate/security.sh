#!/bin/sh
# Gate: SECURITY.md names a test wherever it says that something is tested. Each "tested" reads
#     tested: `NAME`      or      tested: `NAME1`, `NAME2`
# and each NAME is a test in ctest's list or an executable script under tests/.
# usage: security.sh ROOT TESTS      TESTS: a file with the names of the tests, one a line
#        security.sh --ctest ROOT BUILD      the names are those of the tests of this build. They are read from the files that CMake wrote,
#                                            because `ctest -N` would empty the log of the ctest run that this gate is part of.
set -eu

if [ "${1:-}" = --ctest ]; then
    list=$(mktemp)
    trap 'rm -f "$list"' EXIT
    find "$3" -name CTestTestfile.cmake -exec sed -n 's/^add_test(\(\[=*\[\)\{0,1\}\([A-Za-z0-9_.-]*\).*/\2/p' {} + >"$list"
    [ -s "$list" ] || { echo "$0: $3 has no tests" >&2; exit 1; }
    "$0" "$2" "$list"
    exit
fi

root=$1
tests=$2
faults=0

fault() {
    echo "SECURITY.md: $*" >&2
    faults=$((faults + 1))
}

exists() {
    grep -qxF -e "$1" "$tests" && return
    case $1 in
    tests/*) [ -f "$root/$1" ] && [ -x "$root/$1" ] ;;
    *) return 1 ;;
    esac
}

# One claim a line, also if it extends over several lines of the document: from one "tested" to the next.
claims=$(mktemp)
trap 'rm -f "$claims"' EXIT
tr '\n' ' ' <"$root/SECURITY.md" | tr -s ' ' | sed 's/\<tested\>/\n&/gI' | grep -i '^tested\>' >"$claims" ||
    fault "claims nothing as tested"

while IFS= read -r claim; do
    names=$(printf '%s\n' "$claim" | grep -oiE '^tested: `[^`]+`(, `[^`]+`)*' | grep -o '`[^`]*`' | tr -d '\140')
    [ -n "$names" ] || fault "names no test: $(printf '%s\n' "$claim" | cut -c 1-60)"
    for name in $names; do
        exists "$name" || fault "names a test that does not exist: $name"
    done
done <"$claims"

echo "$(wc -l <"$claims") statements name their tests"
[ "$faults" -eq 0 ]
