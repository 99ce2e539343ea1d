#!/bin/busybox sh
# The first process, in the initial RAM disk. It finds the slot whose hash tree has the root hash of the kernel's command line, and starts
# the system from it. The command line is a part of the signed kernel image, so nothing else can be started. A slot is found by its content
# and not by its name, so the same kernel image fits both slots.
#
# If there is none, the machine restarts, and the boot loader counts the attempt.
/bin/busybox --install -s /bin
export PATH=/bin
mount -t proc proc /proc
mount -t sysfs sys /sys
mount -t devtmpfs dev /dev
mount -t tmpfs -o mode=0755,nosuid,nodev run /run

fail() {
    echo "isotherm: $1: the machine restarts" >/dev/kmsg
    sleep 5
    reboot -f
}

# The modules of the machine's devices; a bus shows its devices when its own module is there.
load_modules() {
    for module in squashfs dm-verity sd_mod loop; do
        modprobe -q $module
    done
    for round in 1 2 3; do
        find /sys/devices -name modalias -exec cat {} + | sort -u | xargs -r modprobe -abq 2>/dev/null
    done
}

# device NAME: prints the device of the partition of this name
device() {
    for uevent in /sys/class/block/*/uevent; do
        ! grep -qx "PARTNAME=$1" "$uevent" || {
            echo "/dev/$(sed -n 's/^DEVNAME=//p' "$uevent")"
            return
        }
    done
}

# mount_slot SLOT: a byte that was changed on the disk is found when it is read; the machine then restarts.
mount_slot() {
    data=$(device "root-$1") hashes=$(device "root-$1-verity")
    [ -n "$data" ] && [ -n "$hashes" ] || return 1
    veritysetup open "$data" root "$hashes" "$roothash" --restart-on-corruption || return 1
    mount -t squashfs -o ro /dev/mapper/root /sysroot && return
    veritysetup close root
    return 1
}

# top_is_ours SLOT: the tree of the slot has our root hash: hash of salt and top block
top_is_ours() {
    hashes=$(device "root-$1-verity")
    [ -n "$hashes" ] || return 1
    salt=$(veritysetup dump "$hashes" 2>/dev/null | sed -n 's/^Salt:[[:space:]]*//p')
    [ -n "$salt" ] || return 1
    top=$({
        printf "$(echo "$salt" | sed 's/../\\x&/g')"
        dd if="$hashes" bs=4096 skip=1 count=1 2>/dev/null
    } | sha256sum | cut -d ' ' -f 1)
    [ "$top" = "$roothash" ]
}

# The identifier of the machine is that of its partition of /var; without one, this is the first start, and it is random.
identify() {
    id=
    for uevent in /sys/class/block/*/uevent; do
        if grep -qxE 'PARTNAME=var(-new)?' "$uevent"; then
            id=$(sfdisk --part-uuid "/dev/$(basename "$(readlink -f "${uevent%/uevent}/..")")" "$(cat "${uevent%uevent}partition")")
        fi
    done
    echo "${id:-$(cat /proc/sys/kernel/random/uuid)}" | tr -d - | tr A-Z a-z >/run/machine-id
    chmod 0444 /run/machine-id
    mount --bind /run/machine-id /sysroot/etc/machine-id
}

roothash=$(sed -n 's/.*isotherm.roothash=\([0-9a-f]*\).*/\1/p' /proc/cmdline)
load_modules
for second in 0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19; do
    for slot in a b; do
        top_is_ours $slot && mount_slot $slot && found=$slot && break 2
    done
    sleep 1
    load_modules
done
[ -n "${found:-}" ] || fail 'no slot has the root of this kernel'
mkdir -p /run/isotherm
echo "SLOT=$found" >/run/isotherm/slot
identify
umount /proc /sys
mount -o move /dev /sysroot/dev
mount -o move /run /sysroot/run
exec switch_root /sysroot /sbin/init
