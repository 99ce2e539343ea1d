#!/bin/sh
# Checks a disk as a power cut left it, without starting it: it starts a version that is whole, and /var can be opened and is sound.
#
#   check_disk.sh DISK KNOWN WORK [COMMANDS]     KNOWN: a folder with what must not change, and `versions` (cuts.sh); WORK: a folder for copies
#                                                of partitions; COMMANDS: a file with those of debugfs(8) that damage /var, to try this check
#
# Prints one line: the version that starts, its slot, and what is left over of the cut. Prints its faults and exits with 1 if it has some.
#
# systemd-boot takes the newest version (IMAGE_VERSION) of those whose counter is not at zero (systemd-boot(7), "Boot counting"). Not only
# this one has to be whole, but all that it could start: else the way back is no way.
set -eu
disk=$1 known=$2 work=$3 damage=${4:-}
faults=0 left=''
PATH=$PATH:/usr/sbin:/sbin
export LC_ALL=C MTOOLS_SKIP_CHECK=1

fault() {
    echo "fault: $1"
    faults=$((faults + 1))
}

# partition NAME [SECTORS]: copies it, or its begin, into the file NAME
partition() {
    awk -v name="$1" '$1 == name { print $2, $3 }' "$known/partitions" >"$work/place"
    read -r start size <"$work/place"
    rm -f "$work/$1"
    dd if="$disk" of="$work/$1" bs=64k iflag=skip_bytes,count_bytes skip=$((start * 512)) count=$((${2:-$size} * 512)) conv=sparse status=none
    truncate -s $((${2:-$size} * 512)) "$work/$1"
}

partition_table() {
    sfdisk --dump "$disk" 2>"$work/table.errors" | sed '/^device:/d; s/^[^ ]* : /: /' >"$work/table" || true
    cmp -s "$work/table" "$known/table" || fault "the partition table is another one: $(cat "$work/table.errors")"
}

# ---- the EFI system partition ----

# What fsck.vfat may say after a power cut; Linux, the firmware and RAUC do not care: the mark of a file system in use, also where its copy of the
# first sector differs by it; clusters that no file has; a wrong number of free ones; two tables that differ; a file that is being written or
# deleted (*.new, and a kernel image without its first sector) shorter or longer than its directory says. mended() shows that nothing of it stays.
fat() {
    fsck.vfat -n "$work/esp" >"$work/fat" 2>&1 || true
    awk -v incomplete=" $(tr '\n' ' ' <"$work/incomplete")" '
        /^fsck\.fat |^Leaving filesystem unchanged|files, .* clusters$|^ *$/ { next }
        /^ *(Automatically removing dirty bit|Not automatically fixing this|Using first FAT|Auto-correcting|Auto-deleting|Truncating file)/ { next }
        /^Dirty bit is set/ { next }
        /^There are differences between boot sector and its backup|^This is mostly harmless/ { next }
        /^  65:0[01]\/0[01]$/ { next }
        /^Reclaimed [0-9]* unused cluster/ { print "lost clusters"; next }
        /^Free cluster summary wrong|^Free cluster summary uninitialized/ { print "wrong number of free clusters"; next }
        /^FATs differ but appear to be intact/ { print "two tables"; next }
        /^Orphaned long file name part/ { print "half a long name"; next }
        /^\/EFI\/Linux\// { named = $1 ~ /\.new$/ || index(incomplete, " " $1 " "); if (named) next }
        named && /Contains a free cluster .* Assuming EOF/ { print "a new file of another size"; next }
        named && /File size is .* cluster chain length is/ { print "a new file of another size"; named = 0; next }
        { print "FAULT " $0 }' "$work/fat" | sort -u >"$work/fat.said"
    while read -r line; do
        case $line in
        FAULT*) fault "fsck.vfat: ${line#FAULT }" ;;
        *) left="$left; $line" ;;
        esac
    done <"$work/fat.said"
}

# Files that no update may touch.
constant_files() {
    while read -r name; do
        mcopy -n -i "$work/esp" "::$name" - 2>/dev/null | cmp -s - "$known/esp/$name" || fault "$name of the EFI system partition is another one"
    done <"$known/esp.names"
}

# The first sector of the kernel image has zeros only, or the file is empty: it is no program, and systemd-boot does not show it
# (boot-slots; start_begins in cuts.sh tries it).
is_incomplete() {
    [ "$(head -c 512 "$1" | tr -d '\000' | wc -c)" -eq 0 ]
}

# read_entries: writes a line "VERSION HASH NAME" for each entry that can be started
read_entries() {
    : >"$work/entries"
    : >"$work/incomplete"
    mdir -b -i "$work/esp" ::/EFI/Linux 2>/dev/null | sed 's#.*/##' | grep '\.efi$' | sort >"$work/names" || true
    while read -r name; do
        mcopy -n -i "$work/esp" "::EFI/Linux/$name" - >"$work/kernel" 2>/dev/null || true
        if is_incomplete "$work/kernel"; then
            echo "/EFI/Linux/$name" >>"$work/incomplete"
            continue
        fi
        case $name in
        isotherm-[ab]+0.efi | isotherm-[ab]+0-[0-9].efi) continue ;; # no attempt left
        isotherm-[ab].efi | isotherm-[ab]+[1-9].efi | isotherm-[ab]+[1-9]-[0-9].efi) ;;
        *) fault "an entry has the name $name" && continue ;;
        esac
        sum=$(sha256sum <"$work/kernel" | cut -d ' ' -f 1)
        found=$(awk -v sum="$sum" '$1 == sum { print $2, $3 }' "$known/versions")
        [ -n "$found" ] || fault "the kernel image $name is not whole"
        [ -z "$found" ] || echo "$found $name" >>"$work/entries"
    done <"$work/names"
    sort -V -r -o "$work/entries" "$work/entries"
    [ -s "$work/entries" ] || fault 'no entry can be started'
}

# open-var does this at the start. Then there is nothing left to mend, and the same versions can be started.
mended() {
    cp "$work/entries" "$work/entries.before"
    fsck.vfat -a "$work/esp" >"$work/fat" 2>&1 || [ $? -le 1 ] || fault "fsck.vfat -a: $(tail -n 3 "$work/fat" | tr '\n' ' ')"
    fsck.vfat -n "$work/esp" >"$work/fat" 2>&1 || fault "fsck.vfat -a mends not everything: $(tail -n 3 "$work/fat" | tr '\n' ' ')"
    read_entries
    cmp -s "$work/entries" "$work/entries.before" || fault "after fsck.vfat -a there are other entries: $(tr '\n' ' ' <"$work/entries")"
}

# A directory of one sector is written as a whole: a name that systemd-boot changes is the old one or the new one (boot-slots).
directory_is_one_sector() {
    case $(mshowfat -i "$work/esp" ::/EFI/Linux) in
    *'<'*[!0-9]*'>'*) fault "the directory of the boot entries has more than one sector: $(mshowfat -i "$work/esp" ::/EFI/Linux)" ;;
    esac
}

# slot_of HASH: prints the slot whose tree has this hash at its top, as init.sh looks for it
slot_of() {
    for slot in a b; do
        salt=$(veritysetup dump "$work/root-$slot-verity" 2>/dev/null | sed -n 's/^Salt:[[:space:]]*//p')
        [ -n "$salt" ] || continue
        top=$({
            env printf "$(echo "$salt" | sed 's/../\\x&/g')"
            dd if="$work/root-$slot-verity" bs=4096 skip=1 count=1 status=none
        } | sha256sum | cut -d ' ' -f 1)
        [ "$top" != "$1" ] || echo $slot
    done
}

roots() {
    for part in root-a root-a-verity root-b root-b-verity; do
        partition $part
    done
    while read -r version hash name; do
        slot=$(slot_of "$hash" | head -n 1)
        if [ -z "$slot" ]; then
            fault "$name (version $version): no slot has its root"
        elif ! veritysetup verify "$work/root-$slot" "$work/root-$slot-verity" "$hash" >"$work/verity" 2>&1; then
            fault "$name (version $version): slot $slot is not whole: $(tr '\n' ' ' <"$work/verity")"
        fi
        started=${started:-"version $version from slot $slot by $name"}
    done <"$work/entries"
}

# ---- /var ----

rauc_state() {
    debugfs -R 'cat /lib/rauc/status' "$work/var.ext4" >"$work/rauc" 2>/dev/null
    awk '/^\[[^]]+\]$/ { groups++; next } /^$|^#|^[A-Za-z0-9.-]+=/ { next } { exit 1 } END { if (groups == 0) exit 1 }' "$work/rauc" ||
        fault "the state of RAUC cannot be read: $(head -n 3 "$work/rauc" | tr '\n' ' ')"
}

var() {
    partition var 32768
    mcopy -n -i "$work/esp" ::var.key - >"$work/var.key" 2>/dev/null || true
    rm -f "$work/key" "$work/var.ext4"
    cryptsetup luksDump --batch-mode --dump-volume-key --volume-key-file "$work/key" --key-file "$work/var.key" "$work/var" >"$work/luks" 2>&1 || {
        fault "/var cannot be opened: $(tr '\n' ' ' <"$work/luks")"
        return 0
    }
    "$known/plain_var" "$disk" $((start + 32768)) $((size - 32768)) \
        "$(cryptsetup luksDump "$work/var" | sed -n 's/^[[:space:]]*sector: *\([0-9]*\).*/\1/p')" "$work/key" "$work/var.ext4"
    # As open-var does it at the start; then nothing is left to mend.
    e2fsck -p "$work/var.ext4" >"$work/ext4" 2>&1 || [ $? -le 1 ] || fault "e2fsck -p: $(tail -n 3 "$work/ext4" | tr '\n' ' ')"
    [ -z "$damage" ] || debugfs -w -f "$damage" "$work/var.ext4" >"$work/debugfs" 2>&1
    e2fsck -f -n "$work/var.ext4" >"$work/ext4" 2>&1 || fault "e2fsck -n: $(head -n 3 "$work/ext4" | tr '\n' ' ')"
    debugfs -R 'cat /lib/people.before' "$work/var.ext4" 2>/dev/null | grep -q p01 || fault 'a file that was written before the updates is lost'
    rauc_state
}

mkdir -p "$work"
started=''
partition_table
partition esp
read_entries
[ ! -s "$work/incomplete" ] || left="$left; a kernel image without its first sector"
fat
directory_is_one_sector
constant_files
roots
mended
var
[ $faults -eq 0 ] || exit 1
echo "$started$left"
