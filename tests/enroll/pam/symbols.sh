#!/bin/sh
# The PAM module becomes a part of programs that run as root: it exports the functions that PAM calls and nothing else, needs libpam,
# libsystemd and the C library alone, and has no path of its own where it looks for libraries.
# usage: symbols.sh MODULE
set -eu
exported=$(nm --dynamic --defined-only "$1" | awk '{ print $NF }' | sort | tr '\n' ' ')
[ "$exported" = 'pam_sm_authenticate pam_sm_setcred ' ] || {
    echo "$1 exports $exported" >&2
    exit 1
}
needed=$(objdump -p "$1" | awk '$1 == "NEEDED" && $2 !~ /^lib(pam|systemd|c)\.so\./ { print $2 }')
[ -z "$needed" ] || {
    echo "$1 needs $needed" >&2
    exit 1
}
if objdump -p "$1" | grep -qE 'RPATH|RUNPATH'; then
    echo "$1 looks for libraries in a path of its own" >&2
    exit 1
fi
