# The check `power_cuts`: `. tests/image/cuts.sh`, in run.sh. Plain sh. Needs the disk of first_start.
#
# One machine makes two updates, and QEMU records every write to its disk and every flush. POWER_CUTS (100) random moments of this log give
# the disks that a power cut would have left (cuts/power_cut.c). Each is checked without a machine (cuts/check_disk.sh), and POWER_CUT_STARTS (5) of
# those that are most at risk start. Before, the same check has to find faults that are put into a disk, and mistakes that are put into the
# log. Set POWER_CUT_SEED to repeat a run; POWER_CUT_KEEP=yes takes the last log.

power_cuts() {
    . "$here/bundles.sh"
    cuts=$out/cuts
    mkdir -p "$cuts"
    make_bundles
    make_version_4
    for program in power_cut plain_var; do
        gcc -D_GNU_SOURCE -I"$source_dir" -O2 -Wall -o "$cuts/$program" "$here/cuts/$program.c" "$here/cuts/write_log.c" "$here/cuts/cut_points.c" -lcrypto || die "$program is not compiled"
    done
    [ "${POWER_CUT_KEEP:-}" = yes ] && [ -e "$cuts/complete" ] || record
    know
    "$cuts/power_cut" stages "$cuts/log" | sed 's/^/    /'
    seed=${POWER_CUT_SEED:-$(od -An -tu4 -N4 /dev/urandom | tr -d ' ')}
    say "POWER_CUT_SEED=$seed"
    faults_are_found
    mistakes_are_found
    points "$cuts/log" "${POWER_CUTS:-100}" "$cuts/points"
    check_points "$cuts/log" "$cuts/points" "$cuts/result"
    tell_points
    [ "$(grep -c '^fault' "$cuts/result")" -eq 0 ] || die 'a power cut leaves a disk with a fault'
    start_begins
    start_cuts
}

# Version 4 is version 2 with another number, and is installed over version 1.
make_version_4() {
    [ ! -e "$out/bundles/v4.raucb" ] || return 0
    rm -rf "$out/versions"
    mkdir -p "$out/versions"
    cp -a "$out/test/root" "$out/versions/root"
    seal_version 4.0.0 "$out/versions/root" "$out/versions/4"
    bundle update "$out/versions/4" v4.raucb
    rm -rf "$out/versions"
}

record() {
    rm -rf "$cuts/complete" "$cuts/log" "$cuts/recorded.qcow2"
    qemu-img convert -f qcow2 -O raw "$machine_out/enrolled.qcow2" "$cuts/base.raw"
    qemu-img create -q -f qcow2 -F raw -b "$cuts/base.raw" "$cuts/recorded.qcow2"
    : >"$cuts/log"
    machine_drive="driver=blklogwrites,file.driver=qcow2,file.file.driver=file,file.file.filename=$cuts/recorded.qcow2,log.driver=file,log.filename=$cuts/log,log.cache.no-flush=on" \
        machine_seconds=1800 machine_reboots=reset machine_start recorded recorded - || die_with recorded $?
    tell recorded
    # The log has everything: all of it makes the disk that the machine left.
    cp --sparse=always "$cuts/base.raw" "$cuts/cut.raw"
    "$cuts/power_cut" apply "$cuts/log" "$cuts/cut.raw" 0 all
    qemu-img compare -q -f raw -F qcow2 "$cuts/cut.raw" "$cuts/recorded.qcow2" || die 'the log does not make the disk that the machine left'
    touch "$cuts/complete"
}

# Writes what check_disk.sh has to know: the partitions, the files that no update may touch, and the kernel images with their root hashes.
know() {
    rm -rf "$cuts/esp"
    mkdir -p "$cuts/esp/EFI/BOOT" "$cuts/esp/loader"
    sfdisk --dump "$cuts/base.raw" | sed '/^device:/d; s/^[^ ]* : /: /' >"$cuts/table"
    sed -n 's/^: start= *\([0-9]*\), size= *\([0-9]*\),.*name="\([^"]*\)".*/\3 \1 \2/p' "$cuts/table" >"$cuts/partitions"
    printf '%s\n' EFI/BOOT/BOOTX64.EFI loader/loader.conf isotherm.conf var.key >"$cuts/esp.names"
    esp_at=$(awk '$1 == "esp" { print $2 * 512 }' "$cuts/partitions")
    while read -r name; do
        mcopy -n -i "$cuts/base.raw@@$esp_at" "::$name" "$cuts/esp/$name" || die "the disk has no $name"
    done <"$cuts/esp.names"
    cp "$out/test/isotherm.efi" "$cuts/1.efi"
    for version in 2 4; do
        unsquashfs -no-progress -f -d "$cuts/bundle" "$out/bundles/v$version.raucb" isotherm.efi >/dev/null
        mv "$cuts/bundle/isotherm.efi" "$cuts/$version.efi"
    done
    : >"$cuts/versions"
    for version in 1 2 4; do
        objcopy -O binary --only-section=.cmdline "$cuts/$version.efi" "$cuts/cmdline"
        objcopy -O binary --only-section=.osrel "$cuts/$version.efi" "$cuts/osrel"
        echo "$(sha256sum <"$cuts/$version.efi" | cut -d ' ' -f 1) $(sed -n 's/^IMAGE_VERSION="*\([^"]*\)"*$/\1/p' "$cuts/osrel") $(sed -n 's/.*isotherm.roothash=\([0-9a-f]*\).*/\1/p' "$cuts/cmdline")" >>"$cuts/versions"
    done
}

# points LOG COUNT FILE
points() {
    "$cuts/power_cut" points "$1" "$cuts/partitions" "$2" "$seed" >"$3"
}

# check_points LOG POINTS RESULT [WORDS]: writes a line "ok|fault POINT STAGE WORDS" for each point; ends at the first fault with WORDS
check_points() {
    cp --sparse=always "$cuts/base.raw" "$cuts/flushed.raw"
    applied=0
    : >"$3"
    while read -r point flushed its_seed stage; do
        "$cuts/power_cut" apply "$1" "$cuts/flushed.raw" $applied "$flushed"
        applied=$flushed
        rm -f "$cuts/cut.raw"
        cp --sparse=always "$cuts/flushed.raw" "$cuts/cut.raw"
        "$cuts/power_cut" cut "$1" "$cuts/cut.raw" "$flushed" "$point" "$its_seed"
        if "$here/cuts/check_disk.sh" "$cuts/cut.raw" "$cuts" "$cuts/work" >"$cuts/verdict"; then
            echo "ok $point $stage $(cat "$cuts/verdict")" >>"$3"
        else
            echo "fault $point $stage $(tr '\n' ';' <"$cuts/verdict")" >>"$3"
        fi
        [ -z "${4:-}" ] || ! tail -n 1 "$3" | grep -qE "^fault .*$4" || break
    done <"$2"
}

# What became of the points of each stage.
tell_points() {
    awk '{ key = $3; if (!(key in n)) order[++stages] = key; n[key]++
           if ($1 == "ok") { version[key, $5]++; versions[$5] = 1 } else { faults[key]++; print "    " $0 } }
        END { for (i = 1; i <= stages; i++) { key = order[i]; line = "    " key ": " n[key] " points"
                for (v in versions) if (version[key, v]) line = line ", " version[key, v] " start version " v
                if (faults[key]) line = line ", " faults[key] " WITH A FAULT"; print line } }' "$cuts/result"
    cut -s -d ';' -f 2- "$cuts/result" | tr ';' '\n' | grep -v '^fault' | sort | uniq -c | sed 's/^/    left over: /'
}

# make_disk FILE: the disk that the machine left, with version 4 on trial in slot a and version 2 in slot b
make_disk() {
    rm -f "$1"
    cp --sparse=always "$cuts/base.raw" "$1"
    "$cuts/power_cut" apply "$cuts/log" "$1" 0 all
}

# The check is worth nothing if it finds no fault: the disk that the machine left has none, and each of these has one that it has to name.
faults_are_found() {
    make_disk "$cuts/cut.raw"
    "$here/cuts/check_disk.sh" "$cuts/cut.raw" "$cuts" "$cuts/work" >"$cuts/verdict" || die "the disk that the machine left: $(cat "$cuts/verdict")"
    grep -q '^version 4.0.0 from slot a' "$cuts/verdict" || die "the disk that the machine left starts $(cat "$cuts/verdict")"
    : >"$cuts/empty"
    printf 'cd /lib/rauc\nrm status\nwrite %s status\n' "$cuts/empty" >"$cuts/empty_state"
    echo 'rm /lib/rauc/status' >"$cuts/no_state"
    echo 'clri /lib/rauc' >"$cuts/no_folder"
    finds 'share clusters' alias isotherm-b.efi
    finds 'the kernel image isotherm-b.efi is not whole' hole isotherm-b.efi
    finds 'the kernel image isotherm-a.3.efi is not whole' byte isotherm-a+3.efi
    finds 'slot b is not whole' root root-b
    finds 'no entry can be started' begin isotherm-a+3.efi isotherm-b.efi
    finds 'the state of RAUC cannot be read' "$cuts/empty_state"
    finds 'the state of RAUC cannot be read' "$cuts/no_state"
    finds 'e2fsck -n' "$cuts/no_folder"
    # A kernel image without its first sector is none, and what is left of it is mended.
    make_disk "$cuts/cut.raw"
    spoil_disk begin isotherm-a+3.efi
    spoil_disk hole isotherm-a+3.efi
    "$here/cuts/check_disk.sh" "$cuts/cut.raw" "$cuts" "$cuts/work" >"$cuts/verdict" || die "a kernel image without its first sector: $(cat "$cuts/verdict")"
    grep -q '^version 2.0.0 from slot b' "$cuts/verdict" || die "without the first sector of version 4: $(cat "$cuts/verdict")"
}

# spoil_disk KIND NAME
spoil_disk() {
    "$here/cuts/spoil_disk.py" "$1" "$cuts/cut.raw" "$cuts/partitions" "$2"
}

# finds WORDS KIND NAME..., or WORDS COMMANDS: the check names this fault of a disk
finds() {
    words=$1
    shift
    make_disk "$cuts/cut.raw"
    damage=
    if [ $# -eq 1 ]; then
        damage=$1
    else
        kind=$1
        shift
        for name; do
            spoil_disk "$kind" "$name"
        done
    fi
    ! "$here/cuts/check_disk.sh" "$cuts/cut.raw" "$cuts" "$cuts/work" $damage >"$cuts/verdict" || die "a fault is not found: $words"
    grep -q "^fault: .*$words" "$cuts/verdict" || die "instead of '$words' the check finds: $(cat "$cuts/verdict")"
    say "a fault that was put in is found: $words"
}

# The same log, with mistakes built in: a boot entry that comes before the slot was written, and an update whose writes nobody has waited
# for.
mistakes_are_found() {
    mistake_is_found late 'install-b\.(between|entry)' --any 'no slot has its root|slot b is not whole'
    mistake_is_found unflushed 'install-b\.entry' --last 'the kernel image isotherm-b.3.efi is not whole|no slot has its root|slot b is not whole'
    rm -f "$cuts/spoilt"
}

# mistake_is_found KIND STAGES WHICH WORDS: by one of 40 points (--any), or of the last 80 (--last). Only after the last writes to the EFI system
# partition a cut can leave a kernel image that has its name and its first sector, but not the rest; about one of eight cuts does.
mistake_is_found() {
    "$cuts/power_cut" spoil "$1" "$cuts/log" "$cuts/spoilt" "$cuts/partitions" root-b install-b start
    points "$cuts/spoilt" 3200 "$cuts/spoilt.all"
    case $3 in
    --any) grep -E " $2" "$cuts/spoilt.all" | shuf -n 40 --random-source="$cuts/log" ;;
    --last) grep -E " $2" "$cuts/spoilt.all" | sort -s -n -k 1,1 | tail -n 80 | shuf --random-source="$cuts/log" ;;
    esac >"$cuts/spoilt.chosen"
    # In order of what is flushed, as check_points wants it.
    sort -s -n -k 2,2 "$cuts/spoilt.chosen" >"$cuts/spoilt.points"
    check_points "$cuts/spoilt" "$cuts/spoilt.points" "$cuts/spoilt.result" "($4)"
    grep -qE "^fault .*($4)" "$cuts/spoilt.result" || die "the mistake '$1' is not found: $4"
    say "the mistake '$1' is found at point $(wc -l <"$cuts/spoilt.result"): $(tail -n 1 "$cuts/spoilt.result" | grep -oE "$4" | head -n 1)"
}

# The firmware and systemd-boot take a kernel image without its first sector for none, although its name is that of the newest version.
start_begins() {
    [ "${POWER_CUT_STARTS:-5}" -gt 0 ] || return 0
    make_disk "$cuts/cut.raw"
    spoil_disk begin isotherm-a+3.efi
    start_disk without_begin
    grep -q 'version 2.0.0 in slot b works after the power cut' "$machine_out/without_begin.log" || die_with without_begin 'another version starts'
    say 'without the first sector of its kernel image version 4 is not started, and version 2 works'
}

# Prints the numbers of the points whose disks are started: one of each stage, first those that leave half a kernel image, then those at
# writes to the EFI system partition.
points_at_risk() {
    awk '{ risk = /without its first sector/ ? 0 : $3 ~ /\.esp$/ ? 1 : 2; print risk, NR, $3 }' "$cuts/result" | shuf --random-source="$cuts/log" |
        sort -s -n -k 1,1 | awk '!seen[$1 $3]++ { print $2 }' | head -n "${POWER_CUT_STARTS:-5}"
}

start_cuts() {
    started=0
    for n in $(points_at_risk); do
        sed -n "${n}p" "$cuts/points" >"$cuts/point"
        read -r point flushed its_seed stage <"$cuts/point"
        rm -f "$cuts/cut.raw"
        cp --sparse=always "$cuts/base.raw" "$cuts/cut.raw"
        "$cuts/power_cut" apply "$cuts/log" "$cuts/cut.raw" 0 "$flushed"
        "$cuts/power_cut" cut "$cuts/log" "$cuts/cut.raw" "$flushed" "$point" "$its_seed"
        start_disk "start-$point"
        say "$(tr -d '\r' <"$machine_out/start-$point.log" | sed -n 's/.* s  \(version .* works after.*\)/\1/p'), cut at point $point ($stage): $(sed -n "${n}p" "$cuts/result" | cut -d ' ' -f 4-)"
        started=$((started + 1))
    done
    [ $started -ge "${POWER_CUT_STARTS:-5}" ] || die "only $started disks were started"
}

# start_disk NAME: starts cut.raw
start_disk() {
    rm -f "$cuts/start.qcow2"
    qemu-img create -q -f qcow2 -F raw -b "$cuts/cut.raw" "$cuts/start.qcow2"
    machine_reboots=reset machine_start "$1" after_cut "$cuts/start.qcow2" || die_with "$1" $?
    rm -f "$cuts/start.qcow2"
}
