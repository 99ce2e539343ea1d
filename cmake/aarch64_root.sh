#!/bin/sh
# Puts Debian 12's arm64 libraries and headers into a folder: those that packages.txt names and their dependencies. It installs nothing
# and does not change the packages of this machine. It does nothing if the folder is complete.
#
#   aarch64_root.sh ROOT
#
# Needs apt and dpkg-deb, about 220 MB from Debian's archive and 800 MB of disk.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
mkdir -p "$1"
root=$(cd "$1" && pwd)
# Only libraries: the tools of the build are programs of this machine.
packages=$(awk '($1 == "build" || $1 == "test") && $2 ~ /^lib/ { print $2 }' "$here/packages.txt" | sort -u)
complete=$root/complete-2 # the list of its packages; raise the number when this script makes another folder from the same list
[ "$(cat "$complete" 2>/dev/null)" != "$packages" ] || exit 0

rm -rf "$root/usr" "$root/lib" "$complete"
. "$here/foreign_apt.sh"
foreign_apt arm64 "$root"

# shellcheck disable=SC2086
apt-get install -q -y --no-install-recommends --download-only $packages libc6-dev libstdc++-12-dev >>"$apt/log"

mkdir -p "$root/usr/lib" "$root/usr/bin"
ln -s usr/lib "$root/lib"
for deb in "$apt"/cache/archives/*.deb; do
    dpkg-deb --fsys-tarfile "$deb" |
        tar -x -C "$root" --keep-directory-symlink --wildcards './lib/*' './usr/lib/*' './usr/include/*' './usr/share/pkgconfig/*' \
            2>/dev/null || true # not every package has files in all of these folders
done

# Makes the links that the scripts of the packages would make, and makes absolute links relative, because they lead out of the folder.
lib=$root/usr/lib/aarch64-linux-gnu
for name in libblas.so libblas.so.3 liblapack.so liblapack.so.3 libopenblas.so libopenblas.so.0; do
    ln -sf "openblas-pthread/$name" "$lib/$name"
done
for name in cblas.h openblas_config.h; do
    ln -sf "openblas-pthread/$name" "$root/usr/include/aarch64-linux-gnu/$name"
done
find "$root/usr/lib" -type l -lname '/*' | while read -r link; do
    target=$(readlink "$link")
    [ ! -e "$root$target" ] || ln -sf -r "$root$target" "$link"
done
count=$(find "$apt/cache/archives" -name '*.deb' | wc -l)
rm -rf "$apt/cache" "$apt/lists"
echo "$packages" >"$complete"
echo "arm64: $count packages in $root"
