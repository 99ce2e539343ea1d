#!/bin/sh
# Gate: no program reads its own or another program's sentences. A fault is known by its code (core/base/fault_code.h), a record by its
# members, an option by its name. Every call that searches for a text within a text is in strstr.txt, with how many of them the source has,
# and why.
# usage: strstr.sh [ROOT]
set -eu
cd "${1:-$(dirname "$0")/../..}"
calls='strstr|strcasestr|memmem|fnmatch|regexec|regcomp'

# Not a member or a method of that name, and not in a comment or a text.
found=$(find core drivers firmware enroll sim \( -name '*.[ch]' -o -name '*.cc' -o -name '*.cpp' \) -print0 | sort -z |
    xargs -0 awk -v calls="(^|[^A-Za-z0-9_>.])($calls)[ ]*[(]" '
        { sub(/^ ?\*.*/, ""); sub(/\/\/.*/, ""); sub(/\/\*.*/, ""); gsub(/"([^"\\]|\\.)*"/, "") }
        $0 ~ calls { n[FILENAME]++ }
        END { for (source in n) { print source, n[source] } }' | sort)

allowed=$(grep -vE '^(#|$)' tests/gate/strstr.txt | awk '{ print $1, $2 }' | sort)
if [ "$found" != "$allowed" ]; then
    echo "Calls that search within a text, which tests/gate/strstr.txt does not have (<), or has and which are gone (>):" >&2
    found_file=$(mktemp)
    echo "$found" >"$found_file"
    echo "$allowed" | diff "$found_file" - | grep '^[<>]' >&2
    rm "$found_file"
    exit 1
fi
