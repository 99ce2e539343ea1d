#!/bin/sh
# Makes the image of the disk from what seal.sh has made: a GPT with the EFI system partition (systemd-boot and the kernel image), the slots
# a and b of root and hash tree, b empty.
#
#   disk.sh OUT CACHE        makes OUT/isotherm.img; CACHE: as for kernel.sh
set -eu
here=$(cd "$(dirname "$0")" && pwd)
out=$(cd "$1" && pwd)
PATH=$PATH:/usr/sbin:/sbin
. "$here/arch.sh"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$work/root/esp/EFI/BOOT" "$work/root/esp/EFI/systemd" "$work/root/esp/EFI/Linux" "$work/root/esp/loader"
loader=$(arch_file "$2" "/usr/lib/systemd/boot/efi/systemd-boot$arch_efi.efi")
boot=$work/root/esp/EFI/BOOT/$arch_boot
if [ -n "${ISOTHERM_SB_KEY:-}" ]; then
    sbsign --key "$ISOTHERM_SB_KEY" --cert "$ISOTHERM_SB_CERT" --output "$boot" "$loader" >&2
else
    cp "$loader" "$boot"
fi
cp "$boot" "$work/root/esp/EFI/systemd/systemd-boot$arch_efi.efi"
cp "$out/isotherm.efi" "$work/root/esp/EFI/Linux/isotherm-a.efi"
sed "s/@ROOT_TYPE@/$arch_root/; s/@VERITY_TYPE@/$arch_verity/; s/@ESP_SIZE@/$arch_esp/" "$here/disk.cfg" >"$work/disk.cfg"
# Nobody edits the command line.
printf 'timeout 0\neditor no\nconsole-mode keep\n' >"$work/root/esp/loader/loader.conf"
find "$work/root" -exec touch -d "@$SOURCE_DATE_EPOCH" {} +
genimage --rootpath "$work/root" --tmppath "$work/tmp" --inputpath "$out" --outputpath "$work/out" --config "$work/disk.cfg" >"$out/genimage.log" 2>&1 || {
    tail -n 20 "$out/genimage.log" >&2
    exit 1
}
mv "$work/out/isotherm.img" "$out/isotherm.img"
