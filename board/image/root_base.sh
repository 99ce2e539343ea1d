#!/bin/sh
# Makes the Debian of the image without Isotherm and without kernel, as one tar file, so that a new version of Isotherm does not load all of
# Debian again. The file is made anew if a list has changed; remove it to get Debian's updates.
#
#   root_base.sh PACKAGES CACHE      PACKAGES: the packages of `make packages`, whose dependencies the Debian has; prints the file's name
#
# ISOTHERM_MIRROR: another archive, such as https://snapshot.debian.org/archive/debian/20261101T000000Z, whose packages never change.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
packages=$1 cache=$2
mirror=${ISOTHERM_MIRROR:-http://deb.debian.org/debian}
security=${ISOTHERM_MIRROR_SECURITY:-http://deb.debian.org/debian-security}
signed='[signed-by=/usr/share/keyrings/debian-archive-keyring.gpg]'

# Prints the packages of Debian that the packages of Isotherm depend on: of alternatives the first.
dependencies() {
    grep -v '^#' "$here/our_packages.txt" | while read -r name; do
        dpkg-deb -f "$(find "$packages" -name "${name}_*.deb" | head -n 1)" Depends | tr ',' '\n' | sed 's/[(|].*//; s/ //g'
    done | grep -vE '^(|debconf|lib)isotherm|^$' | sort -u
}

. "$here/arch.sh"
# For amd64 the name of the file is what it was before there were other architectures.
other_arch=$(echo "$ISOTHERM_ARCH" | sed 's/^amd64$//')
names=$({
    awk '!/^#/ && NF { print $1 }' "$here/packages.txt"
    dependencies
} | sort -u | tr '\n' ',')
sum=$({
    echo "$other_arch$names$mirror$security$SOURCE_DATE_EPOCH"
    cat "$here/leave_out.txt" "$here/accounts.conf"
} | sha256sum | cut -c 1-16)
tar=$cache/base-$sum.tar
[ -s "$tar" ] || {
    mkdir -p "$cache"
    excludes=$(awk '$1 == "exclude" || $1 == "include" { printf "--dpkgopt=path-%s=%s ", $1, $2 }' "$here/leave_out.txt")
    set -f # the patterns are for dpkg
    # The accounts come first, with fixed numbers: an update must not change who owns the files in /var.
    # shellcheck disable=SC2086,SC2016 # words; mmdebstrap's shell sets $1
    mmdebstrap --quiet --mode=root --variant=essential --format=tar --architectures="$ISOTHERM_ARCH" --include="${names%,}" $excludes \
        --dpkgopt=force-unsafe-io --hook-dir=/usr/share/mmdebstrap/hooks/merged-usr \
        --essential-hook="systemd-sysusers --root=\"\$1\" $here/accounts.conf" \
        bookworm "$tar.$$" "deb $signed $mirror bookworm main" "deb $signed $mirror bookworm-updates main" \
        "deb $signed $security bookworm-security main" >&2
    mv "$tar.$$" "$tar"
}
echo "$tar"
