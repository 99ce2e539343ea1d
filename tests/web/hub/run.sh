#!/bin/sh
# Tests the pages of the hub in a browser, with a PostgreSQL of its own and doors that are played. Pictures of pages, logs and the list of
# steps are in OUT. The last line is "N passed, N failed, N skipped"; the exit status is not 0 if a step failed.
#
#   run.sh BUILD OUT [STEPS]     BUILD: a preset with tests, in which isotherm-hub, its pages and play_doors are built; STEPS: only steps
#                                whose names have this text, to look for a fault
#
# Needs the tag `web` of cmake/packages.txt, and PostgreSQL.
set -eu
[ $# -ge 2 ] || {
    echo "usage: $0 BUILD OUT [STEPS]" >&2
    exit 2
}
here=$(cd "$(dirname "$0")/.." && pwd)
source_dir=$(cd "$here/../.." && pwd)
build=$(cd "$1" && pwd)
rm -rf "$2"
mkdir -p "$2"
out=$(cd "$2" && pwd)

for program in enroll/hub/command/isotherm-hub tests/enroll/hub/api/play_doors; do
    [ -x "$build/$program" ] || {
        echo "$0: $build/$program is missing: build it first" >&2
        exit 2
    }
done
# shellcheck source=tests/web/packages.sh
. "$here/packages.sh"

scratch=$(mktemp -d "${TMPDIR:-/tmp}/isotherm-hub-web.XXXXXX")
trap 'rm -rf "$scratch"' EXIT
trap 'exit 130' INT
trap 'exit 143' TERM
code=0
WEB_CHECK_SOURCE=$source_dir WEB_CHECK_BUILD=$build WEB_CHECK_OUT=$out WEB_CHECK_SCRATCH=$scratch WEB_CHECK_STEPS=${3:-} \
    CHROMIUM=$(command -v "${CHROMIUM:-chromium}") node "$web/hub/main.mjs" || code=$?
exit $code
