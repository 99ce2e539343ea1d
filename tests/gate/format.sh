#!/bin/sh
# Gate: every C file has the layout of .clang-format.
# usage: format.sh [ROOT]
set -eu
cd "${1:-$(dirname "$0")/../..}"
find core drivers firmware enroll sim tests \( -name '*.[ch]' -o -name '*.cc' \) -print0 | xargs -0 clang-format --dry-run -Werror
