#!/bin/sh
# Fetches Debian's kernel without installing it, so that the boot loader of this machine does not change. For another architecture than
# that of this machine it also fetches the boot loader and busybox.
#
#   kernel.sh CACHE        makes CACHE/kernel with the files of the package, and CACHE/kernel.release; with another architecture CACHE/foreign;
#                          does nothing if apt has no newer kernel
set -eu
mkdir -p "$1"
cache=$(cd "$1" && pwd)
PATH=$PATH:/usr/sbin:/sbin
. "$(dirname "$0")/arch.sh"
if [ $arch_foreign = yes ]; then
    . "$(dirname "$0")/../../cmake/foreign_apt.sh"
    foreign_apt "$ISOTHERM_ARCH" "$cache"
fi
release=$(apt-cache depends "linux-image-$ISOTHERM_ARCH" | sed -n 's/^ *Depends: linux-image-//p' | head -n 1)
[ -n "$release" ] || {
    echo "kernel.sh: apt knows no linux-image-$ISOTHERM_ARCH (apt-get update?)" >&2
    exit 1
}
version=$(apt-cache policy "linux-image-$release" | sed -n 's/^ *Candidate: //p')
[ "$(cat "$cache/kernel.release" 2>/dev/null)" != "$release $version" ] || exit 0
rm -rf "$cache/kernel" "$cache/kernel.release" "$cache/foreign"
mkdir "$cache/kernel"
if [ $arch_foreign = yes ]; then
    mkdir "$cache/foreign"
    (cd "$cache/foreign" && apt-get download -q systemd-boot-efi busybox-static && for deb in *.deb; do dpkg-deb -x "$deb" . && rm "$deb"; done)
fi
# Without this option apt would drop root's rights and could not write here.
(cd "$cache/kernel" && apt-get download -q -o "APT::Sandbox::User=$(id -un)" "linux-image-$release")
dpkg-deb -x "$cache"/kernel/linux-image-*.deb "$cache/kernel"
rm "$cache"/kernel/linux-image-*.deb
# The modules where they are with a merged /usr.
mkdir -p "$cache/kernel/usr/lib"
mv "$cache/kernel/lib/modules" "$cache/kernel/usr/lib/modules"
rmdir "$cache/kernel/lib"
ln -s usr/lib "$cache/kernel/lib"
depmod -b "$cache/kernel" "$release"
echo "$release $version" >"$cache/kernel.release"
