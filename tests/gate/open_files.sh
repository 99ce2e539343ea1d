#!/bin/sh
# Gate: programs open files of data through drivers/file/file.h, which refuses what is no file. Every other call that opens
# something by its name is in open_files.txt, with how many of them the source has, and why.
# usage: open_files.sh [ROOT]
set -eu
cd "${1:-$(dirname "$0")/../..}"
calls='fopen|fopen64|freopen|open|open64|openat|openat2|creat|sqlite3_open|sqlite3_open_v2|ini_parse|json_load_file|json_dump_file|dlopen|oniDeviceOpen|ifstream'

# Not a member or a method of that name, and not in a comment or a text.
found=$(find core drivers firmware enroll sim \( -name '*.[ch]' -o -name '*.cc' -o -name '*.cpp' \) ! -path drivers/file/file.c -print0 | sort -z |
    xargs -0 awk -v calls="(^|[^A-Za-z0-9_>.])($calls)[ ]*[(]" '
        { sub(/^ ?\*.*/, ""); sub(/\/\/.*/, ""); sub(/\/\*.*/, ""); gsub(/"([^"\\]|\\.)*"/, "") }
        $0 ~ calls { n[FILENAME]++ }
        END { for (source in n) { print source, n[source] } }' | sort)

allowed=$(grep -vE '^(#|$)' tests/gate/open_files.txt | awk '{ print $1, $2 }' | sort)
if [ "$found" != "$allowed" ]; then
    echo "Calls that open something, which tests/gate/open_files.txt does not have (<), or has and which are gone (>):" >&2
    found_file=$(mktemp)
    echo "$found" >"$found_file"
    echo "$allowed" | diff "$found_file" - | grep '^[<>]' >&2
    rm "$found_file"
    exit 1
fi
