#!/bin/sh
# Tests isotherm-web and its pages in a browser, with a daemon on stored frames. Pictures of pages and of the screen, logs and the list of
# steps are in OUT. The last line is "N passed, N failed, N skipped"; the exit status is not 0 if a step failed.
#
#   run.sh BUILD OUT [STEPS]     BUILD: a preset with tests, in which isothermd, isotherm, isotherm-web with its pages, bench_gallery and
#                                test_screen_picture are built; STEPS: only steps whose names have this text, to look for a fault
#
# Needs the tag `web` of cmake/packages.txt. The first run fetches the packages of package-lock.json from registry.npmjs.org into BUILD/web.
set -eu
[ $# -ge 2 ] || {
    echo "usage: $0 BUILD OUT [STEPS]" >&2
    exit 2
}
here=$(cd "$(dirname "$0")" && pwd)
source_dir=$(cd "$here/../.." && pwd)
build=$(cd "$1" && pwd)
rm -rf "$2"
mkdir -p "$2"
out=$(cd "$2" && pwd)

for program in firmware/isothermd enroll/isotherm enroll/web/isotherm-web tests/bench/bench_gallery tests/enroll/play_rauc; do
    [ -x "$build/$program" ] || {
        echo "$0: $build/$program is missing: build it first" >&2
        exit 2
    }
done
command -v dbus-daemon >/dev/null || {
    echo "$0: there is no command dbus-daemon: cmake/install_packages.sh web" >&2
    exit 2
}
# shellcheck source=tests/web/packages.sh
. "$here/packages.sh"

scratch=$(mktemp -d "${TMPDIR:-/tmp}/isotherm-web.XXXXXX")
trap 'rm -rf "$scratch"' EXIT
trap 'exit 130' INT
trap 'exit 143' TERM
code=0
WEB_CHECK_SOURCE=$source_dir WEB_CHECK_BUILD=$build WEB_CHECK_OUT=$out WEB_CHECK_SCRATCH=$scratch WEB_CHECK_STEPS=${3:-} \
    CHROMIUM=$(command -v "${CHROMIUM:-chromium}") node "$web/main.mjs" || code=$?
exit $code
