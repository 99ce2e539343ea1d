#!/bin/sh
# Cross-builds the Debian packages for arm64 from the source package, in a separate Debian root with the libraries of both architectures.
# It installs nothing on this machine.
#
#   debian_packages_arm64.sh SOURCE OUT      SOURCE is the output folder of debian_packages.sh; OUT is emptied, and then has *.deb, also
#                                            those of SOURCE that are for every architecture, and the log. It does nothing if OUT has
#                                            the packages of SOURCE.
#
# Needs root and mmdebstrap.
set -eu
source_packages=$(cd "$1" && pwd)
if [ -e "$2/tree.sha256" ] && cmp -s "$1/tree.sha256" "$2/tree.sha256"; then
    exit 0
fi
rm -rf "$2"
mkdir -p "$2"
out=$(cd "$2" && pwd)
root=$(mktemp -d /var/tmp/isotherm-arm64.XXXXXX)
trap 'rm -rf --one-file-system "$root"' EXIT
keyring=/usr/share/keyrings/debian-archive-keyring.gpg

# The build needs the libraries of arm64 and the tools of this machine's architecture.
dsc=$(ls "$source_packages"/isotherm_*.dsc)
mmdebstrap --quiet --variant=buildd --architectures=amd64,arm64 --include=crossbuild-essential-arm64 bookworm "$root/debian" \
    "deb [signed-by=$keyring] http://deb.debian.org/debian bookworm main" \
    "deb [signed-by=$keyring] http://deb.debian.org/debian bookworm-updates main" \
    "deb [signed-by=$keyring] http://deb.debian.org/debian-security bookworm-security main"
cp /etc/resolv.conf "$root/debian/etc/resolv.conf"
mkdir "$root/debian/build"
cp "$source_packages"/isotherm_*.dsc "$source_packages"/isotherm_*.tar.* "$root/debian/build"

inside() {
    chroot "$root/debian" /usr/bin/env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin LANG=C.UTF-8 DEBIAN_FRONTEND=noninteractive \
        DEB_BUILD_OPTIONS="nocheck noautodbgsym parallel=$(nproc)" sh -euc "cd /build && $1"
}
inside "apt-get update -q &&
    apt-get build-dep -q -y --no-install-recommends --host-architecture arm64 --build-profiles cross,nocheck ./$(basename "$dsc") &&
    dpkg-source -x $(basename "$dsc") tree && cd tree &&
    dpkg-buildpackage --host-arch arm64 --build-profiles=cross,nocheck --build=any -us -uc" >"$out/build.log" 2>&1 || {
    tail -n 40 "$out/build.log" >&2
    echo "debian_packages_arm64.sh: the build failed; whole log: $out/build.log" >&2
    exit 1
}
cp "$root"/debian/build/*.deb "$out"
(cd "$out" && ls -- *.deb)
for deb in "$out"/*.deb; do
    [ "$(dpkg-deb -f "$deb" Architecture)" = arm64 ] || {
        echo "$deb is not for arm64" >&2
        exit 1
    }
done
cp "$source_packages"/*_all.deb "$out"
cp "$source_packages/tree.sha256" "$out"
