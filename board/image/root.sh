#!/bin/sh
# Makes the root of the image in a directory: Debian, Isotherm, the kernel's modules, and the configuration in etc/ and units/.
#
#   root.sh PACKAGES CACHE BOARD ROOT      PACKAGES: the packages of `make packages`; BOARD: a folder of board/
#
# Needs root.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
packages=$(cd "$1" && pwd) cache=$2 board=$3 root=$4
PATH=$PATH:/usr/sbin:/sbin
. "$here/arch.sh"

in_root() {
    chroot "$root" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin LANG=C.UTF-8 DEBIAN_FRONTEND=noninteractive SOURCE_DATE_EPOCH="$SOURCE_DATE_EPOCH" "$@"
}

install_isotherm() {
    mkdir "$root/packages"
    # The board `generic` is a part of the package isotherm.
    board_package=isotherm-board-$board
    [ "$board" != generic ] || board_package=
    for name in $(grep -v '^#' "$here/our_packages.txt") $board_package; do
        cp "$(find "$packages" -name "${name}_*.deb" | head -n 1)" "$root/packages"
    done
    in_root sh -c 'dpkg --install /packages/*.deb' >&2
    rm -r "$root/packages"
}

# Copies the modules of the list and those that they need.
install_modules() {
    release=$(cut -d ' ' -f 1 "$cache/kernel.release")
    modules=usr/lib/modules/$release
    files=$("$here/module_files.sh" "$cache/kernel" "$release")
    echo "$files" | (cd "$cache/kernel" && xargs cp --parents -t "$root")
    cp "$cache/kernel/$modules"/modules.builtin* "$cache/kernel/$modules/modules.order" "$root/$modules"
    depmod -b "$root" "$release"
    install -D -m 0644 "$cache/kernel/usr/share/doc/linux-image-$release/copyright" "$root/usr/share/doc/linux-image-$release/copyright"
}

configure() {
    mkdir -p "$root/efi" "$root/etc/isotherm" "$root/etc/credstore.encrypted" "$root/etc/systemd/network" "$root/usr/lib/isotherm-image"
    install -m 0644 "$here/etc/fstab" "$here/etc/nftables.conf" "$root/etc"
    install -m 0644 "$here/etc/chrony.conf" "$root/etc/chrony/chrony.conf"
    install -D -m 0644 "$here/etc/journald.conf" "$root/usr/lib/systemd/journald.conf.d/image.conf"
    install -D -m 0644 "$here/etc/system.conf" "$root/usr/lib/systemd/system.conf.d/image.conf"
    install -m 0644 "$here/etc/wired.network" "$root/usr/lib/systemd/network/80-wired.network"
    install -m 0644 "$here/etc/image.tmpfiles" "$root/usr/lib/tmpfiles.d/isotherm-image.conf"
    install -m 0644 "$here/etc/stick.rules" "$root/usr/lib/udev/rules.d/90-isotherm-stick.rules"
    install -m 0755 "$here"/programs/* "$root/usr/lib/isotherm-image"
    (cd "$here/units" && find . -type f -exec install -D -m 0644 {} "$root/usr/lib/systemd/system/{}" \;)
    echo isotherm >"$root/etc/hostname"
    printf '127.0.0.1 localhost isotherm\n::1 localhost isotherm\n' >"$root/etc/hosts"
    : >"$root/etc/machine-id"
    ln -sf /run/systemd/resolve/stub-resolv.conf "$root/etc/resolv.conf"
    ln -sf /usr/share/zoneinfo/UTC "$root/etc/localtime"
    version=${ISOTHERM_VERSION:-$(in_root dpkg-query -W -f '${Version}' isotherm)}
    cat >>"$root/usr/lib/os-release" <<END
VARIANT="Isotherm appliance"
VARIANT_ID=isotherm
IMAGE_ID=isotherm-$board
IMAGE_VERSION=$version
END
}

# The certificate by which the image knows its updates; without one, it takes none. Who may install them.
configure_updates() {
    mkdir -p "$root/etc/rauc"
    sed "s/@COMPATIBLE@/isotherm-$board-$ISOTHERM_ARCH/" "$here/etc/rauc.conf" >"$root/etc/rauc/system.conf"
    install -m 0644 "$here/etc/de.pengutronix.rauc.conf" "$root/usr/share/dbus-1/system.d"
    if [ -n "${ISOTHERM_UPDATE_CERT:-}" ]; then
        install -m 0644 "$ISOTHERM_UPDATE_CERT" "$root/etc/rauc/keyring.pem"
    else
        : >"$root/etc/rauc/keyring.pem"
        echo 'root.sh: no ISOTHERM_UPDATE_CERT: this image takes no updates' >&2
    fi
}

# Nobody logs in: no getty, no shell of a rescue, no password. A boot that fails restarts the machine, and the third one falls back.
enable_units() {
    in_root systemctl --quiet enable isotherm-var.service isotherm-configuration.service isotherm-setup.service isotherm-health.service isotherm-update@page.path isotherm-restart@page.path isotherm-update@hub.path isotherm-restart@hub.path nftables.service chrony.service systemd-networkd.service systemd-resolved.service
    in_root systemctl --quiet mask getty.target getty@.service serial-getty@.service console-getty.service container-getty@.service \
        debug-shell.service systemd-ask-password-console.path systemd-ask-password-wall.path systemd-firstboot.service dpkg-db-backup.timer \
        e2scrub_all.timer e2scrub_reap.service fstrim.timer systemd-networkd-wait-online.service proc-sys-fs-binfmt_misc.automount
    for name in emergency rescue; do
        mkdir -p "$root/usr/lib/systemd/system/$name.service.d"
        printf '[Service]\nExecStartPre=\nExecStart=\nExecStart=/usr/bin/systemctl --force reboot\n' \
            >"$root/usr/lib/systemd/system/$name.service.d/image.conf"
    done
    in_root systemctl --quiet set-default multi-user.target
    sed -i -E 's/^([^:]*):[^:]*:[0-9]*:/\1:*:1:/' "$root/etc/shadow"
    # Nobody has a shell; services do not need one.
    sed -i -E 's#:[^:]*$#:/usr/sbin/nologin#' "$root/etc/passwd"
}

# The names and versions of all packages, from which the list of parts is made, while dpkg is there.
list_packages() {
    {
        in_root dpkg-query -W -f '${Package}\t${Version}\t${Architecture}\t${source:Package}\t${source:Version}\n'
        sed "s/^\([^ ]*\) \(.*\)/linux-image-\1\t\2\t$ISOTHERM_ARCH\tlinux\t\2/" "$cache/kernel.release"
    } | LC_ALL=C sort >"$root/usr/lib/isotherm-image/packages"
    "$here/sbom.sh" "$root/usr/lib/isotherm-image/packages" "isotherm-$board" "$version" >"$root/usr/lib/isotherm-image/sbom.spdx.json"
}

remove_what_is_not_needed() {
    awk '!/^#/' "$here/remove.txt" | (cd "$root" && while read -r patterns; do
        # shellcheck disable=SC2086 # patterns
        rm -rf $patterns
    done)
    rm -rf "$root/etc/ld.so.cache" "$root/etc/mtab"
    ln -s ../proc/self/mounts "$root/etc/mtab"
    in_root /sbin/ldconfig
    rm -rf "$root/var/cache"
}

rm -rf "$root"
mkdir -p "$root"
"$here/kernel.sh" "$cache"
tar -x -C "$root" -f "$("$here/root_base.sh" "$packages" "$cache")"
install_isotherm
install_modules
configure
configure_updates
enable_units
list_packages
remove_what_is_not_needed
