# Updates whose writes to the disk are recorded, and starts from a disk as a power cut left it: `. tests/image/inside_cuts.sh`, in inside.sh.
# Plain sh.

# mark NAME: writes the name into a sector before the first partition, so that the log of the writes has it (cuts/write_log.h)
mark() {
    disk=/dev/$(basename "$(readlink -f "/sys/class/block/$(basename "$(readlink -f /dev/disk/by-partlabel/esp)")/..")")
    printf 'isotherm-mark %s\n' "$1" | dd of="$disk" bs=512 seek=1000 count=1 conv=sync,notrunc oflag=direct status=none || die 'no mark can be written'
    say "mark $1"
}

running_version() {
    sed -n 's/^IMAGE_VERSION="*\([^"]*\)"*$/\1/p' /usr/lib/os-release
}

# In one machine: version 1 installs version 2 into the empty slot and restarts; version 2 is found to be good and installs version 4 over
# version 1.
recorded() {
    rest_inputs
    if [ "$(running_version)" != 2.0.0 ]; then
        wait_for 60 'the daemon does not start' unit_is active
        wait_for 60 'slot a is not found to be good' entries_are /efi/EFI/Linux/isotherm-a.efi
        isotherm list >/var/lib/people.before
        sync
        mark install-b
        install_bundle v2.raucb
        mark start
        systemctl reboot
        sleep infinity
    fi
    mark trial
    keeps 'version 2'
    wait_for 120 'version 2 is not found to be good' entries_are '/efi/EFI/Linux/isotherm-a.efi /efi/EFI/Linux/isotherm-b.efi'
    mark install-a
    install_bundle v4.raucb
    entries_are '/efi/EFI/Linux/isotherm-a+3.efi /efi/EFI/Linux/isotherm-b.efi' || die "after the second update: $(entries)"
    mark end
}

# After a power cut: the door works, its slot is good or becomes it, nothing that was on the disk before is lost, and there can be a next update.
after_cut() {
    rest_inputs
    version=$(running_version)
    keeps "version $version"
    . /run/isotherm/slot
    wait_for 120 "version $version is not found to be good: $(entries)" [ -e "/efi/EFI/Linux/isotherm-$SLOT.efi" ]
    wait_for 120 'the machine does not settle' settled
    nothing_else_runs
    [ "$version" = 4.0.0 ] || install_bundle v4.raucb
    say "version $version in slot $SLOT works after the power cut; entries: $(entries)"
}
