#!/bin/sh
# Tests the image of the appliance (board/image): it makes the image and the same one with a unit for the test, and starts the latter as a
# machine with UEFI, from the boot loader on.
#
#   run.sh PACKAGES OUT [CHECK...]      PACKAGES: the packages of `make packages`; without names, all checks of the list below in order
#
# ISOTHERM_ARCH=arm64 tests the image for arm64, with PACKAGES of `make packages-arm64`. IMAGE_KEEP=yes takes the images of the last run.
# Needs root and the tags `image`, `vm` and `install` of cmake/packages.txt, for arm64 also `arm64`. Ends with "N passed, N failed".
set -eu
here=$(cd "$(dirname "$0")" && pwd)
source_dir=$(cd "$here/../.." && pwd)
. "$here/../support/verdict.sh"
. "$source_dir/board/image/arch.sh"
. "$here/machine.sh"
. "$here/watch.sh"
. "$here/production.sh"
. "$here/secure_boot.sh"
. "$here/setup.sh"
. "$here/cuts.sh"
packages=$(cd "$1" && pwd)
mkdir -p "$2/vm"
out=$(cd "$2" && pwd)
shift 2
machine_out=$out/vm
ISOTHERM_CACHE=$out/cache
SOURCE_DATE_EPOCH=$(dpkg-parsechangelog -l "$source_dir/board/debian/changelog" -S Timestamp)
export ISOTHERM_CACHE SOURCE_DATE_EPOCH
all='boot_slots production reproducible first_start later_start updates bring setup power_cuts damaged_root wrong_root tpm secure_boot'
# Those that touch what is built for the architecture: boot loader, kernel, root and our programs.
[ "$ISOTHERM_ARCH" = amd64 ] || all='production first_start later_start damaged_root wrong_root secure_boot'
checks=${*:-$all}

# The keys of this test: of updates, and of somebody else.
make_keys() {
    mkdir -p "$out/keys"
    for name in update other; do
        [ -s "$out/keys/$name.crt" ] || openssl req -x509 -newkey rsa:2048 -nodes -days 3650 -subj "/CN=$name of a test" \
            -keyout "$out/keys/$name.key" -out "$out/keys/$name.crt" 2>"$out/keys/log" || die "keys: $(cat "$out/keys/log")"
    done
}

# The image for doors, and that of the test.
build() {
    rm -rf "$out/bundles"
    "$source_dir/board/image/build.sh" "$packages" "$out/production" qemu >"$out/production.log" 2>&1 || die "building: $(tail -n 5 "$out/production.log")"
    say "the root has $(($(stat -c %s "$out/production/root.squashfs") / 1000000)) MB compressed, at most 120"
    [ "$(stat -c %s "$out/production/root.squashfs")" -le 120000000 ] || die 'the root is too large'
    ISOTHERM_EXTRA=$here/extra.sh ISOTHERM_COMPRESSION=lz4 ISOTHERM_CMDLINE=$machine_cmdline \
        ISOTHERM_UPDATE_CERT=$out/keys/update.crt "$source_dir/board/image/build.sh" "$packages" "$out/test" qemu >"$out/test.log" 2>&1 || die "building: $(tail -n 5 "$out/test.log")"
}

say() {
    echo "    $1"
}

die() {
    echo "FAILED: $1"
    exit 1
}

# ---- the checks ----

boot_slots() {
    "$here/slots.sh"
}

# Two builds have the same bytes.
reproducible() {
    "$source_dir/board/image/build.sh" "$packages" "$out/again" qemu >"$out/again.log" 2>&1 || die "building: $(tail -n 5 "$out/again.log")"
    cmp "$out/production/isotherm.img" "$out/again/isotherm.img" || die 'a second build has other bytes'
    rm -rf "$out/again"
    say 'two builds have the same bytes'
}

first_start() {
    cp --reflink=auto "$out/test/isotherm.img" "$machine_out/first.img"
    # Whoever flashes a card writes the configuration there.
    mcopy -i "$machine_out/first.img@@$(start_of esp)" "$out/test/root/usr/lib/isotherm-image/test.conf" ::isotherm.conf
    machine_disk "$machine_out/first.img" "$machine_out/disk.qcow2"
    machine_start first first "$machine_out/disk.qcow2" || die_with first $?
    tell first
    cp "$machine_out/disk.qcow2" "$machine_out/enrolled.qcow2" # for power_cuts
}

# The first copy of the partition table is not whole any more, as after a power cut while it was written.
later_start() {
    qemu-io -f qcow2 -c 'write -q -P 255 528 4' "$machine_out/disk.qcow2" || die 'the partition table of the disk cannot be written'
    machine_start second second "$machine_out/disk.qcow2" || die_with second $?
    tell second
}

# Needs the disk of first_start.
updates() {
    . "$here/bundles.sh"
    make_bundles
    machine_start update update "$machine_out/disk.qcow2" || die_with update $?
    tell update
    machine_start updated updated "$machine_out/disk.qcow2" || die_with updated $?
    tell updated
    # Three attempts and the way back: this machine may restart.
    machine_reboots=reset machine_start back back "$machine_out/disk.qcow2" || die_with back $?
    tell back
}

# On a machine of its own: its disk is new, and a USB stick is in it.
bring() {
    . "$here/bundles.sh"
    make_bundles
    cp --reflink=auto "$out/test/isotherm.img" "$machine_out/bring.img"
    mcopy -i "$machine_out/bring.img@@$(start_of esp)" "$out/test/root/usr/lib/isotherm-image/test.conf" ::isotherm.conf
    machine_disk "$machine_out/bring.img" "$machine_out/bring.qcow2"
    rm -f "$machine_out/stick.img"
    truncate -s 256M "$machine_out/stick.img"
    mkfs.vfat -n UPDATES "$machine_out/stick.img" >/dev/null
    mcopy -i "$machine_out/stick.img" "$out/bundles/v2.raucb" ::isotherm-2.raucb
    machine_devices="-device qemu-xhci -drive if=none,id=stick,format=raw,file=$machine_out/stick.img -device usb-storage,drive=stick" \
        machine_start brought brought "$machine_out/bring.qcow2" || die_with brought $?
    tell brought
    grep -q 'tell-code: the code for the first account' "$machine_out/brought.log" || die 'the console does not show the code for the first account'
    ! grep -q ' isotherm-web\[' "$machine_out/brought.log" || die 'the console shows lines of the web server'
    say 'the console shows the code for the first account, and nothing else of the web server'
}

# A byte of the root that was changed on the disk: the machine does not start from it. Every 64th block is changed, so that one is read.
damaged_root() {
    cp --reflink=auto "$out/test/isotherm.img" "$machine_out/damaged.img"
    change_bytes "$machine_out/damaged.img" "$(start_of root-a)" "$(stat -c %s "$out/test/root.squashfs")" 262144
    refuses damaged 'device-mapper: verity: .* is corrupted'
}

# Another root with a tree of its own, whose hash the kernel image does not have.
wrong_root() {
    cp --reflink=auto "$out/test/isotherm.img" "$machine_out/damaged.img"
    dd if="$out/production/root.squashfs" of="$machine_out/damaged.img" bs=1M seek=$(($(start_of root-a) / 1048576)) conv=notrunc status=none
    dd if="$out/production/root.verity" of="$machine_out/damaged.img" bs=1M seek=$(($(start_of root-a-verity) / 1048576)) conv=notrunc status=none
    refuses damaged 'no slot has the root of this kernel'
}

# With a TPM the key of /var is in the TPM only. The configuration on this disk has a fault at first, which the console tells.
tpm() {
    rm -rf "$machine_out/tpm"
    mkdir "$machine_out/tpm"
    cp --reflink=auto "$out/test/isotherm.img" "$machine_out/tpm.img"
    sed 's/^unlock_ms = .*/unlock_ms = sometimes/' "$out/test/root/usr/lib/isotherm-image/test.conf" | mcopy -i "$machine_out/tpm.img@@$(start_of esp)" - ::isotherm.conf
    machine_disk "$machine_out/tpm.img" "$machine_out/tpm.qcow2"
    for phase in tpm_first tpm_second; do
        swtpm socket --tpm2 --tpmstate "dir=$machine_out/tpm" --ctrl "type=unixio,path=$machine_out/tpm/socket" --terminate --daemon
        machine_devices="-chardev socket,id=tpm,path=$machine_out/tpm/socket -tpmdev emulator,id=tpm,chardev=tpm -device tpm-crb,tpmdev=tpm" \
            machine_start $phase $phase "$machine_out/tpm.qcow2" || die_with $phase $?
        tell $phase
    done
    grep -q 'take-configuration: .* not taken: isotherm.conf:[0-9]*: .*sometimes' "$machine_out/tpm_first.log" || die 'the console does not say what is wrong with the configuration'
    rm -f "$machine_out/tpm.img" "$machine_out/tpm.qcow2"
    say 'the console says what is wrong with the configuration'
}

# ---- helpers ----

die_with() {
    tr -d '\r' <"$machine_out/$1.log" | tail -n 40
    die "$1 ($2)"
}

# tell NAME: what the machine said about its checks
tell() {
    tr -d '\r' <"$machine_out/$1.log" | grep -E '^ *[0-9]+ s  |^boot to|^memory|^  [a-z-]+ [0-9]+ MB|^Startup' | sed 's/^/    /'
}

# start_of PARTITION: the byte at which it begins
start_of() {
    sfdisk --json "$out/test/isotherm.img" | tr -d ' \n' | sed "s/.*\"start\":\([0-9]*\),[^}]*\"name\":\"$1\".*/\1/" | awk '{ print $1 * 512 }'
}

# change_bytes FILE BEGIN SIZE STEP: changes one byte in every STEP bytes
change_bytes() {
    python3 - "$@" <<'END'
import sys
name, begin, size, step = sys.argv[1], *map(int, sys.argv[2:])
with open(name, 'r+b') as disk:
    for place in range(begin, begin + size, step):
        disk.seek(place)
        byte = disk.read(1)[0]
        disk.seek(place)
        disk.write(bytes([byte ^ 1]))
END
}

# refuses NAME WORDS: the machine with this disk ends without running the test, and its kernel says why
refuses() {
    machine_disk "$machine_out/$1.img" "$machine_out/$1.qcow2"
    code=0
    machine_start "$1" first "$machine_out/$1.qcow2" || code=$?
    [ $code -eq 125 ] || die "the machine ends with $code, not before the test begins"
    grep -qE "$2" "$machine_out/$1.log" || die_with "$1" "the kernel does not say: $2"
    rm -f "$machine_out/$1.img" "$machine_out/$1.qcow2"
    say "the machine does not start: $(grep -oE "$2" "$machine_out/$1.log" | head -n 1)"
}

# Sets processor_seconds, the processor time of all programs that have ended: it says more than the clock if the host does other work, too.
count_processor_seconds() {
    times >"$machine_out/times" # a shell of its own would have used none
    processor_seconds=$(awk 'NR == 2 { gsub("s", ""); for (i = 1; i <= 2; i++) { split($i, part, "m"); sum += 60 * part[1] + part[2] } printf "%.0f", sum }' "$machine_out/times")
}

PATH=$PATH:/usr/sbin:/sbin
[ "$(id -u)" -eq 0 ] || die 'only root can make the image'
"$source_dir/tests/vm/kernel.sh" "$source_dir/$machine_cache"
make_keys
[ "${IMAGE_KEEP:-}" = yes ] || build
passed=0 failed=0
for check in $checks; do
    count_processor_seconds
    began=$(date +%s) used=$processor_seconds
    # Not as the condition of `if`: there a command that fails would not end the check.
    set +e
    (
        set -e
        "$check"
    )
    code=$?
    set -e
    if [ $code -eq 0 ]; then
        passed=$((passed + 1)) result=passed
    else
        failed=$((failed + 1)) result=FAILED
    fi
    count_processor_seconds
    printf '%-14s %-6s %4d s, %4d s of processor time\n' "$check" $result $(($(date +%s) - began)) $((processor_seconds - used))
done
say_tally $passed $failed 0
[ $failed -eq 0 ]
