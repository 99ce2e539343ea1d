# Faults at random: hubs, doors, broker and database are killed while people come, go and are let in.

ledger() { echo "$(now_ms) $*" >>"$work/ledger"; }

# ---- what is killed ----

kill_and_start() { # what
    local pause first pid
    pause=0.$((RANDOM % 10))
    case $1 in
        hub1 | hub2)
            eval "pid=\$pid_of_$1"
            kill -9 "$pid" 2>/dev/null || true
            wait "$pid" 2>/dev/null || true
            sleep "$pause"
            start_hub "${1#hub}"
            ;;
        broker)
            kill -9 "$pid_of_broker" 2>/dev/null || true
            wait "$pid_of_broker" 2>/dev/null || true
            sleep "$pause"
            start_broker
            ;;
        database)
            pkill -9 -P "$pid_of_postgres" 2>/dev/null || true
            kill -9 "$pid_of_postgres" 2>/dev/null || true
            wait "$pid_of_postgres" 2>/dev/null || true
            pkill -9 -f "$work/db/data" 2>/dev/null || true
            sleep "$pause"
            start_postgres
            ;;
        doors)
            first=$((RANDOM % (DOORS / A_PROCESS) * A_PROCESS))
            eval "pid=\$pid_of_doors$first"
            kill -9 "$pid" 2>/dev/null || true
            wait "$pid" 2>/dev/null || true
            sleep "$pause"
            start_doors "$first"
            ;;
    esac
}

# ---- what people do meanwhile ----

# A person comes, is let in here and there, and is revoked. All of it may fail and is tried again.
one_life() { # NUMBER
    local name=p$1 face=$((1000 + 20 * $1)) door i
    door=$((RANDOM % (HQ_LAST + 1)))
    for i in $(seq 20); do
        ask enrol "$door" "$name" "$face" >/dev/null 2>&1 && break
        sleep 0.5
    done
    for i in $(seq 60); do
        hub request approve "$name" --zone hq >/dev/null 2>&1 && break
        sleep 0.5
    done
    ledger came "$name"
    for i in $(seq 6); do
        visit "$((RANDOM % (HQ_LAST + 1)))" "$name" "$face"
        sleep 0.5
    done
    for i in $(seq 60); do
        hub person revoke "$name" >/dev/null 2>&1 && break
        [ -z "$(sql "SELECT 1 FROM person WHERE name = '$name'" 2>/dev/null || echo 1)" ] && break
        sleep 0.5
    done
    ledger revoked "$name"
    for i in $(seq 6); do
        sleep "$((RANDOM % 8))"
        visit "$((RANDOM % (HQ_LAST + 1)))" "$name" "$face"
    done
    ledger gone "$name"
}

visit() { # DOOR NAME FACE
    local answer
    answer=$(ask show "$1" "$3" 2>/dev/null | cut -d' ' -f2-) || return 0
    [ -z "$answer" ] || ledger visit "$2" "$1" "$answer"
}

# Visits that let somebody in who was revoked longer ago than the lease, which is the longest time that a door may act on its own.
admitted_too_late() {
    awk -v lease=$((LEASE_S * 1000)) '
        $2 == "revoked" { revoked[$3] = $1 }
        $2 == "visit" && $5 == "allow" && $6 == $3 && ($3 in revoked) && $1 > revoked[$3] + lease { n++ }
        END { print n + 0 }' "$work/ledger"
}

step_faults() {
    local end target lives=0 kills=0 targets=(hub1 hub2 broker database doors doors doors) people=() seconds
    RANDOM=$seed
    hub zone set hq --lease "$LEASE_S" >/dev/null
    wait_for 30 is_level hq || true
    : >"$work/ledger"
    end=$(($(now_ms) + fault_s * 1000))
    while [ "$(now_ms)" -lt "$end" ]; do
        if [ "$(jobs -rp | wc -l)" -lt 16 ] && [ $((kills % 2)) -eq 0 ]; then
            one_life "$lives" &
            people+=($!)
            lives=$((lives + 1))
        fi
        sleep "$((RANDOM % 3)).$((RANDOM % 10))"
        target=${targets[$((RANDOM % ${#targets[@]}))]}
        kill_and_start "$target"
        ledger killed "$target"
        kills=$((kills + 1))
    done
    [ ${#people[@]} -eq 0 ] || wait "${people[@]}" 2>/dev/null || true
    seconds=$(now_ms)
    expect "faults: after $kills kills all doors of hq have what the hub has" wait_for 120 is_level hq
    expect "faults: and those of lab" wait_for 60 is_level lab
    ok "faults: level again $((($(now_ms) - seconds) / 1000)) s after the last kill"
    expect "faults: $lives people came and went, $(grep -c ' visit ' "$work/ledger") visits, $(grep -c ' allow ' "$work/ledger") let in; $(admitted_too_late) longer after their revocation than the lease" \
        [ "$(admitted_too_late)" -eq 0 ]
    expect "faults: nobody who was revoked is left" [ -z "$(sql "SELECT name FROM person WHERE name ~ '^p[0-9]+\$'")" ]
    expect "faults: all events are at home" wait_for 90 events_are_home
    expect "faults: each event is there once, without a gap" every_event_once
}

# Every door has sent all records of its log that it had a moment ago.
events_are_home() {
    states | grep -v "^${DOORS_LEFT_OUT:-none} " | awk '
        { for (i = 1; i < NF; i++) { if ($i == "event") e = $(i + 1); if ($i == "acked") a = $(i + 1) } if (e > a) late++ }
        END { exit late > 0 }'
}

every_event_once() {
    local bad
    bad=$(sql "SELECT count(*) FROM (SELECT door, count(*) AS n, min(number) AS first, max(number) AS last FROM event GROUP BY door) AS d
               WHERE n <> last - first + 1 OR first <> 1")
    events_total=$(sql "SELECT count(*) FROM event")
    echo "      $events_total events of $(sql "SELECT count(DISTINCT door) FROM event") doors"
    [ "$bad" -eq 0 ]
}
