#!/bin/bash
# Checks a whole fleet: PostgreSQL and mosquitto from Debian in a directory of their own, two hubs, 50 doors with the code of the daemon
# and of the link (tests/fleet/check_door.h), 10 in a process, two real daemons with their links (fleet_real.sh), and for a while 11 doors to
# which the hub brings an update (fleet_update.sh). First each promise by itself, then faults at random: hubs, doors, broker and database are
# killed while people come, go and are let in. At the end all doors have the same people, every event is at home once, and nobody was let in
# whose revocation is older than the lease.
# usage: fleet_check.sh BUILD SECONDS [SEED]      SECONDS: of faults; SEED: of the faults, default 1
# Each line says what was checked, with its figure. The exit status is 1 if anything was wrong, and 77 if a program is missing.
set -euo pipefail
build=$(cd "$1" && pwd)
fault_s=$2
seed=${3:-1}
here=$(cd "$(dirname "$0")" && pwd)
. "$here/fleet_parts.sh"
. "$here/fleet_steps.sh"
. "$here/fleet_real.sh"
. "$here/fleet_update.sh"
. "$here/fleet_faults.sh"

DOORS=50 A_PROCESS=10 LEASE_S=20
prepare

step_join
step_enrol
step_revoke
step_real
step_forged
step_lockdown
step_lease
step_expel
step_update
step_restored
step_faults

finish
