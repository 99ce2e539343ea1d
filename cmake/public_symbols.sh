#!/bin/sh
# Prints the names of the functions and variables that public headers declare, one a line: what libisotherm.so exports.
# usage: public_symbols.sh CC INCLUDE_DIRECTORY HEADER...        HEADER: as it is included, such as isotherm/frame.h
set -eu
cc=$1
directory=$2
shift 2

# The preprocessed text of the headers themselves is cut into declarations. Bodies in braces are dropped, and with them the inline
# functions. $cc may be a compiler with options.
# shellcheck disable=SC2086
printf '#include "%s"\n' "$@" | $cc -E -I "$directory" -x c - | awk -v directory="$directory/" '
/^# [0-9]/ {
    file = $3
    gsub(/"/, "", file)
    wanted = index(file, directory) == 1
    next
}

# declared TEXT: the name of a function before its first parenthesis, or of a variable
function declared(text) {
    if (text ~ /(^|[^a-z_])(static|typedef)[^a-z_]/) {
        return ""
    }
    if (text ~ /\(/) {
        sub(/[ \t]*\(.*/, "", text)
    } else if (text ~ /^[ \t]*extern /) {
        sub(/[ \t]*\[.*/, "", text)
    } else {
        return ""
    }
    sub(/.*[^a-zA-Z0-9_]/, "", text)
    return text
}

wanted {
    n = length($0)
    for (i = 1; i <= n; i++) {
        c = substr($0, i, 1)
        if (c == "{") {
            depth++
        } else if (c == "}") {
            depth--
            if (depth == 0 && text ~ /\(/) {
                text = "" # the body of an inline function
            }
        } else if (depth == 0 && c == ";") {
            name = declared(text)
            if (name ~ /^iso_/) {
                print name
            }
            text = ""
        } else if (depth == 0) {
            text = text c
        }
    }
    text = text " "
}' | sort -u
