#!/bin/sh
# Makes the image of the appliance for machines with UEFI.
#
#   build.sh PACKAGES OUT [BOARD]      makes OUT/isotherm.img from the packages of `make packages`; BOARD: a folder of board/ (pc-usb)
#
# ISOTHERM_ARCH is the architecture of the machine, amd64 or arm64 (arch.sh); for arm64, PACKAGES is that of `make packages-arm64`. The board
# `generic` is any machine without lines of a door.
#
# The same packages, the same archive of Debian and the same tools give the same bytes. ISOTHERM_SB_KEY and ISOTHERM_SB_CERT sign the
# kernel image for Secure Boot. ISOTHERM_UPDATE_CERT is the certificate by which the image knows its updates (bundle.sh makes them with its
# key), ISOTHERM_VERSION another version than that of the packages. ISOTHERM_EXTRA: a program that changes the root before it is sealed, with the root as its argument; the
# test's machine is made so, and an image for doors never. Needs root, and the tag `image` of cmake/packages.txt.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
. "$here/arch.sh"
packages=$1 board=${3:-pc-usb}
mkdir -p "$2"
out=$(cd "$2" && pwd)
case $ISOTHERM_ARCH in amd64) images=image ;; *) images=image-$ISOTHERM_ARCH ;; esac
cache=${ISOTHERM_CACHE:-$here/../../build/$images/cache}
[ "$(id -u)" -eq 0 ] || {
    echo "$0: only root can make the root of another system" >&2
    exit 1
}
SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(dpkg-parsechangelog -l "$here/../debian/changelog" -S Timestamp)}
export SOURCE_DATE_EPOCH
arch_can_run
umask 022
"$here/root.sh" "$packages" "$cache" "$board" "$out/root"
[ -z "${ISOTHERM_EXTRA:-}" ] || "$ISOTHERM_EXTRA" "$out/root"
"$here/seal.sh" "$out/root" "$cache" "$out"
"$here/disk.sh" "$out" "$cache"
echo "$out/isotherm.img: root $(($(stat -c %s "$out/root.squashfs") / 1000000)) MB compressed, kernel image $(($(stat -c %s "$out/isotherm.efi") / 1000000)) MB"
