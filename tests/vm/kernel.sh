#!/bin/sh
# Prepares the files that a virtual machine boots: Debian's kernel and modules (not installed, so that the boot loader of this machine does
# not change), gpio-sim built from Debian's kernel source (Debian's kernel leaves it out), and an initial RAM disk.
#
#   kernel.sh CACHE        makes CACHE/{release,vmlinuz,initrd,root/lib/modules,gpio-sim.ko,firmware_path.ko}; does nothing if they are there
#
# Needs apt with Debian 12's package lists, a compiler, make, xz, busybox-static, cpio, kmod: the tag `vm` of cmake/packages.txt.
# ISOTHERM_ARCH=arm64 makes the files of the arm64 image's test, CACHE/{release,root/lib/modules,gpio-sim.ko}: needs the tag `arm64`, too.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
mkdir -p "$1"
cache=$(cd "$1" && pwd)
case ${ISOTHERM_ARCH:-amd64} in amd64) arch='' ;; *) arch=-$ISOTHERM_ARCH ;; esac
complete=$cache/complete-6$arch # raise the number when this script makes other files
[ ! -e "$complete" ] || exit 0

. "$here/../../board/image/arch.sh"
# Lists of another architecture also have what is for all of them: common headers and source. Only kbuild's programs run on this machine.
if [ $arch_foreign = yes ]; then
    . "$here/../../cmake/foreign_apt.sh"
    (foreign_apt "$ISOTHERM_ARCH" "$cache")
    foreign="APT_CONFIG=$cache/apt/apt.conf"
fi
# linux-image-amd64 depends on one release, such as linux-image-6.1.0-56-amd64.
release=$(env ${foreign:-} apt-cache depends "linux-image-$ISOTHERM_ARCH" | sed -n 's/^ *Depends: linux-image-//p' | head -n 1)
[ -n "$release" ] || {
    echo "kernel.sh: apt knows no linux-image-$ISOTHERM_ARCH (apt-get update?)" >&2
    exit 1
}
version=$(env ${foreign:-} apt-cache policy "linux-image-$release" | sed -n 's/^ *Candidate: //p')

download() {
    mkdir -p "$cache/deb"
    # Without this option apt would drop root's rights and could not write here.
    (cd "$cache/deb" && env ${foreign:-} apt-get download -q -o "APT::Sandbox::User=$(id -un)" "linux-image-$release" "linux-headers-$release" \
        "linux-headers-${release%-"$ISOTHERM_ARCH"}-common=$version" "linux-source-6.1=$version" &&
        apt-get download -q -o "APT::Sandbox::User=$(id -un)" linux-kbuild-6.1)
}

unpack() {
    rm -rf "$cache/root" "$cache/gpio-sim"
    mkdir -p "$cache/root" "$cache/gpio-sim/source"
    for deb in "$cache"/deb/linux-image-*.deb "$cache"/deb/linux-headers-*.deb "$cache"/deb/linux-kbuild-*.deb; do
        dpkg-deb -x "$deb" "$cache/root"
    done
    dpkg-deb --fsys-tarfile "$cache"/deb/linux-source-*.deb | tar -xO ./usr/src/linux-source-6.1.tar.xz |
        tar -xJ -C "$cache/gpio-sim/source" --strip-components=1 linux-source-6.1/drivers/gpio linux-source-6.1/kernel/irq
    depmod -b "$cache/root" "$release"
}

# Links two modules of the kernel into one: Debian's kernel lacks the simulated interrupts that gpio-sim needs. They use one function that
# is not available to modules; another function gives modules the same descriptor.
build_gpio_sim() {
    module=$cache/gpio-sim/module
    mkdir -p "$module"
    # If a chip is unplugged while a process waits for its edges, its interrupts are freed, but this kernel continues to use them: after some
    # removals it fails. This build never frees them, which costs a little memory at each removal.
    sed -e 's/devm_irq_domain_create_sim(dev, /irq_domain_create_sim(/' \
        -e 's/irq_dispose_mapping(irq_find_mapping(chip->irq_sim, i))/(void)i/' \
        "$cache/gpio-sim/source/drivers/gpio/gpio-sim.c" >"$module/gpio_sim_main.c"
    cp "$cache/gpio-sim/source/drivers/gpio/gpiolib.h" "$module"
    sed 's/irq_to_desc(irqnum)/irq_data_to_desc(irq_get_irq_data(irqnum))/' \
        "$cache/gpio-sim/source/kernel/irq/irq_sim.c" >"$module/irq_sim.c"
    printf 'obj-m := gpio-sim.o\ngpio-sim-y := gpio_sim_main.o irq_sim.o\n' >"$module/Makefile"
    build_module gpio-sim "$module"
}

# The module that gives the virtual USB host the name that libcamera needs.
build_firmware_path() {
    module=$cache/gpio-sim/firmware_path
    mkdir -p "$module"
    cp "$here/firmware_path.c" "$module"
    echo 'obj-m := firmware_path.o' >"$module/Makefile"
    build_module firmware_path "$module"
}

# build_module NAME DIRECTORY
build_module() {
    make -C "$headers" "M=$2" ${cross:-} modules >"$cache/$1.log" 2>&1 || {
        tail -n 20 "$cache/$1.log" >&2
        exit 1
    }
    cp "$2/$1.ko" "$cache/$1.ko"
}

# Only what mounts the root: busybox and the modules of virtio, 9p and overlay, in the order in which they are loaded.
make_initrd() {
    tree=$cache/initrd.d
    rm -rf "$tree"
    mkdir -p "$tree/bin" "$tree/modules" "$tree/proc" "$tree/dev" "$tree/host" "$tree/write" "$tree/new"
    cp /bin/busybox "$tree/bin/busybox"
    cp "$here/init.sh" "$tree/init"
    chmod 755 "$tree/init"
    for name in virtio_pci 9pnet_virtio 9p overlay; do
        modprobe -d "$cache/root" -S "$release" --show-depends "$name"
    done | awk '$1 == "insmod" && !seen[$2]++ { print $2 }' | while read -r path; do
        cp "$path" "$tree/modules"
        basename "$path"
    done >"$tree/modules/order"
    (cd "$tree" && find . | cpio -o -H newc --quiet | gzip -1) >"$cache/initrd"
}

download
unpack
headers=$cache/root/usr/src/linux-headers-$release
sed -i "s#include /usr/src/#include $cache/root/usr/src/#" "$headers/Makefile"
[ $arch_foreign = no ] || cross="ARCH=$ISOTHERM_ARCH CROSS_COMPILE=$arch_multiarch-"
build_gpio_sim
# The machine of the arm64 image starts by its own boot loader and has no camera.
if [ "$ISOTHERM_ARCH" = amd64 ]; then
    build_firmware_path
    make_initrd
    cp "$cache/root/boot/vmlinuz-$release" "$cache/vmlinuz"
fi
echo "$release" >"$cache/release"
rm -rf "$cache/deb" "$cache/gpio-sim" "$cache/initrd.d"
touch "$complete"
echo "virtual machine: Linux $release ($version), gpio-sim built"
