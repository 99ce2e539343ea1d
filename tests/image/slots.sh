#!/bin/sh
# Tests board/image/programs/boot-slots, with which RAUC reads and writes the boot entries, on a directory instead of the EFI system partition.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
ISOTHERM_ESP=$(mktemp -d)
export ISOTHERM_ESP
trap 'rm -rf "$ISOTHERM_ESP"' EXIT
entries=$ISOTHERM_ESP/EFI/Linux
mkdir -p "$entries"

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
gives bad get-state b
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

# systemd-boot counts; after the last attempt the other slot is next.
mv "$entries/isotherm-b+3.efi" "$entries/isotherm-b+1-2.efi"
gives b get-primary
mv "$entries/isotherm-b+1-2.efi" "$entries/isotherm-b+0-3.efi"
gives bad get-state b
gives a get-primary

# A good slot is not counted.
mv "$entries/isotherm-b+0-3.efi" "$entries/isotherm-b+2-1.efi"
slots set-state b good
has 'isotherm-a.efi isotherm-b.efi'
slots set-state b good
has 'isotherm-a.efi isotherm-b.efi'

# The slot that is about to be written cannot be started.
slots set-state a bad
has isotherm-b.efi
gives bad get-state a
gives b get-primary
echo '    boot-slots: every state of both slots'
