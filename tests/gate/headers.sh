#!/bin/sh
# Gate: every header compiles alone, so that it does not depend on the headers that were included before it.
# usage: headers.sh CC [ROOT]
set -eu
cc=$1
cd "${2:-$(dirname "$0")/../..}"
flags="-std=gnu17 -D_GNU_SOURCE -I. -Icore/include -Wall -Wextra -Wconversion -Werror -fsyntax-only -DISOTHERM_DATA_DIR=\"\" -DISOTHERM_SOURCE_DIR=\"\""
flags="$flags $(pkg-config --cflags cmocka cairo pangocairo libsystemd jansson) -isystem $(pkg-config --variable=includedir libpq) -isystem /usr/include/suitesparse"
flags="$flags -isystem $(pkg-config --variable=includedir libopenni2)"

headers=$(find core drivers firmware enroll sim tests -name '*.h' | sort)
[ -n "$headers" ] || {
    echo "no headers in $(pwd)" >&2
    exit 1
}
for header in $headers; do
    # A source includes the header, so that its inline functions are not "unused" and `#pragma once` would be legal. cmocka.h
    # needs these four.
    {
        case $header in
        tests/*) printf '#include <%s.h>\n' setjmp stdarg stddef stdint ;;
        esac
        printf '#include "%s"\n' "$header"
    } | $cc $flags -x c - || {
        echo "$header: does not compile alone" >&2
        exit 1
    }
done
