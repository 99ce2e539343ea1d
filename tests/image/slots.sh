#!/bin/sh
# Tests board/image/programs/boot-slots, with which RAUC reads and writes the boot entries, check-update, which refuses updates, and
# prepare-rauc, on a directory instead of the EFI system partition.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
programs=$here/../../board/image/programs
ISOTHERM_ROOT=$(mktemp -d)
ISOTHERM_ESP=$ISOTHERM_ROOT/efi
export ISOTHERM_ROOT ISOTHERM_ESP
trap 'rm -rf "$ISOTHERM_ROOT"' EXIT
entries=$ISOTHERM_ESP/EFI/Linux
mkdir -p "$entries" "$ISOTHERM_ROOT/run/isotherm" "$ISOTHERM_ROOT/etc/rauc" "$ISOTHERM_ROOT/usr/lib" "$ISOTHERM_ROOT/bundle" "$ISOTHERM_ROOT/var/lib/rauc" "$ISOTHERM_ROOT/bin"

die() {
    echo "FAILED: $1; $(find "$entries" -type f -printf '%f %s, ')"
    exit 1
}

slots() {
    "$programs/boot-slots" "$@"
}

# gives EXPECTED ARGUMENTS...
gives() {
    expected=$1
    shift
    found=$(slots "$@") || found="an end with $?"
    [ "$found" = "$expected" ] || die "boot-slots $*: '$found', not '$expected'"
}

has() {
    [ "$(find "$entries" -type f -exec basename {} \; | LC_ALL=C sort | tr '\n' ' ')" = "$1 " ] || die "the entries are not $1"
}

# kernel VERSION [LATER]: what looks like a kernel image; its version is not in the first sector, and LATER behind it is none
kernel() {
    printf 'MZ'
    head -c 100000 /dev/urandom | tr -d '\n'
    printf '\nIMAGE_ID=isotherm-qemu\nIMAGE_VERSION=%s\n\0\0rest\n%s\n' "$1" "${2:-}"
}

kernel 0.1.0-2 IMAGE_VERSION=9.9.9-9 >"$ISOTHERM_ROOT/2.efi"
kernel 0.1.0-10 >"$ISOTHERM_ROOT/10.efi"

# is NAME VERSION: the entry has this kernel image
is() {
    cmp -s "$ISOTHERM_ROOT/$2.efi" "$entries/$1" || die "$1 is not version $2"
}

# without_begin NAME: as a power cut leaves a kernel image that is being written or deleted
without_begin() {
    dd if=/dev/zero of="$entries/$1" bs=512 count=1 conv=notrunc status=none
}

on_trial() {
    [ "$(slots get-trial "$1")" = yes ] || die "slot $1 is not on trial"
}

not_on_trial() {
    [ "$(slots get-trial "$1")" = no ] || die "slot $1 is on trial"
}

# The disk as it was flashed.
cp "$ISOTHERM_ROOT/2.efi" "$entries/isotherm-a.efi"
gives a get-primary
gives good get-state a
gives bad get-state b
gives 'an end with 1' get-trial b
slots set-state b bad
has isotherm-a.efi
not_on_trial a
if slots set-primary b; then
    die 'a slot without a kernel image is started'
fi

# An update in slot b. What comes next to the entries is none.
slots bring b "$ISOTHERM_ROOT/10.efi"
has 'isotherm-a.efi isotherm-b.new'
gives a get-primary
gives bad get-state b
slots set-primary b
has 'isotherm-a.efi isotherm-b+3.efi'
is isotherm-b+3.efi 10
gives b get-primary # 0.1.0-10 is newer than 0.1.0-2
gives good get-state b
on_trial b

# systemd-boot counts; after the last attempt the other slot is next.
mv "$entries/isotherm-b+3.efi" "$entries/isotherm-b+1-2.efi"
gives b get-primary
mv "$entries/isotherm-b+1-2.efi" "$entries/isotherm-b+0-3.efi"
gives bad get-state b
gives a get-primary
on_trial b

# The first start of three: for RAUC the slot is good, because it can be started, but it is on trial. A good slot is not counted.
mv "$entries/isotherm-b+0-3.efi" "$entries/isotherm-b+2-1.efi"
gives b get-primary
gives good get-state b
on_trial b
slots set-state b good
has 'isotherm-a.efi isotherm-b.efi'
gives good get-state b
is isotherm-b.efi 10
not_on_trial b
slots set-state b good
has 'isotherm-a.efi isotherm-b.efi'
is isotherm-b.efi 10

# A power cut while it becomes good: its new name has no first sector yet, or both names are complete, or the old one has none any more.
cp "$entries/isotherm-b.efi" "$entries/isotherm-b+2-1.efi"
without_begin isotherm-b.efi
gives b get-primary
on_trial b
slots set-state b good
has 'isotherm-a.efi isotherm-b.efi'
is isotherm-b.efi 10
for left in complete not; do
    cp "$entries/isotherm-b.efi" "$entries/isotherm-b+2-1.efi"
    [ $left = complete ] || without_begin isotherm-b+2-1.efi
    gives good get-state b
    not_on_trial b
    slots set-state b good
    has 'isotherm-a.efi isotherm-b.efi'
    is isotherm-b.efi 10
done

# Without room for a copy a slot becomes good all the same.
mv "$entries/isotherm-b.efi" "$entries/isotherm-b+2-1.efi"
(
    trap '' XFSZ
    ulimit -f 100
    slots set-state b good 2>"$ISOTHERM_ROOT/said"
) || die "without room a slot does not become good: $(cat "$ISOTHERM_ROOT/said")"
grep -q 'there is no room' "$ISOTHERM_ROOT/said" || die 'there was room'
has 'isotherm-a.efi isotherm-b.efi'
is isotherm-b.efi 10

# The slot that is about to be written cannot be started.
slots set-state a bad
has isotherm-b.efi
gives bad get-state a
gives b get-primary

# ---- a power cut between any two steps ----

# A program `sync` that counts, and ends boot-slots at the count of the file `cut`; what is complete then is one of the known versions.
cat >"$ISOTHERM_ROOT/bin/sync" <<'STOP'
#!/bin/sh
n=$(($(cat "$ISOTHERM_ROOT/syncs") + 1))
echo $n >"$ISOTHERM_ROOT/syncs"
[ $n -ne "$(cat "$ISOTHERM_ROOT/cut")" ] || kill -9 $PPID
STOP
chmod 755 "$ISOTHERM_ROOT/bin/sync"

# all_complete: each name that systemd-boot shows has a whole version
all_complete() {
    for file in "$entries"/*.efi; do
        [ "$(head -c 2 "$file" 2>/dev/null)" != MZ ] || cmp -s "$file" "$ISOTHERM_ROOT/2.efi" || cmp -s "$file" "$ISOTHERM_ROOT/10.efi" || die "cut at $cut of $*: $file is not whole"
    done
}

# cut_everywhere BEFORE ARGUMENTS...: boot-slots is ended at each of its steps; BEFORE makes the entries
cut_everywhere() {
    before=$1
    shift
    cut=0 ended=137
    while [ $ended -eq 137 ]; do
        cut=$((cut + 1)) ended=0
        rm -f "$entries"/*
        $before
        echo 0 >"$ISOTHERM_ROOT/syncs"
        echo $cut >"$ISOTHERM_ROOT/cut"
        PATH=$ISOTHERM_ROOT/bin:$PATH "$programs/boot-slots" "$@" 2>/dev/null || ended=$?
        [ $ended -eq 137 ] || [ $ended -eq 0 ] || die "boot-slots $* ends with $ended"
        all_complete "$@"
        gives good get-state a
        # The next start, and its check.
        slots tidy
        all_complete "$@"
        gives good get-state a
        [ "$(find "$entries" -type f ! -name '*.efi')" = '' ] || die "cut at $cut of $*: something is left"
        if [ "$(slots get-state b)" = good ]; then
            slots set-state b good
            has 'isotherm-a.efi isotherm-b.efi'
            is isotherm-b.efi 10
        fi
    done
    [ $cut -gt 6 ] || die "boot-slots $* has only $cut steps"
    steps=$((steps + cut))
}

one_and_new() {
    cp "$ISOTHERM_ROOT/2.efi" "$entries/isotherm-a.efi"
    cp "$ISOTHERM_ROOT/10.efi" "$entries/isotherm-b.new"
}

one_and_counted() {
    cp "$ISOTHERM_ROOT/2.efi" "$entries/isotherm-a.efi"
    cp "$ISOTHERM_ROOT/10.efi" "$entries/isotherm-b+2-1.efi"
}

steps=0
cut_everywhere one_and_new set-primary b
cut_everywhere one_and_new bring b "$ISOTHERM_ROOT/10.efi"
cut_everywhere one_and_counted set-state b good
cut_everywhere one_and_counted set-state b bad
rm -f "$entries"/*
cp "$ISOTHERM_ROOT/10.efi" "$entries/isotherm-b.efi"
echo "    boot-slots: every state of both slots, and cut at $steps steps"

# ---- check-update ----

# update COMPATIBLE VERSION CODE: check-update ends with this code for such an update
update() {
    printf '[update]\ncompatible=%s\nversion=%s\n\n[bundle]\nformat=verity\n' "$1" "$2" >"$ISOTHERM_ROOT/bundle/manifest.raucm"
    code=0
    RAUC_UPDATE_SOURCE=$ISOTHERM_ROOT/bundle "$programs/check-update" 2>"$ISOTHERM_ROOT/said" || code=$?
    [ $code -eq "$3" ] || die "check-update ends with $code for version $2 of $1, not with $3: $(cat "$ISOTHERM_ROOT/said")"
}

echo SLOT=b >"$ISOTHERM_ROOT/run/isotherm/slot"
printf '[system]\ncompatible=isotherm-qemu-amd64\nbootloader=custom\n' >"$ISOTHERM_ROOT/etc/rauc/system.conf"
printf 'ID=debian\nIMAGE_ID=isotherm-qemu\nIMAGE_VERSION="0.1.0-9"\n' >"$ISOTHERM_ROOT/usr/lib/os-release"
kernel 0.1.0-11 >"$ISOTHERM_ROOT/bundle/isotherm.efi"
update isotherm-rock-5b-amd64 0.1.0-10 4
update isotherm-qemu-amd64 0.1.0-9 3
update isotherm-qemu-amd64 0.1.0-8 3
update isotherm-qemu-amd64 0.1.0~rc1 3
has isotherm-b.efi # the kernel image of a refused update is not copied
mv "$entries/isotherm-b.efi" "$entries/isotherm-b+2-1.efi"
update isotherm-qemu-amd64 0.1.0-10 5
has isotherm-b+2-1.efi # the last good version would be replaced while the running one is on trial
mv "$entries/isotherm-b+2-1.efi" "$entries/isotherm-b.efi"
for attempt in first second; do # the second finds what the first has left
    update isotherm-qemu-amd64 0.1.0-10 0
    cmp -s "$ISOTHERM_ROOT/bundle/isotherm.efi" "$entries/isotherm-a.new" || die "check-update does not copy the kernel image of a good update, $attempt time"
done
echo '    check-update: for another board, older, the same, on trial, newer'

# ---- prepare-rauc ----

state=$ISOTHERM_ROOT/var/lib/rauc/status

# prepares CONTENT WORDS: the state has this line, and the program says these words, or nothing
prepares() {
    "$programs/prepare-rauc" >"$ISOTHERM_ROOT/said" || die 'prepare-rauc fails'
    grep -qxF "$1" "$state" || die "the state of RAUC has no line $1: $(cat "$state")"
    if [ -n "$2" ]; then
        grep -q "$2" "$ISOTHERM_ROOT/said" || die "prepare-rauc does not say: $2"
    else
        [ ! -s "$ISOTHERM_ROOT/said" ] || die "prepare-rauc says: $(cat "$ISOTHERM_ROOT/said")"
    fi
}

without_begin isotherm-b.efi
cp "$ISOTHERM_ROOT/2.efi" "$entries/isotherm-a.efi"
: >"$ISOTHERM_ESP/FSCK0000.REC"
prepares '[system]' ''
has isotherm-a.efi
[ ! -e "$ISOTHERM_ESP/FSCK0000.REC" ] || die 'what fsck.vfat has left stays'
: >"$state"
prepares '[system]' 'has no content'
printf '[slot.root.1]\nstatus=ok\n' >"$state"
prepares 'status=ok' ''
has isotherm-a.efi
# No room, and no EFI system partition: RAUC starts all the same.
rm -r "$state" "$ISOTHERM_ESP"
mkdir "$state.prepared"
"$programs/prepare-rauc" >"$ISOTHERM_ROOT/said" 2>&1 || die 'prepare-rauc keeps RAUC from its work'
[ "$(grep -c 'WARNING' "$ISOTHERM_ROOT/said")" -eq 2 ] || die "prepare-rauc says: $(cat "$ISOTHERM_ROOT/said")"
echo '    prepare-rauc: no state, an empty one, a real one, and what an update has left'
