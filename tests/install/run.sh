#!/bin/sh
# Tests the installed appliance, each test in a fresh Debian 12:
#
#   packages     installed from the packages and booted by systemd: tests/install/first_start.sh
#   tree         the same from `make install` with its default prefix
#   readme       the commands of the README's "A real door", until a person is let in
#   piuparts     the packages are installed, upgraded from an earlier version, removed and purged, and leave no file
#   autopkgtest  the demo, with the installed programs, and the examples of the installed Python module
#
#   run.sh PACKAGES BUILD CACHE [TEST...]     PACKAGES: the output of debian_packages.sh; BUILD: the preset `release`, built
#
# Needs root, the tag `install` of cmake/packages.txt and Debian's archive. Logs are in CACHE. Ends with "N passed, N failed, N skipped";
# skipped are checks inside a test, whose line says why. Non-zero if a test failed.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
[ $# -ge 3 ] || {
    echo "usage: $0 PACKAGES BUILD CACHE [TEST...]" >&2
    exit 2
}
packages=$(cd "$1" && pwd)
build=$(cd "$2" && pwd)
mkdir -p "$3"
cache=$(cd "$3" && pwd)
shift 3
tests=${*:-packages tree readme piuparts autopkgtest}
architecture=$(dpkg --print-architecture)
base=$cache/base.tar
"$here/root.sh" "$base"

first_start() {
    "$here/first_start.sh" "$1" "$2" "$base"
}

# The earlier packages are the present ones with a lower version, because no version has been published yet.
check_piuparts() {
    scratch=$(mktemp -d)
    mkdir "$scratch/before"
    for name in isotherm isotherm-data libisotherm0 isotherm-web libpam-isotherm python3-isotherm; do
        "$here/repack.sh" "$(ls "$packages/${name}"_*_"$architecture".deb "$packages/${name}"_*_all.deb 2>/dev/null | head -n 1)" '~before' \
            "$scratch/before"
    done
    (cd "$scratch/before" && dpkg-scanpackages . >Packages 2>/dev/null)
    gzip -1 -c "$base" >"$scratch/base.tar.gz"
    code=0
    # The exit code of the pipe is that of sed, so the output of piuparts decides.
    piuparts -b "$scratch/base.tar.gz" --no-eatmydata --bindmount="$scratch/before" --distribution bookworm \
        --mirror 'http://deb.debian.org/debian main' --extra-repo="deb [trusted=yes] file://$scratch/before ./" \
        "$packages"/isotherm_*_"$architecture".deb "$packages"/isotherm-data_*_all.deb "$packages"/libisotherm0_*_"$architecture".deb \
        "$packages"/isotherm-web_*_"$architecture".deb "$packages"/libpam-isotherm_*_"$architecture".deb \
        "$packages"/python3-isotherm_*_all.deb |
        sed -n 's/^[0-9ms.]* \(INFO: PASS\|ERROR\|FAIL\)/\1/p' >"$scratch/result" || code=$?
    cat "$scratch/result"
    grep -q 'PASS: All tests' "$scratch/result" || code=1
    rm -rf "$scratch"
    return $code
}

check_autopkgtest() {
    scratch=$(mktemp -d /var/tmp/isotherm-autopkgtest.XXXXXX)
    mkdir "$scratch/root"
    tar -x -C "$scratch/root" -f "$base"
    cp /etc/resolv.conf "$scratch/root/etc/resolv.conf"
    code=0
    autopkgtest --quiet --setup-commands='apt-get update' --output-dir="$scratch/out" "$packages"/isotherm_*_"$architecture".changes -- chroot "$scratch/root" || code=$?
    tail -n 3 "$scratch/out/demo-stdout" "$scratch/out/python-stdout" || true
    rm -rf --one-file-system "$scratch"
    return $code
}

run_one() {
    case $1 in
    packages) first_start packages "$packages" ;;
    tree) first_start tree "$build" ;;
    readme) "$here/readme.sh" "$packages" "$base" ;;
    piuparts) check_piuparts ;;
    autopkgtest) check_autopkgtest ;;
    *)
        echo "$0: there is no test '$1'" >&2
        return 2
        ;;
    esac
}

# Runs the named tests one after the other. A test's output is printed at its end, and its result is written to CACHE/TEST.result.
run_in_order() {
    for test in "$@"; do
        began=$(date +%s) result=FAILED
        # A subshell, so that a failing command ends only this test. Not as the condition of `if`: there it would not even end the test.
        set +e
        (
            set -e
            run_one "$test"
        ) >"$cache/$test.log" 2>&1
        code=$?
        set -e
        [ $code -ne 0 ] || result=passed
        echo "$result" >"$cache/$test.result"
        printf '== %s\n%s\n%-12s %s after %d s\n' "$test" "$(tail -n 30 "$cache/$test.log")" "$test" "$result" $(($(date +%s) - began))
    done
}

# Containers that are booted at the same time would share a control group, so these tests run one after the other. The tests in a chroot
# run beside them.
booted='' in_chroot=''
for test in $tests; do
    rm -f "$cache/$test.result"
    case $test in
    piuparts | autopkgtest) in_chroot="$in_chroot $test" ;;
    *) booted="$booted $test" ;;
    esac
done
# shellcheck disable=SC2086
run_in_order $in_chroot &
# shellcheck disable=SC2086
run_in_order $booted
wait

passed=0 failed=0 skipped=0
for test in $tests; do
    case $(cat "$cache/$test.result" 2>/dev/null) in
    passed) passed=$((passed + 1)) ;;
    *) failed=$((failed + 1)) ;;
    esac
    skipped=$((skipped + $(grep -c ' skipped: ' "$cache/$test.log" || true)))
done
echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
