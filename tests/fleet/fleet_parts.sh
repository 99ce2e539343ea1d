# The parts of fleet_check.sh: how servers, hubs and doors are started, killed and asked.

checks=0 wrong=0 work=

# Counts a check: ok TEXT, or bad TEXT.
ok() {
    checks=$((checks + 1))
    echo "ok    $*"
}
bad() {
    checks=$((checks + 1)) wrong=$((wrong + 1))
    echo "WRONG $*"
}
expect() { # TEXT COMMAND...
    local text=$1
    shift
    if "$@"; then ok "$text"; else bad "$text"; fi
}

now_ms() { date +%s%3N; }

# ---- servers ----

as_postgres() {
    if [ "$(id -u)" -eq 0 ]; then runuser -u postgres -- "$@"; else "$@"; fi
}

# Makes a directory `work`, whose name begins with NAME, with a database that runs and a hub that does not run yet.
make_database() { # NAME
    work=$(mktemp -d "${TMPDIR:-/var/tmp}/$1.XXXXXX")
    chmod 755 "$work"
    mkdir "$work/db" "$work/doors" "$work/hub" "$work/broker" "$work/log"
    if [ "$(id -u)" -eq 0 ]; then # both servers give up the rights of root
        chown postgres "$work/db"
        chown mosquitto:mosquitto "$work/broker"
        chmod 2770 "$work/broker"
    fi
    as_postgres "$pg/initdb" -D "$work/db/data" -A trust -U postgres >"$work/log/initdb" 2>&1
    broker_port=$(free_port) hub_broker_port=$(free_port)
    https_port=([1]=$(free_port) [2]=$(free_port))
    conninfo="host=$work/db user=postgres dbname=fleet"
    start_postgres
    as_postgres "$pg/createdb" -h "$work/db" -U postgres fleet
    make_hub
}

prepare() {
    local program
    pg=$(ls -d /usr/lib/postgresql/*/bin 2>/dev/null | tail -n 1)
    for program in "$pg/initdb" /usr/sbin/mosquitto; do
        [ -x "$program" ] || {
            echo "fleet_check: $program is missing: skipped"
            exit 77
        }
    done
    trap 'clean_up' EXIT
    make_database fleet-check
    start_broker
    start_hub 1
    start_hub 2
    follow_lists &
}

free_port() {
    python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])'
}

start_postgres() {
    rm -f "$work/db/data/postmaster.pid" "$work"/db/.s.PGSQL.*.lock
    as_postgres "$pg/postgres" -D "$work/db/data" -k "$work/db" -c listen_addresses= \
        -c max_connections=60 >>"$work/log/postgres" 2>&1 &
    pid_of_postgres=$!
    local i
    for i in $(seq 100); do
        as_postgres "$pg/pg_isready" -q -h "$work/db" && return
        sleep 0.1
    done
    echo "fleet_check: PostgreSQL does not start" >&2
    tail "$work/log/postgres" >&2
    exit 1
}

sql() { as_postgres "$pg/psql" -X -q -A -t -h "$work/db" -U postgres -d fleet -c "$1"; }

start_broker() {
    /usr/sbin/mosquitto -c "$work/broker/mosquitto.conf" >>"$work/log/broker" 2>&1 &
    pid_of_broker=$!
    echo "$pid_of_broker" >"$work/broker.pid"
}

# Lets the broker read its lists anew when the hub has changed them, as the path unit of the package does.
follow_lists() {
    local seen='' now
    while sleep 0.5; do
        now=$(cat "$work/broker/acl" "$work/broker/crl.pem" 2>/dev/null | cksum)
        if [ "$now" = "$seen" ] || ! handles_hangup "$(cat "$work/broker.pid")"; then continue; fi
        kill -HUP "$(cat "$work/broker.pid")" 2>/dev/null || true
        seen=$now
    done
}

# SIGHUP ends a program that has not yet set its handler; SIGHUP is bit 0 of the set of caught signals in proc(5).
handles_hangup() { # PID
    local caught
    caught=$(sed -n 's/^SigCgt:\t*//p' "/proc/$1/status" 2>/dev/null)
    [ "${caught:-0}" != 0 ] && ((0x$caught & 1))
}

# ---- the hub ----

hub() { "$build/enroll/hub/command/isotherm-hub" "$@" --config "$work/hub1.conf"; }

# The two hubs have the same database and keys, and each its own port.
make_hub() {
    local i
    for i in 1 2; do
        cat >"$work/hub$i.conf" <<CONF
[database]
conninfo = host=$work/db user=postgres dbname=fleet

[hub]
name = Headquarters
folder = $work/hub
host = localhost
port = ${https_port[$i]}
listen = 127.0.0.1:${https_port[$i]}

[broker]
host = localhost
port = $broker_port
hub_host = localhost
hub_port = $hub_broker_port
folder = $work/broker
persistence = $work/broker
CONF
    done
    hub init >"$work/log/init"
    hub broker-config >>"$work/log/init"
    hub zone add hq >>"$work/log/init"
    hub zone add lab >>"$work/log/init"
}

start_hub() {
    "$build/enroll/hub/command/isotherm-hub" serve --config "$work/hub$1.conf" >>"$work/log/hub$1" 2>&1 &
    eval "pid_of_hub$1=$!"
}

# ---- doors ----

socket_of() { echo "$work/doors/$(($1 / A_PROCESS * A_PROCESS)).socket"; }
ask() { "$build/tests/fleet/fleet_doors" ask "$(socket_of "$2")" "$@"; } # WORD DOOR [WORD...]

start_doors() { # FIRST
    "$build/tests/fleet/fleet_doors" run "$work/doors" "$1" "$A_PROCESS" >"$work/log/ready$1" 2>>"$work/log/doors$1" &
    eval "pid_of_doors$1=$!"
    local i
    for i in $(seq 300); do
        grep -q ready "$work/log/ready$1" 2>/dev/null && return
        sleep 0.1
    done
    echo "fleet_check: the doors from $1 on do not start" >&2
    tail "$work/log/doors$1" >&2
    exit 1
}

# Prints a line for each door: "NUMBER phase people N DIGEST lease ... zone ...".
states() {
    local first
    for ((first = 0; first < DOORS; first += A_PROCESS)); do
        "$build/tests/fleet/fleet_doors" ask "$work/doors/$first.socket" state all 2>/dev/null || true
    done
}

# By itself: a killed runuser leaves its child, the server, behind.
stop_postgres() { [ -z "$work" ] || as_postgres "$pg/pg_ctl" -D "$work/db/data" -m immediate stop >/dev/null 2>&1 || true; }

clean_up() {
    local pid
    stop_postgres
    for pid in $(jobs -p); do
        kill -9 "$pid" 2>/dev/null || true
    done
    wait 2>/dev/null || true
    if [ "${FLEET_KEEP:-}" ]; then echo "kept: $work"; else rm -rf "$work"; fi
}

# Ends the check if what follows would mean nothing.
give_up() {
    echo "fleet_check: $*" >&2
    tail -n 4 "$work"/log/hub* >&2
    exit 1
}

finish() {
    echo "fleet_check: $checks checks, $wrong wrong"
    [ "$wrong" -eq 0 ]
}
