# The architecture of the image, for the scripts of this folder and of tests/image: `. board/image/arch.sh`. Plain sh. ISOTHERM_ARCH is
# Debian's name of it: amd64, which holds if it is not set, or arm64.
#
# It sets
#   arch_efi                   the architecture in the names of systemd-boot's files
#   arch_boot                  the boot loader's file that UEFI starts without an entry of its own
#   arch_multiarch             the folder of the libraries
#   arch_root, arch_verity     the types of the partitions of root and hash tree (Discoverable Partitions Specification)
#   arch_esp                   the size of the EFI system partition: three kernel images at a time fit, one of which an update brings
#   arch_objcopy               the program that puts parts behind the stub
#   arch_foreign               yes: the machine of the build has another architecture
# shellcheck disable=SC2034 # for those scripts
ISOTHERM_ARCH=${ISOTHERM_ARCH:-amd64}
export ISOTHERM_ARCH
case $ISOTHERM_ARCH in
amd64)
    arch_efi=x64 arch_boot=BOOTX64.EFI arch_multiarch=x86_64-linux-gnu arch_esp=96M
    arch_root=4f68bce3-e8cd-4db1-96e7-fbcaf984b709 arch_verity=2c7357ed-ebd2-46d9-aec1-23d437ec2bf5
    ;;
arm64)
    arch_efi=aa64 arch_boot=BOOTAA64.EFI arch_multiarch=aarch64-linux-gnu arch_esp=192M
    arch_root=b921b045-1df0-41c3-af44-4c6f280d3fae arch_verity=df3300ce-d69f-4c92-978c-9bfb0f38d820
    ;;
*)
    echo "arch.sh: ISOTHERM_ARCH=$ISOTHERM_ARCH: images are for amd64 or arm64" >&2
    exit 1
    ;;
esac
arch_foreign=no arch_objcopy=objcopy
if [ "$(dpkg --print-architecture)" != "$ISOTHERM_ARCH" ]; then
    arch_foreign=yes arch_objcopy=$arch_multiarch-objcopy
fi

# arch_file CACHE PATH: prints where a file is that the image takes from a package of the build's machine (systemd-boot-efi,
# busybox-static): there, or in what kernel.sh has fetched for another architecture
arch_file() {
    if [ $arch_foreign = yes ]; then
        echo "$1/foreign$2"
    else
        echo "$2"
    fi
}

# arch_can_run: ends the script if this machine cannot run programs of the image; the root is made by programs that are in it. An emulator
# runs those of another architecture (qemu-user-static), and the kernel has to know it (binfmt_misc). In a container no systemd may have
# told the kernel; then this function does, and the kernel knows it until its next start.
arch_can_run() {
    [ $arch_foreign = yes ] || return 0
    ! arch-test "$ISOTHERM_ARCH" >/dev/null 2>&1 || return 0
    binfmt=/proc/sys/fs/binfmt_misc
    [ -e $binfmt/register ] || mount -t binfmt_misc binfmt_misc $binfmt
    [ -e "$binfmt/qemu-${arch_multiarch%%-*}" ] || cat "/usr/lib/binfmt.d/qemu-${arch_multiarch%%-*}.conf" >$binfmt/register
    arch-test "$ISOTHERM_ARCH" >/dev/null 2>&1 || {
        echo "arch.sh: this machine cannot run programs for $ISOTHERM_ARCH: qemu-user-static and binfmt_misc are needed" >&2
        exit 1
    }
}
