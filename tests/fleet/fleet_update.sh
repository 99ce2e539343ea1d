# A rollout in the check of a fleet: the hub brings an update of the image to a zone of its own, annex, with the doors 55 to 65 in one
# process. The link's code fetches the file over HTTPS and hands it over to the image, which this file plays: the program install-update of
# the image is the real one, a script stands for isotherm(1) and RAUC, and a restart of the machine is one of the link.

ANNEX_FIRST=55 ANNEX_LAST=65
ANNEX_BOARD=isotherm-pc-usb-amd64

annex_doors() { seq "$ANNEX_FIRST" "$ANNEX_LAST" | grep -vxF "${ANNEX_LEFT_OUT:-none}"; }

# ---- the files ----

# A bundle of RAUC in the format "verity", of two parts: contents, a signed manifest, and the length of the message.
make_bundle() { # VERSION FILE
    local length
    [ -f "$work/image-key.pem" ] || openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -subj /CN=updates -days 1 \
        -keyout "$work/image-key.pem" -out "$work/image.pem" 2>>"$work/log/openssl"
    printf '[update]\ncompatible=%s\nversion=%s\n\n[bundle]\nformat=verity\n\n[image.root]\nfilename=root.img\n' "$ANNEX_BOARD" "$1" |
        openssl cms -sign -binary -nodetach -outform DER -signer "$work/image.pem" -inkey "$work/image-key.pem" -out "$work/message"
    length=$(stat -c %s "$work/message")
    head -c $(((4 << 20) + 1234)) /dev/urandom | cat - "$work/message" >"$2"
    python3 -c 'import sys; sys.stdout.buffer.write(int(sys.argv[1]).to_bytes(8, "big"))' "$length" >>"$2"
}

# Where the hubs keep a file.
kept() { echo "$work/hub/updates/$(sha256sum "$1" | cut -d' ' -f1).raucb"; } # FILE

# ---- the image of a door ----

image_of() { echo "$work/doors/$1/image"; }
inbox_of() { echo "$(image_of "$1")/var/lib/isotherm-update/hub"; }

# What `isotherm update --json` says from now on; NEXT: whether the other slot starts next.
slots_say() { # DOOR VERSION NEXT
    local here=true
    [ "$3" = false ] || here=false
    printf '{"board":"%s","version":"%s","proven":true,"slots":[{"running":true,"good":true,"next":%s},{"running":false,"good":true,"next":%s}]}\n' \
        "$ANNEX_BOARD" "$2" "$here" "$3" >"$(image_of "$1")/slots"
}

make_image() { # DOOR
    local image
    image=$(image_of "$1")
    mkdir -p "$image/bin" "$(inbox_of "$1")"
    slots_say "$1" 1.0 false
    cat >"$image/bin/isotherm" <<PROGRAM
#!/bin/sh
[ "\$1 \$2" = 'update --json' ] || exit 9
[ \$# = 3 ] || exec cat "$image/slots"
if [ -e "$image/trial" ]; then
    rm "$image/trial"
    echo '{"error":{"code":"on-trial","message":"the running version is on trial","exit_code":1}}'
    exit 1
fi
if [ -e "$image/refuses" ]; then
    echo '{"error":{"code":"other-board","message":"the update is for another board","exit_code":1}}'
    exit 1
fi
cp "\$3" "$image/installed"
echo '{"installed": true, "slot": "b"}'
PROGRAM
    printf '#!/bin/sh\n' >"$image/bin/busctl" # no daemon of this door is at a bus
    chmod 755 "$image/bin/isotherm" "$image/bin/busctl"
}

has_bundle() { [ -e "$(inbox_of "$1")/bundle.raucb" ]; }
has_wish() { [ -e "$(inbox_of "$1")/restart" ]; }

# What the unit isotherm-update@hub does with a bundle.
image_takes() { # DOOR
    wait_for 300 has_bundle "$1" || return 1
    PATH="$(image_of "$1")/bin:$PATH" ISOTHERM_ROOT=$(image_of "$1") \
        "$here/../../board/image/programs/install-update" hub "$(inbox_of "$1")/bundle.raucb" >>"$work/log/image" 2>&1
}

# Installs at these doors, and restarts them when their links wish it.
images_install() { # VERSION FILE DOOR...
    local version=$1 file=$2 door
    shift 2
    for door in "$@"; do
        slots_say "$door" 1.0 true
        image_takes "$door" && cmp -s "$file" "$(image_of "$door")/installed" || return 1
    done
    for door in "$@"; do
        wait_for 120 has_wish "$door" || return 1
        rm "$(inbox_of "$door")/restart"
        ask link "$door" off >/dev/null
        slots_say "$door" "$version" false
        ask link "$door" on >/dev/null
    done
}

# ---- what the hub knows ----

# The doors of the newest rollout by state, such as "fetching 1 waiting 10".
rolled() { hub update show annex | awk '{ print $2 }' | sort | uniq -c | awk '{ printf "%s%s %s", s, $2, $1; s = " " }'; }
is_rolled() { [ "$(rolled)" = "$1" ]; }
doors_that_are() { hub update show annex | awk -v state="$1" '$2 == state { sub("door", "", $1); print $1 }'; } # STATE
rollout_says() { hub update list | grep -A1 'zone annex' | tail -n 2 | grep -F "$1" >/dev/null; }

# Each door of the zone has asked since, so the hub had reason to tell it.
have_asked_since() { # SECONDS
    [ "$(sql "SELECT count(*) FROM door WHERE name IN ($(printf "'door%s'," $(annex_doors))'') AND reported_s <= $1")" -eq 0 ]
}

# The rollout comes to these states, and stays there however often the doors ask.
stays() { # STATES
    wait_for 120 is_rolled "$1" || return 1
    wait_for 120 have_asked_since "$(date +%s)" && is_rolled "$1"
}

# ---- the steps ----

annex_joins() {
    local door address
    hub zone add annex >/dev/null
    hub zone set annex --lease 8 >/dev/null # the doors ask every second
    start_doors "$ANNEX_FIRST"
    for door in $(annex_doors); do
        make_image "$door"
        address=$(hub door add "door$door" --zone annex | grep -o 'isotherm://[^ ]*' | head -n 1)
        join_door "$door" "$address" || return 1
    done
}

door_says() { [[ $(ask update "$1" | cut -d' ' -f2-) = "$2"* ]]; } # DOOR WORDS
forged_at() { ask state "$1" | sed 's/.* forged \([0-9]*\).*/\1/'; }
has_forged() { [ "$(forged_at "$1")" -gt "$2" ]; } # DOOR NUMBER

# Keeps an order that the door gets now, as it would who listens to the broker.
record_order() { # DOOR FILE
    local folder=$work/doors/$1
    # A LEASE and an UPDATE come in turn.
    { mosquitto_sub -V mqttv5 -h localhost -p "$broker_port" --cafile "$work/broker/ca.pem" --cert "$folder/door.pem" \
        --key "$folder/door-key.pem" -t "isotherm/door/$(cat "$folder/id")/in" -F %x -C 4 -W 60 || true; } | grep '^49534f460108' | head -n 1 |
        python3 -c 'import sys; open(sys.argv[1], "wb").write(bytes.fromhex(sys.stdin.read().strip()))' "$2"
}

# An order of an earlier question, sent again: the door would store that it begins. What is sent behind it and counted as forged shows that
# the door has got both.
leaves_old_order() { # DOOR FILE
    local topic before record
    topic=isotherm/door/$(cat "$work/doors/$1/id")/in
    before=$(forged_at "$1")
    record=$(stat -c '%i %z' "$work/doors/$1/update.record")
    publish "$topic" "$2"
    head -c 100 /dev/urandom >"$work/garbage"
    publish "$topic" "$work/garbage"
    wait_for 120 has_forged "$1" "$before" && door_says "$1" idle &&
        [ "$record" = "$(stat -c '%i %z' "$work/doors/$1/update.record")" ]
}

# The door has been silent for more than half an hour by the clock of the hub; so long ago it was told, and the hub looked all the time.
is_given_up() { # DOOR
    sql "UPDATE door SET reported_s = extract(epoch FROM now()) - 2000 WHERE name = 'door$1';
         UPDATE rollout_door r SET changed_s = extract(epoch FROM now()) - 2000 FROM door d
             WHERE d.id = r.door AND d.name = 'door$1' AND r.state = 'fetching';
         UPDATE rollout SET watched_s = extract(epoch FROM now()) - 2000, counted_s = extract(epoch FROM now()) - 20 WHERE state = 'running'" &&
        hub update show annex | grep "^door$1 .*failed .*it does not report" >/dev/null
}

# The first door: the hub has lost the file for a while, so the door stays with fetching.
annex_first_door() { # FILE
    local file=$1 first
    mv "$(kept "$file")" "$work/kept"
    hub update roll 2.0 --zone annex --first 1 --stop-after 1 || return 1
    expect "update: the first stage tells one door of 11, and no more" stays 'fetching 1 waiting 10'
    first=$(doors_that_are fetching)
    record_order "$first" "$work/order"
    expect "update: an order for it was recorded ($(stat -c %s "$work/order") bytes)" [ -s "$work/order" ]
    hub update stop annex
    expect "update: the rollout is stopped, and the door leaves what it fetches" wait_for 120 door_says "$first" idle
    expect "update: nothing of the file is left at the door" [ ! -e "$(inbox_of "$first")/bundle.part" ]
    expect "update: the recorded order, sent again, is not obeyed" leaves_old_order "$first" "$work/order"
    hub update resume annex
    expect "update: the rollout goes on with the same door" wait_for 120 door_says "$first" fetching
    expect "update: and with no other" stays 'fetching 1 waiting 10'
    ask link "$first" off >/dev/null
    expect "update: the door is silent and has failed; one failure does not stop the rollout" wait_for 120 is_given_up "$first"
    expect "update: the second stage tells one door more" wait_for 120 is_rolled 'failed 1 fetching 1 waiting 9'
    ask link "$first" on >/dev/null
    expect "update: the silent door comes back, is told again, and does not count as failed" stays 'fetching 2 waiting 9'
    mv "$work/kept" "$(kept "$file")"
}

# Two doors whose images refuse the update.
annex_failures() {
    local told
    told=($(doors_that_are fetching))
    touch "$(image_of "${told[0]}")/trial" "$(image_of "${told[0]}")/refuses" "$(image_of "${told[1]}")/refuses"
    image_takes "${told[0]}" || return 1
    expect "update: a refusal that passes by itself is no failure" \
        wait_for 120 eval "hub update show annex | grep '^door${told[0]} .*fetching .*the running version is on trial' >/dev/null"
    image_takes "${told[0]}" || return 1
    expect "update: a door whose image refuses the file says why" \
        wait_for 120 eval "hub update show annex | grep '^door${told[0]} .*failed .*the update is for another board' >/dev/null"
    expect "update: one failed install does not stop the rollout" stays 'failed 1 fetching 1 healthy 2 waiting 7'
    image_takes "${told[1]}" || return 1
    expect "update: the second one does" wait_for 120 rollout_says 'stopped (2 of 4 doors have failed)'
    expect "update: and no door is told any more" stays 'failed 2 healthy 2 waiting 7'
}

# A byte of the file is changed at the hub.
annex_changed_file() {
    local door left=''
    make_bundle 2.1 "$work/update-2.1"
    hub update add "$work/update-2.1" >/dev/null
    python3 -c 'import sys; f = open(sys.argv[1], "r+b"); f.seek(1000000); b = f.read(1); f.seek(1000000); f.write(bytes([b[0] ^ 1]))' \
        "$(kept "$work/update-2.1")"
    hub update roll 2.1 --zone annex --first 9 --stop-after 8
    expect "update: a file with a changed byte fails at all 9 doors" wait_for 120 rollout_says 'stopped (9 of 9 doors have failed)'
    expect "update: because it is not the one that was ordered" \
        [ "$(hub update show annex | grep -c 'failed .*the file is not the one that the hub has ordered')" -eq 9 ]
    for door in $(annex_doors); do left+=$(find "$(image_of "$door")/var/lib/isotherm-update" -name 'bundle.*'); done
    expect "update: nothing of it is left for an image" [ -z "$left" ]
}

step_update() {
    local begin=$(now_ms) A_PROCESS=$((ANNEX_LAST - ANNEX_FIRST + 1)) file=$work/update-2.0 told door
    annex_joins || give_up "the doors of annex cannot join"
    make_bundle 2.0 "$file"
    hub update add "$file" >/dev/null
    annex_first_door "$file" || give_up "no rollout"
    expect "update: both fetch the file byte for byte, install it, and restart" images_install 2.0 "$file" $(doors_that_are fetching)
    expect "update: both are healthy, and the third stage tells as many again" stays 'fetching 2 healthy 2 waiting 7'
    annex_failures || bad "update: the bundle does not arrive"
    hub update resume annex
    expect "update: it goes on with two doors in the place of those that failed" stays 'failed 2 fetching 2 healthy 2 waiting 5'
    images_install 2.0 "$file" $(doors_that_are fetching) || bad "update: the two are not installed"
    expect "update: the fourth stage tells as many as are healthy" stays 'failed 2 fetching 4 healthy 4 waiting 1'
    told=($(doors_that_are fetching))
    ANNEX_LEFT_OUT=${told[3]}$'\n'$(doors_that_are waiting)
    for door in $ANNEX_LEFT_OUT; do act door expel "door$door"; done
    images_install 2.0 "$file" "${told[@]:0:3}" || bad "update: the last three are not installed"
    expect "update: a told door and a waiting one, both expelled, do not count" wait_for 120 is_rolled 'failed 2 healthy 7 unable 2'
    expect "update: and the rollout is done without them" wait_for 120 rollout_says ': done'
    annex_changed_file
    kill "$pid_of_doors55"
    wait "$pid_of_doors55" 2>/dev/null || true
    ok "update: all of it took $((($(now_ms) - begin) / 1000)) s"
}
