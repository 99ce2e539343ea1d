#!/bin/sh
# Writes the linker's version script of libisotherm.so: what public headers declare is exported, all else is hidden.
# usage: version_script.sh CC INCLUDE_DIRECTORY HEADER...
set -eu
names=$("$(dirname "$0")/public_symbols.sh" "$@")
printf '{\n    global:\n'
printf '        %s;\n' $names
printf '    local: *;\n};\n'
