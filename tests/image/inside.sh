#!/bin/sh
# Tests the running image from inside, as root of the test's machine (extra.sh).
#
#   inside.sh first     the first start: /var is made; p01 is enrolled, a stranger does not switch the relay, p01 does
#   inside.sh second    a later start, with p01 before the camera: p01 is still enrolled and switches the relay; times and memory
#   inside.sh update    bundles that are damaged, not newer, for another board, or signed by somebody else are refused; a good one is installed
#   inside.sh updated   version 2 runs from slot b, is found to be healthy, and has people, log and identifier of version 1; then version 3,
#                       which does not start, is installed into slot a
#   inside.sh brought   inside_bring.sh: version 2 comes on a USB stick, and as by the page of the web server
#   inside.sh asked     inside_setup.sh: the setup of a door without a configuration, at monitor and keyboard
#   inside.sh back      after three attempts with version 3: version 2 runs again
#   inside.sh recorded, after_cut       inside_cuts.sh: updates that are recorded, and a start after a power cut
#   inside.sh tpm_first, tpm_second     a first and a later start with a TPM; the first with a wrong configuration
#   inside.sh secure        a first start with Secure Boot
set -eu
story_scratch=$(mktemp -d)
began=$(date +%s)
case $(uname -m) in aarch64) arch=arm64 images=build/image-arm64 ;; *) arch=amd64 images=build/image ;; esac # OUT of run.sh

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
# With Secure Boot the kernel takes signed modules only, and that of the door's lines is not signed.
if [ "$1" != secure ]; then
    umount /sys/kernel/config 2>/dev/null || true # the next script mounts it
    . "$VM_SOURCE/tests/vm/gpio/gpio_wires.sh"
fi

relay_is_on() {
    is_at $RELAY 1
}

late_records() {
    log_records 2>/dev/null | grep -c not-on-record || true
}

# p01 stands before the camera until the relay is switched. On a busy host the record of a grant may need more than 250 ms to the disk. Then
# the door has to refuse the visit (not-on-record), and p01 comes again.
p01_switches_the_relay() {
    late=$(late_records)
    somebody_comes p01-v1
    wait_for 120 'p01 does not switch the relay' relay_is_on_or_p01_comes_again
    relay_was_on=$(cut -d ' ' -f 1 /proc/uptime)
    nobody_is_there
}

relay_is_on_or_p01_comes_again() {
    ! relay_is_on || return 0
    sleep 1
    late_now=$(late_records)
    [ "$late_now" -gt "$late" ] || return 1
    late=$late_now
    nobody_is_there
    somebody_comes p01-v1
    return 1
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
    for unit in $failed; do
        journalctl --no-pager --boot --unit "$unit" | tail -n 10
    done
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
    p01_switches_the_relay
    say 'p01: relay 1'
    wait_for 60 'the machine does not settle' settled
    nothing_else_runs
    cp /etc/machine-id /var/lib/machine-id.first
    put_configuration 21000
}

# ---- the configuration on the EFI system partition ----

# put_configuration UNLOCK_MS: what somebody does who has the disk in another computer
put_configuration() {
    sed "s/^unlock_ms = .*/unlock_ms = $1/" /usr/lib/isotherm-image/test.conf >/efi/isotherm.conf
    sync -f /efi/isotherm.conf
}

# configuration_is UNLOCK_MS FILE
configuration_is() {
    sed "s/^unlock_ms = .*/unlock_ms = $1/" /usr/lib/isotherm-image/test.conf | cmp -s - "$2" || die "$2 is not the configuration with $1"
}

# the_journal_tells WORDS: what take-configuration has said in this start
the_journal_tells() {
    journalctl --sync
    journalctl --no-pager --boot --unit isotherm-configuration | grep -q "$1" || die "the journal does not say: $1"
}

a_wrong_configuration_is_refused() {
    the_journal_tells 'not taken: isotherm.conf:[0-9]*: .*sometimes'
    grep -q 'not taken: isotherm.conf:[0-9]*: .*sometimes' /efi/isotherm-fault.txt || die 'the EFI system partition does not say what is wrong'
    say "refused: $(cat /efi/isotherm-fault.txt)"
}

# ---- a TPM ----

tpm_first() {
    the_key_is_in_the_tpm
    wait_for 60 'the configuration is not looked at' [ -e /efi/isotherm-fault.txt ]
    a_wrong_configuration_is_refused
    [ ! -e /etc/isotherm/isotherm.conf ] || die 'a wrong configuration is taken'
    wait_for 60 'the machine does not settle' settled
    [ "$(systemctl is-active isothermd isotherm-screen | sort -u)" = inactive ] || die 'a door without a configuration has a daemon or a screen for visitors'
    put_configuration 20000
}

the_key_is_in_the_tpm() {
    the_root_is_sealed
    [ "$(cryptsetup luksDump /dev/disk/by-partlabel/var | grep -c 'systemd-tpm2\|tpm2-pcrs')" -gt 0 ] || die '/var has no key in the TPM'
    [ "$(cryptsetup luksDump /dev/disk/by-partlabel/var | grep -c '^  [0-9]: luks2')" -eq 1 ] || die '/var has another key'
    [ ! -e /efi/var.key ] || die 'the key of /var is on the disk'
    say 'the key of /var is in the TPM and nowhere else'
}

tpm_second() {
    the_key_is_in_the_tpm
    wait_for 60 'the corrected configuration is not taken' [ -e /etc/isotherm/isotherm.conf ]
    wait_for 60 'the daemon does not start' unit_is active
    [ ! -e /efi/isotherm-fault.txt ] || die 'the EFI system partition still tells of a fault'
    say 'the corrected configuration is taken'
    [ "$(journalctl --list-boots | wc -l)" -ge 2 ] || die 'the journal does not survive a restart'
    say 'a later start opens /var by the TPM'
}

second() {
    rest_inputs
    ln -s "$VM_SOURCE/sim/stored" /srv/stored
    p01_switches_the_relay
    echo "boot to the open door: $relay_was_on s after the kernel's start, on an emulated processor"
    the_root_is_sealed
    cmp -s /etc/machine-id /var/lib/machine-id.first || die 'the machine has another identifier'
    [ "$(journalctl --list-boots | wc -l)" -ge 2 ] || die 'the journal does not survive a restart'
    say 'after a restart: p01 is enrolled, the identifier and the journal are kept'
    configuration_is 21000 /etc/isotherm/isotherm.conf
    configuration_is 20000 /etc/isotherm/isotherm.conf.former
    say 'the changed configuration is taken, and the former one is kept'
    wait_for 60 'the machine does not settle' settled
    nothing_else_runs
    systemd-analyze time || true
    memory
}

# ---- Secure Boot ----

secure() {
    the_root_is_sealed
    [ "$(od -An -tu1 -j4 -N1 /sys/firmware/efi/efivars/SecureBoot-* | tr -d ' ')" = 1 ] || die 'Secure Boot is off'
    wait_for 60 'the configuration of the EFI system partition is not taken' [ -e /etc/isotherm/isotherm.conf ]
    wait_for 60 'the machine does not settle' settled # take-configuration has ended, too
    put_configuration 21000
    if /usr/lib/isotherm-image/take-configuration >"$story_scratch/said"; then
        die 'with Secure Boot a door takes another configuration'
    fi
    grep -q 'Secure Boot is on' "$story_scratch/said" || die "the refusal says: $(cat "$story_scratch/said")"
    configuration_is 20000 /etc/isotherm/isotherm.conf
    say 'Secure Boot is on; the first configuration is taken, and no other one'
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
    cp "$VM_SOURCE/$images/bundles/$1" /var/tmp/bundle
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
    refused other_board.raucb "it is for the board isotherm-rock-5b-$arch, and this is isotherm-qemu-$arch"
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
    cp "$VM_SOURCE/$images/bundles/$1" /var/tmp/bundle
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
. "$VM_SOURCE/tests/image/inside_cuts.sh"
. "$VM_SOURCE/tests/image/inside_setup.sh"

"$1"
