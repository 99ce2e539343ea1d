#!/bin/sh
# Tests the packages in a separate Debian that boots as a machine, with systemd, udev and Debian's kernel, and with the door on lines of
# gpio-sim. A user enrols p01; a stranger does not switch the relay, and p01 does; Landlock and the filter of system calls work. The script
# runs as a unit of that machine, after multi-user.target; tests/vm/packages_root.sh installs the unit.
set -eu
story_scratch=$(mktemp -d)
began=$(date +%s)

say() {
    printf '%5d s  %s\n' $(($(date +%s) - began)) "$1"
}

die() {
    echo "FAILED: $1"
    journalctl --no-pager --unit isothermd | tail -n 20
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
    wait_until=$(($(date +%s) + 6 * $1)) wait_what=$2
    shift 2
    until "$@"; do
        [ "$(date +%s)" -le "$wait_until" ] || die "$wait_what"
        sleep 0.2
    done
}

. "$VM_SOURCE/tests/install/story.sh"
. "$VM_SOURCE/tests/vm/gpio/gpio_wires.sh"

relay_is_on() {
    is_at $RELAY 1
}

# The chip was plugged in after the daemon had started; the daemon finds its lines by itself.
door_is() {
    isotherm status --json | grep -q "\"door-state\": *\"$1\""
}

rest_inputs
ln -s "$VM_SOURCE/sim/stored" /srv/stored
wait_for 60 'the daemon does not find its lines' door_is locked
active_within 60
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

the_door_is_real_time
calls_are_filtered
leave_open
files_are_restricted
journalctl --no-pager --unit isothermd | grep -q 'memory is not locked' && die 'the memory is not locked'
exposure 1.3 isothermd.service
say 'the packages open the door of a machine'
