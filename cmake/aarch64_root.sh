#!/bin/sh
# Puts Debian 12's arm64 libraries and headers, those that packages.txt names and what they stand on, into a folder: nothing is
# installed, and nothing of this machine's own packages is touched. Does nothing if they are there.
#
#   aarch64_root.sh ROOT
#
# Needs apt and dpkg-deb, about 220 MB from Debian's archive and 800 MB of disk.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
mkdir -p "$1"
root=$(cd "$1" && pwd)
# Libraries only: what runs while building is this machine's.
packages=$(awk '($1 == "build" || $1 == "test") && $2 ~ /^lib/ { print $2 }' "$here/packages.txt" | sort -u)
complete=$root/complete-2 # what is in it; the number rises when this script makes something else
[ "$(cat "$complete" 2>/dev/null)" != "$packages" ] || exit 0

# An apt of its own, which knows one architecture and no package that is installed.
apt=$root/apt
rm -rf "$root/usr" "$root/lib" "$complete" "$apt"
mkdir -p "$apt/lists/partial" "$apt/cache/archives/partial" "$apt/parts"
: >"$apt/status"
keyring=/usr/share/keyrings/debian-archive-keyring.gpg
cat >"$apt/sources.list" <<END
deb [signed-by=$keyring] http://deb.debian.org/debian bookworm main
deb [signed-by=$keyring] http://deb.debian.org/debian-security bookworm-security main
END
cat >"$apt/apt.conf" <<END
APT::Architecture "arm64";
APT::Architectures { "arm64"; };
APT::Install-Recommends "false";
APT::Sandbox::User "$(id -un)";
Dir::State "$apt";
Dir::State::lists "$apt/lists";
Dir::State::status "$apt/status";
Dir::Cache "$apt/cache";
Dir::Etc::sourcelist "$apt/sources.list";
Dir::Etc::sourceparts "$apt/parts";
Dir::Etc::preferencesparts "$apt/parts";
END
APT_CONFIG=$apt/apt.conf
export APT_CONFIG
apt-get update -q >"$apt/log"

# shellcheck disable=SC2086
apt-get install -q -y --download-only $packages libc6-dev libstdc++-12-dev >>"$apt/log"

mkdir -p "$root/usr/lib" "$root/usr/bin"
ln -s usr/lib "$root/lib"
for deb in "$apt"/cache/archives/*.deb; do
    dpkg-deb --fsys-tarfile "$deb" |
        tar -x -C "$root" --keep-directory-symlink --wildcards './lib/*' './usr/lib/*' './usr/include/*' './usr/share/pkgconfig/*' \
            2>/dev/null || true # a package has not all of them
done

# What scripts of packages would have done, and absolute links, which lead out of the folder.
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
