#!/bin/sh
# Gate: no program searches its own or another program's sentences for words. Programs identify a fault by its code
# (core/base/fault_code.h), a record by its members, and an option by its name. strstr.txt lists all calls that search for a text within a
# text: the number of calls of a source, and the reason.
# usage: strstr.sh [ROOT]
set -eu
cd "${1:-$(dirname "$0")/../..}"
calls='strstr|strcasestr|memmem|fnmatch|regexec|regcomp'

# Members and methods of that name do not count, nor do comments and string literals.
found=$(find core drivers firmware enroll sim \( -name '*.[ch]' -o -name '*.cc' -o -name '*.cpp' \) -print0 | sort -z |
    xargs -0 awk -v calls="(^|[^A-Za-z0-9_>.])($calls)[ ]*[(]" '
        { sub(/^ ?\*.*/, ""); sub(/\/\/.*/, ""); sub(/\/\*.*/, ""); gsub(/"([^"\\]|\\.)*"/, "") }
        $0 ~ calls { n[FILENAME]++ }
        END { for (source in n) { print source, n[source] } }' | sort)

allowed=$(grep -vE '^(#|$)' tests/gate/strstr.txt | awk '{ print $1, $2 }' | sort)
if [ "$found" != "$allowed" ]; then
    echo "Calls that search within a text and are missing in tests/gate/strstr.txt (<), or are listed there and do not exist (>):" >&2
    found_file=$(mktemp)
    echo "$found" >"$found_file"
    echo "$allowed" | diff "$found_file" - | grep '^[<>]' >&2
    rm "$found_file"
    exit 1
fi
