#!/bin/sh
# Tests the running image from inside, as root of the test's machine (extra.sh).
#
#   inside.sh first     the first start: /var is made; p01 is enrolled, a stranger does not switch the relay, p01 does
#   inside.sh second    a later start, with p01 before the camera: p01 is still enrolled and switches the relay; times and memory
#   inside.sh update    bundles that are damaged, not newer, for another board, or signed by somebody else are refused; a good one is installed
#   inside.sh updated   version 2 runs from slot b, is found to be healthy, and has people, log and identifier of version 1; then version 3,
#                       which does not start, is installed into slot a
#   inside.sh brought   inside_bring.sh: version 2 comes on a USB stick, and as by the page of the web server
#   inside.sh back      after three attempts with version 3: version 2 runs again
set -eu
story_scratch=$(mktemp -d)
began=$(date +%s)

say() {
    printf '%5d s  %s\n' $(($(date +%s) - began)) "$1"
}

die() {
    echo "FAILED: $1"
    journalctl --no-pager --boot --lines 60 | tail -n 60
    exit 1
}

inside() {
    "$@"
}

inside_as() {
    user=$1
    shift
    runuser -u "$user" -- "$@"
}

# An idle host needs at most SECONDS; it fails after six times as many.
wait_for() {
    wait_until=$(($(cut -d . -f 1 /proc/uptime) + 6 * $1)) wait_what=$2
    shift 2
    until "$@"; do
        [ "$(cut -d . -f 1 /proc/uptime)" -le "$wait_until" ] || die "$wait_what"
        sleep 0.2
    done
}

. "$VM_SOURCE/tests/install/story.sh"
umount /sys/kernel/config 2>/dev/null || true # the next script mounts it
. "$VM_SOURCE/tests/vm/gpio/gpio_wires.sh"

relay_is_on() {
    is_at $RELAY 1
}

door_is() {
    isotherm status --json | grep -q "\"door-state\": *\"$1\""
}

the_root_is_sealed() {
    grep -q '^/dev/mapper/root / squashfs ro' /proc/mounts || die 'the root is not the verified one'
    if touch /usr/probe 2>/dev/null; then
        die 'the root can be written'
    fi
    findmnt -n -o SOURCE /var | grep -qx /dev/mapper/var || die '/var is not the encrypted partition'
    dmsetup_type=$(cat /sys/class/block/dm-*/dm/uuid | sort | tr '\n' ' ')
    case $dmsetup_type in CRYPT-LUKS2*CRYPT-VERITY*) ;; *) die "other devices: $dmsetup_type" ;; esac
    say 'the root is verified and read-only, and /var is encrypted'
}

nothing_else_runs() {
    failed=$(systemctl --failed --plain --no-legend | cut -d ' ' -f 1 | tr '\n' ' ')
    [ -z "$failed" ] || die "units failed: $failed"
    [ -z "$(processes 'agetty|getty|login|sshd')" ] || die 'somebody could log in'
    nft list chain inet filter input | grep -q 'policy drop' || die 'the firewall is off'
    [ "$(systemctl is-active chrony systemd-networkd isotherm-web.socket | sort -u)" = active ] || die 'a unit is not active'
    say 'no unit failed, nobody can log in, the firewall is on'
}

# processes NAMES: prints the numbers of the processes with these names, a pattern of grep
processes() {
    grep -xE "$1" /proc/[0-9]*/comm 2>/dev/null | sed 's#^/proc/\([0-9]*\)/.*#\1#' || true
}

settled() {
    case $(systemctl is-system-running) in running | degraded) ;; *) false ;; esac
}

# The memory that is not available to programs, and the largest processes.
memory() {
    awk '/^MemTotal/ { total = $2 } /^MemAvailable/ { free = $2 } END { printf "memory in use: %.0f MB\n", (total - free) / 1000 }' /proc/meminfo
    for pid in $(processes 'isothermd|isotherm-web|systemd-.*|chronyd|dbus-daemon'); do
        awk '/^Name/ { name = $2 } /^VmRSS/ { printf "  %s %.0f MB\n", name, $2 / 1000 }' "/proc/$pid/status"
    done
}

first() {
    rest_inputs
    ln -s "$VM_SOURCE/sim/stored" /srv/stored
    wait_for 60 'the configuration of the EFI system partition is not taken' [ -e /etc/isotherm/isotherm.conf ]
    wait_for 60 'the daemon does not start' unit_is active
    the_root_is_sealed
    wait_for 60 'the daemon does not find its lines' door_is locked
    is_at $RELAY 0 || die 'the relay is on after the boot'
    say 'the daemon holds its lines'
    p01_is_enrolled
    wait_for 60 'the door does not lock' door_is locked # the last frames may have unlocked it
    a_stranger_is_refused
    is_at $RELAY 0 || die 'a stranger switches the relay'
    say 'the stranger: relay 0'
    somebody_comes p01-v1
    wait_for 90 'p01 does not switch the relay' relay_is_on
    nobody_is_there
    say 'p01: relay 1'
    wait_for 60 'the machine does not settle' settled
    nothing_else_runs
    cp /etc/machine-id /var/lib/machine-id.first
}

tpm_first() {
    the_root_is_sealed
    [ "$(cryptsetup luksDump /dev/disk/by-partlabel/var | grep -c 'systemd-tpm2\|tpm2-pcrs')" -gt 0 ] || die '/var has no key in the TPM'
    [ "$(cryptsetup luksDump /dev/disk/by-partlabel/var | grep -c '^  [0-9]: luks2')" -eq 1 ] || die '/var has another key'
    [ ! -e /efi/var.key ] || die 'the key of /var is on the disk'
    say 'the key of /var is in the TPM and nowhere else'
}

tpm_second() {
    tpm_first
    [ "$(journalctl --list-boots | wc -l)" -ge 2 ] || die 'the journal does not survive a restart'
    say 'a later start opens /var by the TPM'
}

second() {
    rest_inputs
    ln -s "$VM_SOURCE/sim/stored" /srv/stored
    somebody_comes p01-v1
    wait_for 120 'p01 does not switch the relay' relay_is_on
    echo "boot to the open door: $(cut -d ' ' -f 1 /proc/uptime) s after the kernel's start, on an emulated processor"
    nobody_is_there
    the_root_is_sealed
    cmp -s /etc/machine-id /var/lib/machine-id.first || die 'the machine has another identifier'
    [ "$(journalctl --list-boots | wc -l)" -ge 2 ] || die 'the journal does not survive a restart'
    say 'after a restart: p01 is enrolled, the identifier and the journal are kept'
    wait_for 60 'the machine does not settle' settled
    nothing_else_runs
    systemd-analyze time || true
    memory
}

# ---- updates ----

version_is() {
    grep -qx "IMAGE_VERSION=\"*$1\"*" /usr/lib/os-release && grep -qx "SLOT=$2" /run/isotherm/slot || die "this is not version $1 in slot $2: $(cat /run/isotherm/slot /usr/lib/os-release)"
}

entries() {
    find /efi/EFI/Linux -name '*.efi' | sort | tr '\n' ' '
}

entries_are() {
    [ "$(entries)" = "$1 " ]
}

# refused BUNDLE WORDS: isotherm update refuses it and says why, or RAUC's log does, and both slots stay as they are
refused() {
    cp "$VM_SOURCE/build/image/bundles/$1" /var/tmp/bundle
    before=$(entries)
    since=$(date '+%Y-%m-%d %H:%M:%S')
    if isotherm update /var/tmp/bundle >"$story_scratch/update" 2>&1; then
        die "the bundle $1 is installed"
    fi
    journalctl --sync
    { cat "$story_scratch/update"; journalctl --no-pager --unit rauc --since "$since"; } >"$story_scratch/said"
    grep -q "$2" "$story_scratch/said" || die "the refusal of $1 does not say '$2': $(cat "$story_scratch/said")"
    case $1 in damaged*) ;; *) [ "$(entries)" = "$before" ] || die "$1 changes the boot entries: $(entries)" ;; esac
    rm /var/tmp/bundle
    say "refused: $1"
}

update() {
    wait_for 60 'slot a is not found to be good' entries_are /efi/EFI/Linux/isotherm-a.efi
    refused other_key.raucb 'signature verification failed\|Verify error'
    refused other_board.raucb 'it is for the board isotherm-rock-5b-amd64, and this is isotherm-qemu-amd64'
    refused same.raucb 'it is not newer than the running version'
    # RAUC reads a block whose hash is wrong: the read fails, and the kernel says why.
    refused damaged.raucb 'bundle: not installed: .*Input/output error'
    journalctl --no-pager --dmesg --since "$since" | grep -q 'device-mapper: verity: .* is corrupted' ||
        die 'the damage is not found by the hashes of the bundle'
    entries_are /efi/EFI/Linux/isotherm-a.efi || die "after refusals: $(entries)"
    install_bundle v2.raucb
    entries_are '/efi/EFI/Linux/isotherm-a.efi /efi/EFI/Linux/isotherm-b+3.efi' || die "after the update: $(entries)"
    say 'version 2 is installed in slot b, with three attempts'
    isotherm list >/var/lib/people.before
}

install_bundle() {
    cp "$VM_SOURCE/build/image/bundles/$1" /var/tmp/bundle
    isotherm update /var/tmp/bundle || die "the bundle $1 is not installed: $(journalctl --no-pager --unit rauc --lines 30)"
    rm /var/tmp/bundle
}

# keeps WHAT: the state of the first version is there
keeps() {
    wait_for 60 'the daemon does not start' unit_is active
    isotherm list | cmp -s - /var/lib/people.before || die "$1: other people"
    isotherm log verify >/dev/null || die "$1: the log is not sound"
    cmp -s /etc/machine-id /var/lib/machine-id.first || die "$1: another identifier"
    say "$1 has the people, the log and the identifier"
}

updated() {
    version_is 2.0.0 b
    rest_inputs
    ln -s "$VM_SOURCE/sim/stored" /srv/stored
    keeps 'version 2'
    wait_for 60 'version 2 is not found to be good' entries_are '/efi/EFI/Linux/isotherm-a.efi /efi/EFI/Linux/isotherm-b.efi'
    say 'version 2 in slot b is healthy and is no longer counted'
    install_bundle v3.raucb
    entries_are '/efi/EFI/Linux/isotherm-a+3.efi /efi/EFI/Linux/isotherm-b.efi' || die "after the second update: $(entries)"
    say 'version 3, which does not start, is installed in slot a'
}

back() {
    version_is 2.0.0 b
    rest_inputs
    keeps 'version 2 after the bad update'
    entries_are '/efi/EFI/Linux/isotherm-a+0-3.efi /efi/EFI/Linux/isotherm-b.efi' || die "after three attempts: $(entries)"
    say 'three attempts with version 3 failed; version 2 runs again'
}

. "$VM_SOURCE/tests/image/inside_bring.sh"

"$1"
