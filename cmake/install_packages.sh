#!/bin/sh
# Installs the Debian packages of some tags of cmake/packages.txt. It does nothing if all of them are installed.
# usage: install_packages.sh TAG...        (build, demo, test, gate, docs, vm, bench, arm64, package, install, image, web)
set -eu

if [ $# -eq 0 ]; then
    echo "usage: $0 TAG...   (build, demo, test, gate, docs, vm, bench, arm64, package, install, image, web)" >&2
    exit 2
fi

list=$(dirname "$0")/packages.txt
missing=
for tag in "$@"; do
    packages=$(awk -v tag="$tag" '$1 == tag { print $2 }' "$list")
    if [ -z "$packages" ]; then
        echo "$0: $list has no package of tag '$tag'" >&2
        exit 2
    fi
    for package in $packages; do
        # NodeSource's nodejs has the command npm and cannot be installed beside Debian's package of this name.
        if [ "$package" = npm ] && command -v npm >/dev/null; then
            continue
        fi
        state=$(dpkg-query -W -f '${Status}' "$package" 2>/dev/null || true)
        [ "$state" = 'install ok installed' ] || missing="$missing $package"
    done
done
[ -n "$missing" ] || exit 0

echo "installing:$missing"
as_root=
if [ "$(id -u)" -ne 0 ]; then
    as_root='sudo'
fi
# $as_root and $missing are lists of words.
$as_root env DEBIAN_FRONTEND=noninteractive apt-get update -q
$as_root env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends $missing </dev/null
