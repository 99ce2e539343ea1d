#!/bin/sh
# Seals a root: a squashfs file system, its tree of hashes (dm-verity), and one kernel image for UEFI with initial RAM disk and command line
# (a unified kernel image). The command line has the root hash, so the signature of the kernel image also covers the root.
#
#   seal.sh ROOT CACHE OUT      makes OUT/root.squashfs, OUT/root.verity, OUT/root.hash, OUT/isotherm.efi, OUT/os-release, OUT/arch
#
# ISOTHERM_SB_KEY, ISOTHERM_SB_CERT: key and certificate for Secure Boot; without them the kernel image is not signed.
# ISOTHERM_CMDLINE: further words of the kernel's command line.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
root=$1 cache=$2 out=$3
PATH=$PATH:/usr/sbin:/sbin
. "$here/arch.sh"
stub=$(arch_file "$cache" "/usr/lib/systemd/boot/efi/linux$arch_efi.efi.stub")
release=$(cut -d ' ' -f 1 "$cache/kernel.release")

rm -f "$out/root.squashfs" "$out/root.verity"
# The file system and all files have the same time.
env -u SOURCE_DATE_EPOCH mksquashfs "$root" "$out/root.squashfs" -quiet -no-progress -noappend -comp "${ISOTHERM_COMPRESSION:-zstd}" -b 256K \
    -mkfs-time "$SOURCE_DATE_EPOCH" -all-time "$SOURCE_DATE_EPOCH" -no-exports >&2
# The salt is fixed, so that the same root has the same hash; it does not have to be secret.
salt=$(sha256sum "$out/root.squashfs" | cut -c 1-64)
veritysetup format "$out/root.squashfs" "$out/root.verity" --salt "$salt" --uuid "$(echo "$salt" | sed 's/^\(.\{8\}\)\(.\{4\}\)\(.\{4\}\)\(.\{4\}\)\(.\{12\}\).*/\1-\2-\3-\4-\5/')" |
    sed -n 's/^Root hash:[[:space:]]*//p' >"$out/root.hash"
"$here/initrd.sh" "$root" "$cache" "$out/initrd"
# gpt: if the first copy of the partition table is not whole, as after a power cut while it was written, the kernel reads the second one.
echo "isotherm.roothash=$(cat "$out/root.hash") ro gpt panic=10 systemd.gpt_auto=0 systemd.import_credentials=0 ${ISOTHERM_CMDLINE:-console=tty0 module.sig_enforce=1}" >"$out/cmdline"

# For bundle.sh.
echo "$ISOTHERM_ARCH" >"$out/arch"

# The sections of the stub (systemd-stub(7)), one behind the other.
rm -f "$out/isotherm.efi"
cp "$root/usr/lib/os-release" "$out/os-release"
set -- .osrel "$out/os-release" .cmdline "$out/cmdline" .linux "$cache/kernel/boot/vmlinuz-$release" .initrd "$out/initrd"
address=$("${arch_objcopy%copy}dump" -h "$stub" | awk '$1 ~ /^[0-9]+$/ { print "0x" $3, "0x" $4 }' | while read -r size start; do echo $((size + start)); done | sort -n | tail -n 1)
options=
while [ $# -gt 0 ]; do
    address=$(((address + 4095) / 4096 * 4096))
    options="$options --add-section $1=$2 --change-section-vma $1=$(printf 0x%x "$address")"
    address=$((address + $(stat -Lc %s "$2")))
    shift 2
done
# shellcheck disable=SC2086 # words
"$arch_objcopy" $options "$stub" "$out/isotherm.efi"
# objcopy writes the present time into the header, eight bytes behind its begin, and a check sum over that, 88 bytes behind. UEFI does not
# use the sum; zero says that there is none.
header=$(od -An -tu4 -j60 -N4 "$out/isotherm.efi" | tr -d ' ')
printf "$(printf '\\%03o' $((SOURCE_DATE_EPOCH & 255)) $((SOURCE_DATE_EPOCH >> 8 & 255)) $((SOURCE_DATE_EPOCH >> 16 & 255)) $((SOURCE_DATE_EPOCH >> 24 & 255)))" |
    dd of="$out/isotherm.efi" bs=1 seek=$((header + 8)) conv=notrunc status=none
head -c 4 /dev/zero | dd of="$out/isotherm.efi" bs=1 seek=$((header + 88)) conv=notrunc status=none
if [ -n "${ISOTHERM_SB_KEY:-}" ]; then
    sbsign --key "$ISOTHERM_SB_KEY" --cert "$ISOTHERM_SB_CERT" --output "$out/isotherm.efi" "$out/isotherm.efi" >&2
else
    echo 'seal.sh: no ISOTHERM_SB_KEY: the kernel image is not signed' >&2
fi
