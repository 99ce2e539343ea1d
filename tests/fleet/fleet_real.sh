# Two real doors in the check of a fleet: isothermd and isotherm-link as they are installed, each pair at a bus of its own, with the null
# hardware and stored frames of rendered people (sim/stored) before the camera. They belong to the zone hq, as the simulated doors 0 to 39.

REALS="real1 real2"

client() { "$build/enroll/isotherm" --bus "$(bus_of "$1")" "${@:2}"; } # DOOR WORD...
link() { "$build/firmware/fleet/program/isotherm-link" "${@:2}" --state "$work/$1/link" --bus "$(bus_of "$1")"; }
bus_of() { echo "unix:path=$work/$1/bus"; }

# ---- a door ----

make_real() { # DOOR
    mkdir -p "$work/$1/link"
    cat >"$work/$1/bus.conf" <<CONF
<!DOCTYPE busconfig PUBLIC "-//freedesktop//DTD D-Bus Bus Configuration 1.0//EN"
 "http://www.freedesktop.org/standards/dbus/1.0/busconfig.dtd">
<busconfig><type>fleet-check</type><listen>$(bus_of "$1")</listen><auth>EXTERNAL</auth>
<policy context="default"><allow send_destination="*"/><allow receive_sender="*"/><allow own="*"/><allow user="*"/></policy></busconfig>
CONF
    cat >"$work/$1/isotherm.conf" <<CONF
[sensor]
backend = replay
path = $work/$1/slot
repeats = yes
retry_ms = 50
retry_max_ms = 100
stale_ms = 5000
pause_ms = 5000
[door]
backend = null
unlock_ms = 200
[decision]
gap_ms = 1000
[hint]
hold_frames = 2
[lockout]
failures = 0
[gallery]
path = $work/$1/gallery.db
[log]
path = $work/$1/audit.log
[bus]
address = $(bus_of "$1")
[model]
head = $here/../../core/data/head.model
metric = $here/../../core/data/face.metric
CONF
    dbus-daemon --config-file="$work/$1/bus.conf" --nofork --nopidfile 2>>"$work/log/$1-bus" &
    wait_for 10 [ -S "$work/$1/bus" ] || give_up "$1: no bus"
}

start_real() { # DOOR
    "$build/firmware/isothermd" --config "$work/$1/isotherm.conf" 2>>"$work/log/$1-daemon" &
    eval "pid_of_daemon_$1=$!"
    wait_for 60 eval "client $1 status >/dev/null 2>&1" || give_up "$1: the daemon does not start"
}

start_link() { # DOOR
    # Without a function in between, whose shell would be killed in the place of the program.
    "$build/firmware/fleet/program/isotherm-link" run --state "$work/$1/link" --bus "$(bus_of "$1")" 2>>"$work/log/$1-link" &
    eval "pid_of_link_$1=$!"
}

kill_real() { # DOOR
    eval "kill -9 \$pid_of_link_$1 \$pid_of_daemon_$1"
    eval "wait \$pid_of_link_$1 \$pid_of_daemon_$1" 2>/dev/null || true
}

join_real() { # DOOR
    local address
    address=$(hub door add "$1" --zone hq | grep -o 'isotherm://[^ ]*' | head -n 1)
    link "$1" join "$address" >>"$work/log/$1-join" 2>&1 && start_link "$1"
}

# ---- a visitor ----

comes() { # DOOR RECORDING
    ln -sfn "$here/../../sim/stored/$2" "$work/$1/slot.next"
    mv -T "$work/$1/slot.next" "$work/$1/slot"
}

goes() { # DOOR
    rm -f "$work/$1/slot"
    sleep 1.5 # longer than gap_ms, which leaves a busy disk time for the record of a grant
}

# The verdicts about visits, one a line: "allow NAME", "deny REASON".
verdicts() { # DOOR
    client "$1" log --count 100000 --json | python3 -c '
import json, sys
for r in json.load(sys.stdin)["records"]:
    if r.get("event") == "visit":
        print(r["verdict"], r.get("person") if r["verdict"] == "allow" else r.get("reason"))'
}

has_verdicts() { [ "$(verdicts "$1" | wc -l)" -gt "$2" ]; } # DOOR NUMBER

# Shows a recording until the door has decided about the visit, and prints the verdict.
visits() { # DOOR RECORDING
    local before
    before=$(verdicts "$1" | wc -l)
    comes "$1" "$2"
    wait_for 30 has_verdicts "$1" "$before" || true
    goes "$1"
    verdicts "$1" | sed -n "$((before + 1))p"
}

# ---- the steps ----

enrol_real() { # DOOR RECORDING NAME
    client "$1" enroll "$3" --quick --timeout 60 >"$work/log/enroll" 2>&1 &
    local enrolment=$!
    wait_for 20 grep -q . "$work/log/enroll" || return 1
    comes "$1" "$2"
    wait "$enrolment" || return 1
    goes "$1"
}

# Both doors have told the hub that they are at its place of the zone; its digest stands for the whole history.
reals_are_level() {
    [ "$(sql "SELECT count(*) FROM door d JOIN door_place p ON p.door = d.id JOIN zone z ON z.id = p.zone
              WHERE d.name LIKE 'real_' AND p.epoch = z.epoch AND p.sequence = z.sequence AND p.digest = z.digest")" -eq 2 ]
}

people_of() { client "$1" list | awk '{ print $1 }' | sort; }

real_events_are_home() {
    local door last
    for door in $REALS; do
        last=$(client "$door" log --count 1 --json | grep -o '"sequence": *[0-9]*' | tail -n 1 | grep -o '[0-9]*$')
        [ "$(sql "SELECT count(*) = max(number) AND min(number) = 1 AND max(number) >= $last
                  FROM event JOIN door ON door.id = event.door WHERE door.name = '$door'")" = t ] || return 1
    done
}

step_real() {
    local door begin=$(now_ms) start ms
    for door in $REALS; do
        make_real "$door"
        start_real "$door"
        join_real "$door" || bad "real: $door does not join"
    done
    wait_for 30 reals_are_level || give_up "the real doors are not level"
    expect "real: two daemons with their links join and have the people of hq" [ "$(people_of real1)" = "$(people_of real2)" ]
    expect "real: rita is enrolled at one of them by stored frames" enrol_real real1 p01-enrol rita
    expect "real: not approved, she is refused" [ "$(visits real1 p01-v1)" = "deny not-approved" ]
    wait_for 20 has_request rita || give_up "no request for rita"
    act request approve rita
    wait_for 20 eval 'reals_are_level && is_level hq' || bad "real: rita does not arrive at all doors of hq"
    expect "real: approved, the other door lets her in" [ "$(visits real2 p01-v1)" = "allow rita" ]
    expect "real: and not somebody else" [ "$(visits real2 x01-v1 | cut -d' ' -f1)" = deny ]
    kill_real real2
    start=$(now_ms)
    act person revoke rita
    wait_for 20 is_level hq || bad "real: the simulated doors are not level"
    expect "real: revoked, the door at which she was enrolled refuses her" [ "$(visits real1 p01-v1 | cut -d' ' -f1)" = deny ]
    ms=$(sql "SELECT 1 FROM door_place p JOIN door d ON d.id = p.door JOIN zone z ON z.id = p.zone
              WHERE d.name = 'real1' AND p.sequence = z.sequence")
    expect "real: she was revoked while the other door was killed ($((($(now_ms) - start) / 1000)) s); this one has confirmed" [ "$ms" = 1 ]
    start_real real2
    start_link real2
    expect "real: after its restart the other door is level, with equal digests" wait_for 60 reals_are_level
    expect "real: and refuses her" [ "$(visits real2 p01-v1 | cut -d' ' -f1)" = deny ]
    expect "real: both have the same people, without her" [ "$(people_of real1)" = "$(people_of real2)" -a -z "$(people_of real1 | grep -x rita)" ]
    expect "real: the hub has each of their events once" wait_for 30 real_events_are_home
    for door in $REALS; do
        act door expel "$door"
        kill_real "$door"
    done
    expect "real: the zone goes on without them ($((($(now_ms) - begin) / 1000)) s)" wait_for 30 is_level hq
}
