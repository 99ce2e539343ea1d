#!/bin/sh
# Checks the text of all includes: they keep to cmake/layers.txt, and core stays pure, which means that it includes no header of files,
# devices, clocks, threads or processes.
# usage: check_layers.sh [ROOT]            prints each fault, exits 1 if there is one
set -eu
cd "${1:-$(dirname "$0")/..}"

find core drivers firmware enroll sim tests -name '*.[ch]' -o -name '*.cc' | sort | xargs awk '
function deepest_rule(path,   folder) {
    folder = path
    while (sub(/\/[^\/]*$/, "", folder)) {
        if (folder in may) {
            return folder
        }
    }
    return ""
}

function holds(entry, path) {
    return path == entry || index(path, entry "/") == 1
}

function allowed(rule, path,   entries, n, i) {
    if (holds(rule, path)) {
        return 1
    }
    n = split(may[rule], entries, " ")
    for (i = 1; i <= n; i++) {
        if (holds(entries[i], path)) {
            return 1
        }
    }
    return 0
}

# Where a public header of core belongs for the rules; any other path as it is.
function in_its_room(path,   name) {
    name = path
    sub(/^(core\/include\/)?isotherm\//, "", name)
    if (name == path) {
        return path
    }
    if (!(name in room_of)) {
        fault("cmake/layers.txt has no room for the public header " path)
        return path
    }
    return room_of[name] "/" name
}

function fault(text) {
    printf "%s:%d: %s\n", FILENAME, FNR, text
    faults++
}

BEGIN {
    while ((getline line < "cmake/layers.txt") > 0) {
        if (line ~ /^[a-z\/]* = /) {
            n = split(line, word, " ")
            for (i = 3; i <= n; i++) {
                room_of[word[i] ".h"] = word[1]
            }
        } else if (line !~ /^#/ && line ~ /:/) {
            rule = line
            sub(/:.*/, "", rule)
            sub(/[^:]*:/, "", line)
            may[rule] = line
        }
    }
    impure = "^(dirent|fcntl|poll|pthread|signal|syslog|termios|threads|time|unistd|sys/.*)[.]h$"
}

FNR == 1 {
    source = in_its_room(FILENAME)
}

/^[ \t]*#[ \t]*include/ {
    header = $0
    sub(/^[ \t]*#[ \t]*include[ \t]*/, "", header)
    quoted = header ~ /^"/
    header = substr(header, 2)
    sub(/[">].*$/, "", header)
    if (quoted && header !~ /\// && FILENAME ~ /\/examples\//) {
        next # examples are built by those who have nothing but this folder
    } else if (quoted && header !~ /\//) {
        fault("\"" header "\" is not written from the project root")
    } else if (quoted) {
        rule = deepest_rule(source)
        if (FILENAME ~ /^core\/include\// && header !~ /^isotherm\//) {
            fault("a public header may not include \"" header "\", which is not installed")
        } else if (!allowed(rule, in_its_room(header))) {
            fault(rule " may not include \"" header "\"")
        }
    } else if (FILENAME ~ /^core\// && header ~ impure) {
        fault("core may not include <" header ">")
    }
}

END {
    exit faults > 0
}'
