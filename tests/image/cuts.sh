# The check `power_cuts`: `. tests/image/cuts.sh`, in run.sh. Plain sh. Needs the disk of first_start.
#
# One machine makes two updates, and QEMU records every write to its disk and every flush. POWER_CUTS (100) random moments of this log give
# the disks that a power cut would have left (cuts/power_cut.c). Each is checked without a machine (cuts/check_disk.sh), and POWER_CUT_STARTS (5) of them
# start. Set POWER_CUT_SEED to repeat a run; POWER_CUT_KEEP=yes takes the last log.

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
    mistakes_are_found
    points "$cuts/log" "${POWER_CUTS:-100}" "$cuts/points"
    check_points "$cuts/log" "$cuts/points" "$cuts/result" "${POWER_CUT_STARTS:-5}"
    tell_points
    [ "$(grep -c '^fault' "$cuts/result")" -eq 0 ] || die 'a power cut leaves a disk with a fault'
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

# check_points LOG POINTS RESULT STARTS: writes a line "ok|fault POINT STAGE WORDS" for each point, and keeps the disks of STARTS points
check_points() {
    cp --sparse=always "$cuts/base.raw" "$cuts/flushed.raw"
    applied=0 n=0 count=$(wc -l <"$2")
    : >"$3"
    while read -r point flushed its_seed stage; do
        "$cuts/power_cut" apply "$1" "$cuts/flushed.raw" $applied "$flushed"
        applied=$flushed
        rm -f "$cuts/cut.raw"
        cp --sparse=always "$cuts/flushed.raw" "$cuts/cut.raw"
        "$cuts/power_cut" cut "$1" "$cuts/cut.raw" "$flushed" "$point" "$its_seed"
        if [ $(((n + seed) * $4 % count)) -lt "$4" ]; then
            qemu-img convert -f raw -O qcow2 "$cuts/cut.raw" "$cuts/start-$point.qcow2"
        fi
        if "$here/cuts/check_disk.sh" "$cuts/cut.raw" "$cuts" "$cuts/work" >"$cuts/verdict"; then
            echo "ok $point $stage $(cat "$cuts/verdict")" >>"$3"
        else
            echo "fault $point $stage $(tr '\n' ';' <"$cuts/verdict")" >>"$3"
        fi
        n=$((n + 1))
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

# The check is worth nothing if it finds no mistake: the same log, with mistakes built in. A boot entry that comes before the slot was
# written, and a slot that nobody has waited for.
mistakes_are_found() {
    for mistake in late unflushed; do
        "$cuts/power_cut" spoil $mistake "$cuts/log" "$cuts/spoilt" "$cuts/partitions" root-b install-b start
        # Points behind the first write to the slot, where the mistake shows.
        points "$cuts/spoilt" 400 "$cuts/spoilt.all"
        grep -E 'install-b\.(slot|between|entry)' "$cuts/spoilt.all" | shuf -n 12 --random-source="$cuts/log" | sort -n >"$cuts/spoilt.points"
        check_points "$cuts/spoilt" "$cuts/spoilt.points" "$cuts/spoilt.result" 0
        found=$(grep -cE '^fault .*(no slot has its root|is not whole)' "$cuts/spoilt.result" || true)
        say "the mistake '$mistake': found by $found of $(wc -l <"$cuts/spoilt.points") points"
        [ "$found" -gt 0 ] || die "the mistake '$mistake' is not found"
    done
    rm -f "$cuts/spoilt"
}

start_cuts() {
    started=0
    for image in "$cuts"/start-*.qcow2; do
        [ -e "$image" ] || continue
        point=$(basename "$image" .qcow2)
        machine_reboots=reset machine_start "$point" after_cut "$image" || die_with "$point" $?
        say "$(tr -d '\r' <"$machine_out/$point.log" | sed -n 's/.* s  \(version .* works after.*\)/\1/p'), cut at point ${point#start-} ($(awk -v p="${point#start-}" '$2 == p { print $3 }' "$cuts/result" | head -n 1))"
        rm -f "$image"
        started=$((started + 1))
    done
    [ $started -ge "${POWER_CUT_STARTS:-5}" ] || die "only $started disks were started"
}
