#!/bin/sh
# Gate: programs open data files through drivers/file/file.h, which refuses everything that is not a regular file. open_files.txt lists all
# other calls that open something by its name: the number of calls of a source, and the reason.
# usage: open_files.sh [ROOT]
set -eu
cd "${1:-$(dirname "$0")/../..}"
calls='fopen|fopen64|freopen|open|open64|openat|openat2|creat|sqlite3_open|sqlite3_open_v2|ini_parse|json_load_file|json_dump_file|dlopen|oniDeviceOpen|ifstream'

# Members and methods of that name do not count, nor do comments and string literals.
found=$(find core drivers firmware enroll sim \( -name '*.[ch]' -o -name '*.cc' -o -name '*.cpp' \) ! -path drivers/file/file.c -print0 | sort -z |
    xargs -0 awk -v calls="(^|[^A-Za-z0-9_>.])($calls)[ ]*[(]" '
        { sub(/^ ?\*.*/, ""); sub(/\/\/.*/, ""); sub(/\/\*.*/, ""); gsub(/"([^"\\]|\\.)*"/, "") }
        $0 ~ calls { n[FILENAME]++ }
        END { for (source in n) { print source, n[source] } }' | sort)

allowed=$(grep -vE '^(#|$)' tests/gate/open_files.txt | awk '{ print $1, $2 }' | sort)
if [ "$found" != "$allowed" ]; then
    echo "Calls that open something and are missing in tests/gate/open_files.txt (<), or are listed there and do not exist (>):" >&2
    found_file=$(mktemp)
    echo "$found" >"$found_file"
    echo "$allowed" | diff "$found_file" - | grep '^[<>]' >&2
    rm "$found_file"
    exit 1
fi
