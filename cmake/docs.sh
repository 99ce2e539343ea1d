#!/bin/sh
# Makes the reference of the library in OUT: OUT/html/index.html and the manual pages OUT/man/man3. Fails on any warning.
# Exits 77 if there is no doxygen on this machine.
# usage: docs.sh OUT [ROOT]
set -eu
mkdir -p "$1"
out=$(cd "$1" && pwd)
cd "${2:-$(dirname "$0")/..}"
command -v doxygen >/dev/null || {
    echo 'skipped: doxygen is missing (cmake/install_packages.sh docs)'
    exit 77
}
{
    cat core/Doxyfile
    echo "PROJECT_NUMBER = $(sed -n 's/^project(isotherm VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)"
    echo "OUTPUT_DIRECTORY = $out"
} | doxygen -
