#!/bin/sh
# Upgrades a fleet from the packages of the previous release: a hub with PostgreSQL and mosquitto, and two doors, each in a container that
# systemd boots. The hub goes first and one door follows; then the hub goes back, the tables with it; then the other door goes first, and
# the hub follows. After every step somebody is enrolled at one door and let in at the other, is revoked and refused at both, whoever was
# enrolled before the first step is still let in, the hub has each event of the doors once, and all have the same digests.
#
#   fleet_upgrade.sh PREVIOUS CURRENT TAR      folders of packages: previous_packages.sh, debian_packages.sh; root.sh makes TAR
#
# Needs root and Debian's archive. Ends with 0 if all checks passed.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
. "$here/container.sh"
. "$here/containers.sh"
containers_network "$0" "$@"
source_dir=$(cd "$here/../.." && pwd)
previous=$(cd "$1" && pwd)
current=$(cd "$2" && pwd)
tar=$3
story_scratch=$(mktemp -d)
. "$here/story.sh"
. "$here/say.sh"
on_door='isotherm isotherm-data libisotherm0 isotherm-link'
install='apt-get install -q -y --no-install-recommends --allow-downgrades'

die() {
    echo "FAILED: $1" >&2
    for name in $container_names; do
        on "$name" inside journalctl --no-pager --lines 25 --unit isothermd --unit isotherm-link --unit isotherm-hub --unit mosquitto || true
    done >&2
    exit 1
}

finish() {
    status=$?
    trap - EXIT
    containers_remove
    rm -rf "$story_scratch"
    exit $status
}

# ---- packages ----

# package DIR NAME: the file of a package
package() {
    ls "$1/$2"_*_"$(dpkg --print-architecture)".deb "$1/$2"_*_all.deb 2>/dev/null | head -n 1
}

# Copies the packages of a release into a root. Packages of the same version, from before the next release, get an older one.
put_packages() { # DIR FOLDER NAME...
    put_from=$1 put_to=$container_root/srv/$2
    shift 2
    mkdir -p "$put_to"
    for name in "$@"; do
        put_file=$(package "$put_from" "$name")
        [ -n "$put_file" ] || die "$put_from has no package $name"
        if [ "$put_from" = "$previous" ] && ! dpkg --compare-versions "$(dpkg-deb -f "$put_file" Version)" lt \
            "$(dpkg-deb -f "$(package "$current" "$name")" Version)"; then
            "$here/repack.sh" "$put_file" '~previous' "$put_to"
        else
            cp "$put_file" "$put_to"
        fi
    done
}

# Installs the previous packages and their dependencies, and fetches what the present ones need besides, because the containers have no
# network. Nothing is started.
install_previous() { # NAME...
    put_packages "$previous" previous "$@"
    put_packages "$current" current "$@"
    printf '#!/bin/sh\nexit 101\n' >"$container_root/usr/sbin/policy-rc.d"
    chmod 755 "$container_root/usr/sbin/policy-rc.d"
    quiet 'the lists of packages' in_root apt-get update -q
    quiet 'installing the previous packages' in_root sh -c "$install /srv/previous/*.deb $further"
    quiet 'fetching what the present packages need' in_root sh -c "$install --download-only /srv/current/*.deb"
    rm "$container_root/usr/sbin/policy-rc.d"
}

# ---- the fleet ----

make_hub() {
    container_add hub "$tar"
    # procps: hubs of before 26 November 2026 let mosquitto read its lists by /bin/kill.
    further='postgresql mosquitto procps' install_previous isotherm-hub
    mkdir -p "$container_root/etc/isotherm-hub"
    printf '[hub]\nname = Headquarters\nhost = localhost\n' >"$container_root/etc/isotherm-hub/hub.conf"
}

make_door() { # NAME
    container_add "$1" "$tar"
    # shellcheck disable=SC2086
    further='' install_previous $on_door
    mkdir -p "$container_root/etc/isotherm"
    cat >"$container_root/etc/isotherm/isotherm.conf" <<END
[sensor]
backend = replay
path = /srv/slot
repeats = yes
[door]
backend = null
unlock_ms = 500
[decision]
gap_ms = 1000
[lockout]
failures = 0
END
    mkdir "$container_root/srv/stored"
    for recording in p01 p02; do
        cp -r "$source_dir/sim/stored/$recording-enrol" "$source_dir/sim/stored/$recording-v1" "$container_root/srv/stored"
    done
}

hub() {
    on hub inside_as isotherm-hub isotherm-hub "$@"
}

sql() {
    on hub inside_as postgres psql -X -q -A -t -d isotherm-hub -c "$1"
}

start_hub() {
    container_start hub
    on hub inside_as postgres createuser isotherm-hub
    on hub inside_as postgres createdb -O isotherm-hub isotherm-hub
    hub init >"$story_scratch/init"
    hub broker-config >>"$story_scratch/init"
    hub zone add house >>"$story_scratch/init"
    on hub inside cp /var/lib/isotherm-broker/mosquitto.conf /etc/mosquitto/mosquitto.conf
    on hub inside systemctl restart mosquitto
    on hub inside systemctl restart isotherm-hub
}

start_door() { # NAME
    container_start "$1"
    on "$1" wait_for 20 "the daemon of $1 does not start" unit_is active
    on "$1" add_users
    address=$(hub door add "$1" --zone house | grep -o 'isotherm://[^ ]*' | head -n 1)
    quiet "$1 does not join" on "$1" inside isotherm-link join "$address"
    wait_for 30 "$1 is not online" is_online "$1"
}

is_online() {
    [ "$(sql "SELECT online FROM door WHERE name = '$1' AND reported_s > 0")" = t ]
}

# ---- what must hold after every step ----

visitor_is_let_in() { # DOOR RECORDING PERSON
    story_allowed=$(on "$1" count_logged "$3" allow)
    on "$1" somebody_comes "$2"
    wait_for 20 "$3 is not let in at $1" has_allowed_more_than "$1" "$3" "$story_allowed"
    on "$1" nobody_is_there
}

has_allowed_more_than() {
    [ "$(on "$1" count_logged "$2" allow)" -gt "$3" ]
}

visitor_is_refused() { # DOOR RECORDING
    story_allowed=$(on "$1" log_records | grep -c '"allow"' || true) story_denied=$(on "$1" count_denied)
    on "$1" somebody_comes "$2"
    on "$1" wait_for 20 "no verdict at $1" has_denied_more_than "$story_denied"
    on "$1" nobody_is_there
    [ "$(on "$1" log_records | grep -c '"allow"' || true)" = "$story_allowed" ] || die "whoever was revoked is let in at $1"
}

# enrol DOOR RECORDING PERSON: at a door, and approved by the hub
enrol() {
    on "$1" nobody_is_there
    on "$1" isotherm enroll "$3" --quick --timeout 60 >"$story_scratch/enroll" 2>&1 &
    story_enroll=$!
    wait_for 10 'the enrolment does not begin' grep -q . "$story_scratch/enroll"
    on "$1" somebody_comes "$2"
    wait $story_enroll || die "$3 is not enrolled: $(cat "$story_scratch/enroll")"
    on "$1" nobody_is_there
    wait_for 30 "no request for $3" has_request "$3"
    hub request approve "$3" >/dev/null
    wait_for 30 "$3 is not at all doors" is_level
}

has_request() {
    [ -n "$(sql "SELECT 1 FROM request WHERE name = '$1' AND state = 0")" ]
}

# Each door has reported the place of the zone, with its digest, which stands for the whole history.
is_level() {
    [ "$(sql "SELECT count(*) FROM door d JOIN door_place p ON p.door = d.id JOIN zone z ON z.id = p.zone
              WHERE p.epoch = z.epoch AND p.sequence = z.sequence AND p.digest = z.digest")" = 2 ]
}

# has_events DOOR NUMBER: all records of the log up to the number are at the hub, each once
has_events() {
    [ "$(sql "SELECT count(*) = max(number) AND min(number) = 1 AND max(number) >= $2
              FROM event JOIN door ON door.id = event.door WHERE door.name = '$1'")" = t ]
}

last_record() { # DOOR
    on "$1" isotherm log --count 1 --json | tr -d ' \n' | grep -o '"sequence":[0-9]*' | tail -n 1 | cut -d : -f 2
}

count_people() { # DOOR
    on "$1" isotherm list | grep -c "$2" || true
}

# everything_holds STEP AT OTHER: somebody is enrolled at the one door and visits the other.
everything_holds() {
    for door in "$2" "$3"; do
        wait_for 60 "$1: $door is not online" is_online "$door"
        visitor_is_let_in "$door" p02-v1 lasting
    done
    enrol "$2" p01-enrol "guest-$steps"
    visitor_is_let_in "$3" p01-v1 "guest-$steps"
    visitor_is_let_in "$2" p01-v1 "guest-$steps"
    hub person revoke "guest-$steps" --wait 30 >"$story_scratch/revoke" || die "$1: $(cat "$story_scratch/revoke")"
    visitor_is_refused "$3" p01-v1
    visitor_is_refused "$2" p01-v1
    wait_for 30 "$1: the doors are not level" is_level
    for door in "$2" "$3"; do
        wait_for 60 "$1: the hub lacks records of $door, or has one twice" has_events "$door" "$(last_record "$door")"
        [ "$(count_people "$door" '^guest-')" = 0 ] || die "$1: $door keeps a revoked person"
        on "$door" isotherm log verify >/dev/null || die "$1: the log of $door is not sound"
    done
    steps=$((steps + 1))
    say "$1: enrolment, revocation, events and digests are right"
}

# ---- the steps ----

version_of_tables() {
    sql 'SELECT version FROM isotherm_schema'
}

# The commands of isotherm-hub(8), "UPGRADE".
hub_goes_up() {
    on hub inside systemctl stop isotherm-hub
    quiet 'the upgrade of the hub' on hub inside sh -c "$install /srv/current/*.deb"
    on hub inside systemctl stop isotherm-hub
    # The tables have been brought up before if nothing has changed.
    hub migrate up >"$story_scratch/migrate" 2>&1 || grep -q 'leads to no other version' "$story_scratch/migrate" ||
        die "$(cat "$story_scratch/migrate")"
    on hub inside systemctl start isotherm-hub
    say "the hub is upgraded to $(on hub inside dpkg-query -W -f '${Version}' isotherm-hub); its tables are of version $(version_of_tables)"
}

# The newer program takes the tables back, and then the older one is installed.
hub_goes_down() {
    on hub inside systemctl stop isotherm-hub
    if [ "$(version_of_tables)" != "$old_tables" ]; then
        quiet 'the tables do not go back' hub migrate down "$old_tables"
    fi
    quiet 'the older package' on hub inside sh -c "$install /srv/previous/*.deb"
    on hub inside systemctl restart isotherm-hub
    say "the hub is back at $(on hub inside dpkg-query -W -f '${Version}' isotherm-hub); its tables are of version $(version_of_tables)"
}

door_goes_up() { # NAME
    before=$(on "$1" daemon_pid)
    quiet "the upgrade of $1" on "$1" inside sh -c "$install /srv/current/*.deb"
    on "$1" wait_for 20 "the daemon of $1 does not come back" unit_is active
    [ "$(on "$1" daemon_pid)" != "$before" ] || die "the upgrade does not restart the daemon of $1"
    say "$1 is upgraded to $(on "$1" inside dpkg-query -W -f '${Version}' isotherm-link)"
}

steps=0
make_hub
make_door front
make_door back
say 'the previous packages are installed'
start_hub
start_door front
start_door back
old_tables=$(version_of_tables)
say "a hub and two doors have joined; the tables are of version $old_tables"
enrol front p02-enrol lasting
everything_holds 'all as before' front back
hub_goes_up
everything_holds 'hub first, the doors as before' front back
door_goes_up back
everything_holds 'hub first, then a door' back front
hub_goes_down
everything_holds 'the hub went back, the door did not' front back
door_goes_up front
everything_holds 'the doors first, the hub as before' front back
hub_goes_up
everything_holds 'the doors first, then the hub' back front
say 'a fleet is upgraded in either order, and the hub goes back'
