# The steps of fleet_check.sh. Doors 0 to 39 belong to the zone hq, 40 to 49 to the zone lab, and door 45 to both (lab is its home).

HQ_LAST=39 BOTH=45

doors_of() { # ZONE
    if [ "$1" = hq ]; then
        seq 0 "$HQ_LAST"
        echo "$BOTH"
    else
        seq $((HQ_LAST + 1)) $((DOORS - 1)) | grep -vx "${DOORS_LEFT_OUT:-none}"
    fi
}

# Waits until a command succeeds; returns its failure after so many seconds.
wait_for() { # SECONDS COMMAND...
    local end=$(($(now_ms) + $1 * 1000))
    shift
    until "$@"; do
        [ "$(now_ms)" -lt "$end" ] || return 1
        sleep 0.2
    done
}

# ---- joining ----

# Joins one door by its one-time address, as isotherm-link does: a key, a request for a certificate, one HTTPS request.
join_door() { # DOOR ADDRESS [FOLDER]
    local folder=${3:-$work/doors/$1} url code reply
    mkdir -p "$folder"
    url=$(sed -n 's|^isotherm://\([^/]*\)/.*|https://\1|p' <<<"$2")
    code=$(sed -n 's|.*[?&]code=\([^&]*\).*|\1|p' <<<"$2")
    openssl req -new -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -subj "/CN=door" \
        -keyout "$folder/door-key.pem" -out "$folder/door.csr" 2>>"$work/log/openssl"
    python3 - "$code" "$(ask address "$1" | cut -d' ' -f2)" "$folder/door.csr" "door$1" >"$folder/join.json" <<'PY'
import json, sys
print(json.dumps({"code": sys.argv[1], "address": sys.argv[2], "csr": open(sys.argv[3]).read(), "name": sys.argv[4]}))
PY
    reply=$(curl -sS --fail --cacert "$work/broker/ca.pem" -H 'Content-Type: application/json' \
        --data-binary @"$folder/join.json" "$url/fleet/v1/join") || return 1
    python3 - "$folder" "$url" <<PY
import base64, json, sys
reply = json.loads('''$reply''', strict=False)
folder = sys.argv[1]
open(folder + "/membership", "wb").write(base64.b64decode(reply["membership"]))
open(folder + "/door.pem", "w").write(reply["certificate"])
open(folder + "/ca.pem", "w").write(reply["ca"])
open(folder + "/link.txt", "w").write("%s %d %s\n" % (reply["broker"]["host"], reply["broker"]["port"], sys.argv[2]))
open(folder + "/id", "w").write(reply["door"])
PY
    [ "$(ask join "$1" "$folder/membership" | cut -d' ' -f2-)" = ok ]
}

# Whether all doors of a zone have the hub's place of it, and the same people.
is_level() { # ZONE
    local want line door n=0 people=''
    want=$(sql "SELECT id || ' ' || epoch || ' ' || sequence || ' ' || left(encode(digest, 'hex'), 8) FROM zone WHERE name = '$1'")
    states >"$work/states"
    for door in $(doors_of "$1"); do
        line=$(grep "^$door " "$work/states") || return 1
        case " $line" in
            *" zone $want"*) ;;
            *) return 1 ;;
        esac
        case $line in *wants-snapshot*) return 1 ;; esac
        # The door of both zones has other people.
        [ "$door" -ne "$BOTH" ] || continue
        line=$(sed 's/.* people \([0-9]* [0-9a-f]*\) .*/\1/' <<<"$line")
        [ -z "$people" ] || [ "$people" = "$line" ] || return 1
        people=$line
        n=$((n + 1))
    done
    level_people=$people
}

# How many doors of a zone are not at its place, by the hub's own list.
unlevel_doors() { # ZONE
    sql "SELECT count(*) FROM door_zone dz JOIN zone z ON z.id = dz.zone LEFT JOIN door_place p ON p.door = dz.door AND p.zone = dz.zone
         JOIN door d ON d.id = dz.door
         WHERE z.name = '$1' AND d.expelled_s = 0 AND (p.sequence IS DISTINCT FROM z.sequence OR p.epoch IS DISTINCT FROM z.epoch)"
}

step_join() {
    local first door zones address begin=$(now_ms) failed=0
    for ((first = 0; first < DOORS; first += A_PROCESS)); do start_doors "$first"; done
    wait_for 20 curl -sS -o "$work/log/curl" --cacert "$work/broker/ca.pem" "https://localhost:${https_port[1]}/" 2>"$work/log/curl.error" ||
        give_up "the hub does not answer"
    for ((door = 0; door < DOORS; door++)); do
        zones="--zone hq"
        [ "$door" -le "$HQ_LAST" ] || zones="--zone lab"
        [ "$door" -ne "$BOTH" ] || zones="--zone lab --zone hq"
        address=$(hub door add "door$door" $zones | grep -o 'isotherm://[^ ]*' | head -n 1)
        join_door "$door" "$address" || failed=$((failed + 1))
    done
    expect "join: $DOORS doors join by one-time codes, $failed failed ($((($(now_ms) - begin) / 1000)) s)" [ "$failed" -eq 0 ]
    [ "$failed" -eq 0 ] || give_up "the doors cannot join"
    expect "join: a code that was used is refused" refuses_code "$address"
    expect "join: all are connected and have a lease" wait_for 60 all_online
    all_online || give_up "the doors are not online"
}

# The hub answers 403, and not another error.
refuses_code() {
    ! join_door 0 "$1" "$work/refused" 2>"$work/log/refused" && grep -q 'error: 403' "$work/log/refused"
}

all_online() {
    states >"$work/states"
    [ "$(grep -c '^[0-9]* online .* lease [1-9]' "$work/states")" -eq "$DOORS" ]
}

# ---- people ----

# Shows a face at all doors, and prints the doors of a list that answer with these words.
doors_that_say() { # WORDS FACE DOOR...
    local words=$1 face=$2 first pids=()
    shift 2
    for ((first = 0; first < DOORS; first += A_PROCESS)); do
        "$build/tests/fleet/fleet_doors" ask "$work/doors/$first.socket" show all "$face" >"$work/shown$first" 2>/dev/null &
        pids+=($!)
    done
    wait "${pids[@]}" || true
    cat "$work"/shown* | awk -v words="$words" -v doors=" $* " '
        { number = $1; sub(/^[0-9]+ /, ""); if ($0 == words && index(doors, " " number " ")) print number }' | sort -n
}

# Somebody is enrolled at a door; the hub approves the request. Prints the milliseconds until all doors of the zone have the person.
enrol_everywhere() { # NAME FACE DOOR ZONE
    local begin
    ask enrol "$3" "$1" "$2" >/dev/null
    wait_for 100 has_request "$1" || return 1
    begin=$(now_ms)
    hub request approve "$1" --zone "$4" >/dev/null || return 1
    wait_for 20 is_level "$4" || return 1
    echo $(($(now_ms) - begin))
}

# Runs a command of the hub. Its status 1 says that some doors have not confirmed yet; what follows waits for them.
act() { # WORD...
    local status=0
    hub "$@" >/dev/null || status=$?
    [ "$status" -le 1 ] || bad "isotherm-hub $*: status $status"
}

has_request() { [ -n "$(sql "SELECT 1 FROM request WHERE name = '$1' AND state = 0")" ]; }

step_enrol() {
    local ms hq lab
    ms=$(enrol_everywhere ada 100 3 hq) || true
    expect "enrol: enrolled at one door, approved, at all doors of the zone after ${ms:-too many} ms" [ -n "$ms" ]
    hq=$(doors_that_say "allow ada" 100 $(echo $(doors_of hq)) | wc -l)
    expect "enrol: $hq of 41 doors of hq let ada in" [ "$hq" -eq 41 ]
    lab=$(doors_that_say "allow ada" 100 $(doors_of lab | grep -vx "$BOTH") | wc -l)
    expect "enrol: $lab of 9 doors of lab alone let ada in" [ "$lab" -eq 0 ]
    enrol_everywhere ben 120 44 lab >/dev/null || bad "enrol: ben does not arrive at the doors of lab"
    expect "enrol: the door of both zones lets both in" \
        [ "$(doors_that_say "allow ada" 100 "$BOTH")$(doors_that_say "allow ben" 120 "$BOTH")" = "$BOTH$BOTH" ]
    expect "enrol: neither the database nor what the broker stores has a template in plain" no_plain_template
}

# A puppet's template contains the same bytes for every face; the doors' own galleries are sealed, too.
no_plain_template() {
    as_postgres "$pg/pg_dump" -h "$work/db" -U postgres fleet >"$work/dump" || return 1
    ! grep -q '7075707065740000' "$work/dump" && ! grep -rqa 'puppet' "$work/broker" "$work/doors"/*/g.db
}

step_revoke() {
    local begin name face ms all=() door
    for name in carl dora emil; do
        face=$((face_of_revoke = ${face_of_revoke:-140} + 20))
        enrol_everywhere "$name" "$face" 7 hq >/dev/null || bad "revoke: $name does not arrive"
        begin=$(now_ms)
        act person revoke "$name"
        wait_for 20 is_level hq || bad "revoke: the doors are not level after 20 s"
        ms=$(($(now_ms) - begin))
        all+=("$ms")
        door=$(doors_that_say "allow $name" "$face" $(echo $(doors_of hq)) | wc -l)
        expect "revoke: $name, $ms ms until all 41 doors have it; $door let $name in" [ "$door" -eq 0 -a "$ms" -le 5000 ]
    done
}

# ---- deltas that are not the next one ----

publish() { # TOPIC FILE
    mosquitto_pub -V mqttv5 -h localhost -p "$hub_broker_port" --cafile "$work/broker/ca.pem" \
        --cert "$work/hub/hub-client.pem" --key "$work/hub/hub-client-key.pem" -q 1 -t "$1" -f "$2"
}

delta_to_file() { # ZONE SEQUENCE FILE
    sql "SELECT encode(bytes, 'hex') FROM delta WHERE sequence = $2 AND zone = (SELECT id FROM zone WHERE name = '$1')" |
        python3 -c 'import sys; open(sys.argv[1], "wb").write(bytes.fromhex(sys.stdin.read().strip()))' "$3"
}

# Everything that was changed, sent again, sent out of order or sent to another zone leaves the doors as they are.
step_forged() {
    local hq lab before after file=$work/forged n
    hq=$(sql "SELECT id FROM zone WHERE name = 'hq'") lab=$(sql "SELECT id FROM zone WHERE name = 'lab'")
    states | sed 's/ lease [0-9]*//; s/ event [0-9]* acked [0-9]*//; s/ refused .* forged [0-9]*//' >"$work/before"
    for n in 1 3 2; do # again and out of order
        delta_to_file hq "$n" "$file"
        publish "isotherm/zone/$hq/delta" "$file"
    done
    delta_to_file hq 1 "$file" # to another zone
    publish "isotherm/zone/$lab/delta" "$file"
    for n in 5 40 80 200 -1; do # changed
        delta_to_file hq 2 "$file"
        python3 -c 'import sys; b = bytearray(open(sys.argv[1], "rb").read()); b[int(sys.argv[2])] ^= 1; open(sys.argv[1], "wb").write(b)' "$file" "$n"
        publish "isotherm/zone/$hq/delta" "$file"
    done
    head -c 100 /dev/urandom >"$file"
    publish "isotherm/zone/$hq/delta" "$file"
    publish "isotherm/zone/$hq/head" "$file"
    sleep 2
    states | sed 's/ lease [0-9]*//; s/ event [0-9]* acked [0-9]*//; s/ refused .* forged [0-9]*//' >"$work/after"
    expect "forged: repeated, reordered, foreign and changed deltas leave $(wc -l <"$work/after") doors as they are" cmp -s "$work/before" "$work/after"
    n=$(states | sed 's/.* refused \([0-9]*\) forged \([0-9]*\).*/\1 \2/' | awk '{ n += $1 + $2 } END { print n }')
    # Seven that were changed or are no message, at the 41 doors of hq; one of another zone, at the 10 doors of lab.
    expect "forged: the doors counted $n of them" [ "$n" -ge $((7 * 41 + 10)) ]
}

# ---- lockdown ----

step_lockdown() {
    local out denied
    kill -9 "$pid_of_doors10" # ten doors that cannot confirm
    wait "$pid_of_doors10" 2>/dev/null || true
    out=$(hub lockdown on hq --wait 3 || true)
    expect "lockdown: the hub names the 10 doors that did not confirm" [ "$(grep -c -o 'door1[0-9]' <<<"$out")" -eq 10 ]
    denied=$(doors_that_say "allow ada" 100 0 9 20 39 "$BOTH" | wc -l)
    expect "lockdown: $denied of 5 doors let ada in" [ "$denied" -eq 0 ]
    start_doors 10
    expect "lockdown: the others have it after their start" wait_for 30 is_level hq
    expect "lockdown: they keep ada out, too" [ -z "$(doors_that_say "allow ada" 100 10 19)" ]
    act lockdown off hq
    wait_for 20 is_level hq || bad "lockdown: it does not end at all doors"
    expect "lockdown: after its end ada is let in" [ "$(doors_that_say "allow ada" 100 0 10 39 | wc -l)" -eq 3 ]
}

# ---- the lease ----

step_lease() {
    hub person offline ada no >/dev/null
    enrol_everywhere fritz 240 1 hq >/dev/null || bad "lease: fritz does not arrive"
    hub person offline fritz yes >/dev/null
    wait_for 20 is_level hq || bad "lease: the doors are not level"
    kill_hubs
    expect "lease: without the hub ada is let in" [ "$(doors_that_say "allow ada" 100 2 30 | wc -l)" -eq 2 ]
    ask advance 2 90000 >/dev/null
    expect "lease: after a day without the hub the door keeps ada out" [ "$(ask show 2 100 | cut -d' ' -f2)" = deny ]
    expect "lease: but not fritz, who may enter without the hub" [ "$(ask show 2 240 | cut -d' ' -f2-)" = "allow fritz" ]
    start_hub 1
    start_hub 2
    expect "lease: with the hub ada is let in again" wait_for 70 says 2 100 "allow ada"
}

says() { [ "$(ask show "$1" "$2" | cut -d' ' -f2-)" = "$3" ]; }

kill_hubs() {
    kill -9 "$pid_of_hub1" "$pid_of_hub2" 2>/dev/null || true
    wait "$pid_of_hub1" "$pid_of_hub2" 2>/dev/null || true
}

# ---- a stolen door ----

step_expel() {
    local epoch
    expect "expel: before, the broker accepts the certificates of the doors 48 and 49" accepts_certificates 48 49
    epoch=$(sql "SELECT epoch FROM zone WHERE name = 'lab'")
    act door expel door49
    DOORS_LEFT_OUT=49
    expect "expel: the zone has a new epoch" [ "$(sql "SELECT epoch FROM zone WHERE name = 'lab'")" -eq $((epoch + 1)) ]
    kill -HUP "$pid_of_broker"
    enrol_everywhere gina 260 41 lab >/dev/null || bad "expel: gina does not arrive at the doors of lab"
    sleep 1
    expect "expel: the stolen door cannot read what comes then" [ -z "$(doors_that_say "allow gina" 260 49)" ]
    expect "expel: the others go on" [ "$(doors_that_say "allow gina" 260 40 48 "$BOTH" | wc -l)" -eq 3 ]
    expect "expel: the broker refuses its certificate, and accepts that of another door" \
        eval 'refuses_certificate 49 && ! refuses_certificate 48'
}

accepts_certificates() { ! refuses_certificate "$1" && ! refuses_certificate "$2"; }

refuses_certificate() {
    ! timeout 10 mosquitto_pub -V mqttv5 -h localhost -p "$broker_port" --cafile "$work/broker/ca.pem" \
        --cert "$work/doors/$1/door.pem" --key "$work/doors/$1/door-key.pem" -q 1 -t "isotherm/door/$(cat "$work/doors/$1/id")/online" -m 1 2>/dev/null
}

# ---- a database of yesterday ----

step_restored() {
    local n
    kill_hubs
    as_postgres "$pg/pg_dump" -Fc -h "$work/db" -U postgres fleet >"$work/yesterday"
    start_hub 1
    start_hub 2
    enrol_everywhere hans 280 5 hq >/dev/null || bad "restored: hans does not arrive"
    act person revoke ada
    wait_for 20 is_level hq || bad "restored: the doors are not level"
    kill_hubs
    sql "DROP SCHEMA public CASCADE; CREATE SCHEMA public" 2>/dev/null
    as_postgres "$pg/pg_restore" -h "$work/db" -U postgres -d fleet <"$work/yesterday"
    start_hub 1
    start_hub 2
    expect "restored: the doors say that the hub knows less than they do" wait_for 80 some_behind
    expect "restored: the hub changes nothing in the zone until it is recovered" refuses_changes
    expect "restored: ada, revoked before, stays out" [ -z "$(doors_that_say "allow ada" 100 0 20 39)" ]
    hub recover hq >/dev/null || bad "restored: the zone cannot be recovered"
    expect "restored: after a recovery all doors have what the hub has" wait_for 80 is_level hq
    n=$(states | grep -c 'behind 1') || true
    expect "restored: $n doors say that the hub is behind" [ "$n" -eq 0 ]
    act person revoke ada
    wait_for 20 is_level hq || bad "restored: the doors are not level after a revocation"
}

some_behind() { states | grep -q 'behind 1'; }
refuses_changes() { ! hub person limit fritz --until 2030-01-01 >"$work/log/behind" 2>&1 && grep -q 'isotherm-hub recover' "$work/log/behind"; }
