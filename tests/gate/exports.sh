#!/bin/sh
# Gate: libisotherm.so exports exactly the names that its public headers declare, and exactly the names in the symbols file of its
# package.
# usage: exports.sh LIBRARY CC [ROOT]
set -eu
library=$1
cc=$2
root=$(cd "${3:-$(dirname "$0")/../..}" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
faults=0

# differ TEXT FILE FILE: a fault if a line of the first file is missing in the second one
differ() {
    found=$(comm -23 "$2" "$3")
    [ -z "$found" ] || {
        echo "$1:"
        echo "$found" | sed 's/^/  /'
        faults=1
    } >&2
}

headers=$(cd "$root/core/include" && find isotherm -name '*.h' | sort)
# shellcheck disable=SC2086
"$(dirname "$0")/../../cmake/public_symbols.sh" "$cc" "$root/core/include" $headers >"$work/declared"
[ -s "$work/declared" ] || {
    echo "no declarations in $root/core/include" >&2
    exit 1
}
nm --dynamic --defined-only "$library" | awk '{ print $NF }' | sort -u >"$work/exported"
sed -n 's/^ \([a-z_0-9]*\)@.*/\1/p' "$root/board/debian/libisotherm0.symbols" | sort -u >"$work/packaged"

differ "$library exports names that no public header declares" "$work/exported" "$work/declared"
differ "$library does not export names that a public header declares" "$work/declared" "$work/exported"
differ "$library exports names that board/debian/libisotherm0.symbols does not have" "$work/exported" "$work/packaged"
differ "board/debian/libisotherm0.symbols has names that $library does not export" "$work/packaged" "$work/exported"
exit "$faults"
