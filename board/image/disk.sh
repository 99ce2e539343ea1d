#!/bin/sh
# Makes the image of the disk from what seal.sh has made: a GPT with the EFI system partition (systemd-boot and the kernel image), the slots
# a and b of root and hash tree, b empty.
#
#   disk.sh OUT        makes OUT/isotherm.img
set -eu
here=$(cd "$(dirname "$0")" && pwd)
out=$(cd "$1" && pwd)
PATH=$PATH:/usr/sbin:/sbin
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$work/root/esp/EFI/BOOT" "$work/root/esp/EFI/systemd" "$work/root/esp/EFI/Linux" "$work/root/esp/loader"
boot=$work/root/esp/EFI/BOOT/BOOTX64.EFI
if [ -n "${ISOTHERM_SB_KEY:-}" ]; then
    sbsign --key "$ISOTHERM_SB_KEY" --cert "$ISOTHERM_SB_CERT" --output "$boot" /usr/lib/systemd/boot/efi/systemd-bootx64.efi >&2
else
    cp /usr/lib/systemd/boot/efi/systemd-bootx64.efi "$boot"
fi
cp "$boot" "$work/root/esp/EFI/systemd/systemd-bootx64.efi"
cp "$out/isotherm.efi" "$work/root/esp/EFI/Linux/isotherm-a.efi"
sed -n 's/^IMAGE_VERSION=//p' "$out/os-release" >"$work/root/esp/EFI/Linux/isotherm-a.version"
# Nobody edits the command line.
printf 'timeout 0\neditor no\nconsole-mode keep\n' >"$work/root/esp/loader/loader.conf"
find "$work/root" -exec touch -d "@$SOURCE_DATE_EPOCH" {} +
genimage --rootpath "$work/root" --tmppath "$work/tmp" --inputpath "$out" --outputpath "$work/out" --config "$here/disk.cfg" >"$out/genimage.log" 2>&1 || {
    tail -n 20 "$out/genimage.log" >&2
    exit 1
}
mv "$work/out/isotherm.img" "$out/isotherm.img"
