#!/bin/sh
# Gate: what the built library, programs and modules import and export.
#   - no GPL part of SuiteSparse: UMFPACK, and CHOLMOD's Supernodal, MatrixOps and Modify modules
#   - the private library exports names of the project only (what the public one exports: exports.sh)
#   - the library neither opens files, logs, reads clock or environment, makes threads nor ends the process
#   - library and programs need neither OpenCV nor libcamera, nor what those pull in, directly or by way of others
#   - a module exports iso_module and nothing else, and needs no memory that is writable and executable
# usage: symbols.sh LIBRARY [PROGRAM...] [-- MODULE...]
set -eu
library=$1
faults=0
modules=''
programs=''
for file in "$@"; do
    case $file in
    --) modules=' ' ;;
    *) [ -z "$modules" ] && programs="$programs $file" || modules="$modules $file" ;;
    esac
done

fault() {
    echo "$1:" >&2
    echo "$2" | sed 's/^/  /' >&2
    faults=$((faults + 1))
}

imports() {
    nm --dynamic --undefined-only "$1" | awk '{ sub(/@.*/, "", $NF); print $NF }'
}

gpl='super|drop|horzcat|norm_|scale$|sdmult|ssmult|submatrix|vertcat|symmetry|updown|rowadd|rowdel'
for binary in $programs $modules; do
    found=$(imports "$binary" | grep -E "^(umfpack|cholmod_(l_)?($gpl))" || true)
    [ -z "$found" ] || fault "$binary uses GPL parts of SuiteSparse" "$found"
done

found=$(nm --dynamic --defined-only "$library" | awk '{ print $NF }' | grep -v '^iso_' || true)
[ -z "$found" ] || fault "$library exports foreign names" "$found"

impure='^(f?open(at|64)?|fopen64|read|write|f?printf|v?f?printf|__v?f?printf_chk|puts|fputs|syslog|perror'
impure="$impure|(secure_)?getenv|clock_gettime|clock|time|gettimeofday|nanosleep|u?sleep"
impure="$impure|pthread_create|thrd_create|fork|v?fork|exec.*|system|exit|_exit|abort|__assert_fail|signal|sigaction|rand|s?random)\$"
found=$(imports "$library" | grep -E "$impure" || true)
[ -z "$found" ] || fault "$library is not pure" "$found"

for binary in $programs; do
    found=$(ldd "$binary" | grep -E 'not found|lib(opencv_|camera|tss2-|LLVM|icu|GL|glapi)' || true)
    [ -z "$found" ] || fault "$binary needs what belongs to modules" "$found"
done

for module in $modules; do
    found=$(nm --dynamic --defined-only "$module" | awk '{ print $NF }')
    [ "$found" = iso_module ] || fault "$module exports" "$found"
    found=$(readelf --wide --segments "$module" | grep -E 'RWE|R W E' || true)
    [ -z "$found" ] || fault "$module has memory that is writable and executable" "$found"
    found=$(readelf --dynamic "$module" | grep TEXTREL || true)
    [ -z "$found" ] || fault "$module is relocated in its code" "$found"
done

[ "$faults" -eq 0 ]
