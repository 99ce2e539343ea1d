#!/bin/sh
# Makes the initial RAM disk: busybox, veritysetup, sfdisk, the libraries that these need, the modules of disks, and init.sh.
#
#   initrd.sh ROOT CACHE INITRD      ROOT: the root of the image, from which programs and modules come
set -eu
here=$(cd "$(dirname "$0")" && pwd)
root=$1 cache=$2 initrd=$3
PATH=$PATH:/usr/sbin:/sbin
. "$here/arch.sh"
release=$(cut -d ' ' -f 1 "$cache/kernel.release")
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
mkdir -p "$tree/bin" "$tree/sbin" "$tree/usr/lib" "$tree/proc" "$tree/sys" "$tree/dev" "$tree/run" "$tree/sysroot"
ln -s usr/lib "$tree/lib"
ln -s usr/lib64 "$tree/lib64"
mkdir "$tree/usr/lib64"
cp "$(arch_file "$cache" /bin/busybox)" "$tree/bin/busybox"
install -m 0755 "$here/init.sh" "$tree/init"

# Programs with their libraries.
for program in veritysetup sfdisk; do
    path=$(find "$root/usr/sbin" "$root/usr/bin" -name "$program" | head -n 1)
    cp "$path" "$tree/bin"
    chroot "$root" ldd "${path#"$root"}" | grep -o '/[^ ]*' | while read -r library; do
        mkdir -p "$tree/$(dirname "$library")"
        cp -L "$root$library" "$tree$library"
    done
done

# The modules of the list, with what they need.
files=$("$here/module_files.sh" "$root" "$release" initrd)
for file in $files; do
    install -D -m 0644 "$root/$file" "$tree/$file"
done
cp "$root/usr/lib/modules/$release"/modules.builtin* "$root/usr/lib/modules/$release/modules.order" "$tree/usr/lib/modules/$release"
depmod -b "$tree" "$release"

# The same input gives the same bytes: times, order, owners and numbers of inodes are fixed.
find "$tree" -exec touch -h -d "@$SOURCE_DATE_EPOCH" {} +
(cd "$tree" && find . | LC_ALL=C sort | cpio -o -H newc --quiet --reproducible -R 0:0 | zstd -q -19 -T1) >"$initrd"
