#!/bin/sh
# Tests board/image/programs/boot-slots, with which RAUC reads and writes the boot entries, and check-update, which refuses updates, on a
# directory instead of the EFI system partition.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
ISOTHERM_ROOT=$(mktemp -d)
ISOTHERM_ESP=$ISOTHERM_ROOT/efi
export ISOTHERM_ROOT ISOTHERM_ESP
trap 'rm -rf "$ISOTHERM_ROOT"' EXIT
entries=$ISOTHERM_ESP/EFI/Linux
mkdir -p "$entries" "$ISOTHERM_ROOT/run/isotherm" "$ISOTHERM_ROOT/etc/rauc" "$ISOTHERM_ROOT/usr/lib" "$ISOTHERM_ROOT/bundle"

slots() {
    "$here/../../board/image/programs/boot-slots" "$@"
}

# gives EXPECTED ARGUMENTS...
gives() {
    expected=$1
    shift
    found=$(slots "$@") || found="an end with $?"
    [ "$found" = "$expected" ] || {
        echo "FAILED: boot-slots $*: '$found', not '$expected'; $(ls "$entries" | tr '\n' ' ')"
        exit 1
    }
}

has() {
    [ "$(find "$entries" -name '*.efi' -exec basename {} \; | sort | tr '\n' ' ')" = "$1 " ] || {
        echo "FAILED: $(ls "$entries" | tr '\n' ' '), not $1"
        exit 1
    }
}

# The disk as it was flashed.
: >"$entries/isotherm-a.efi"
echo 0.1.0-2 >"$entries/isotherm-a.version"
gives a get-primary
gives good get-state a
gives no get-trial a
gives bad get-state b
gives 'an end with 1' get-trial b
slots set-state b bad
has isotherm-a.efi
if slots set-primary b; then
    echo 'FAILED: a slot without a kernel image is started'
    exit 1
fi

# An update in slot b.
: >"$entries/isotherm-b.new"
echo 0.1.0-10 >"$entries/isotherm-b.new.version"
gives a get-primary
slots set-primary b
has 'isotherm-a.efi isotherm-b+3.efi'
gives b get-primary # 0.1.0-10 is newer than 0.1.0-2
gives good get-state b
gives yes get-trial b

# systemd-boot counts; after the last attempt the other slot is next.
mv "$entries/isotherm-b+3.efi" "$entries/isotherm-b+1-2.efi"
gives b get-primary
mv "$entries/isotherm-b+1-2.efi" "$entries/isotherm-b+0-3.efi"
gives bad get-state b
gives yes get-trial b
gives a get-primary

# The first start of three: for RAUC the slot is good, because it can be started, but it is on trial. A good slot is not counted.
mv "$entries/isotherm-b+0-3.efi" "$entries/isotherm-b+2-1.efi"
gives b get-primary
gives good get-state b
gives yes get-trial b
slots set-state b good
has 'isotherm-a.efi isotherm-b.efi'
gives good get-state b
gives no get-trial b
slots set-state b good
has 'isotherm-a.efi isotherm-b.efi'

# The slot that is about to be written cannot be started.
slots set-state a bad
has isotherm-b.efi
gives bad get-state a
gives b get-primary
echo '    boot-slots: every state of both slots'

# ---- check-update ----

# update COMPATIBLE VERSION CODE: check-update ends with this code for such an update
update() {
    printf '[update]\ncompatible=%s\nversion=%s\n\n[bundle]\nformat=verity\n' "$1" "$2" >"$ISOTHERM_ROOT/bundle/manifest.raucm"
    code=0
    RAUC_UPDATE_SOURCE=$ISOTHERM_ROOT/bundle "$here/../../board/image/programs/check-update" 2>"$ISOTHERM_ROOT/said" || code=$?
    [ $code -eq "$3" ] || {
        echo "FAILED: check-update ends with $code for version $2 of $1, not with $3: $(cat "$ISOTHERM_ROOT/said")"
        exit 1
    }
}

echo SLOT=b >"$ISOTHERM_ROOT/run/isotherm/slot"
printf '[system]\ncompatible=isotherm-qemu-amd64\nbootloader=custom\n' >"$ISOTHERM_ROOT/etc/rauc/system.conf"
printf 'ID=debian\nIMAGE_ID=isotherm-qemu\nIMAGE_VERSION="0.1.0-9"\n' >"$ISOTHERM_ROOT/usr/lib/os-release"
echo kernel >"$ISOTHERM_ROOT/bundle/isotherm.efi"
update isotherm-rock-5b-amd64 0.1.0-10 4
update isotherm-qemu-amd64 0.1.0-9 3
update isotherm-qemu-amd64 0.1.0-8 3
update isotherm-qemu-amd64 0.1.0~rc1 3
has isotherm-b.efi
[ ! -e "$entries/isotherm-a.new" ] || {
    echo 'FAILED: check-update copies the kernel image of an update that it refuses'
    exit 1
}
mv "$entries/isotherm-b.efi" "$entries/isotherm-b+2-1.efi"
update isotherm-qemu-amd64 0.1.0-10 5
[ ! -e "$entries/isotherm-a.new" ] || {
    echo 'FAILED: check-update lets an update replace the last good version while the running one is on trial'
    exit 1
}
mv "$entries/isotherm-b+2-1.efi" "$entries/isotherm-b.efi"
update isotherm-qemu-amd64 0.1.0-10 0
cmp -s "$ISOTHERM_ROOT/bundle/isotherm.efi" "$entries/isotherm-a.new" && [ "$(cat "$entries/isotherm-a.new.version")" = 0.1.0-10 ] || {
    echo 'FAILED: check-update does not copy the kernel image of a good update'
    exit 1
}
echo '    check-update: for another board, older, the same, on trial, newer'
