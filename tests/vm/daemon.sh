# For scripts of tests with the daemon: `. "$VM_SOURCE/tests/vm/daemon.sh"`. It makes the door's lines (gpio_wires.sh), starts a bus, and
# has functions for the daemon and its client.
. "$VM_SOURCE/tests/vm/gpio/gpio_wires.sh"
isotherm=$VM_BUILD/enroll/isotherm
isothermd=$VM_BUILD/firmware/isothermd

die() {
    echo "FAILED: $1"
    tail -n 20 daemon.log
    client doctor || true
    exit 1
}

uptime_s() {
    cut -d . -f 1 /proc/uptime
}

# wait_for SECONDS WHAT COMMAND...: waits until the command succeeds. An idle host needs at most SECONDS; it fails after six times as many.
wait_for() {
    local until_s=$(($(uptime_s) + 6 * $1)) what=$2
    shift 2
    until "$@"; do
        [ "$(uptime_s)" -le $until_s ] || die "$what"
        sleep 0.05
    done
}

# ---- the appliance ----

story_directory=$VM_DIRECTORY story_source=$VM_SOURCE
client() {
    "$isotherm" --bus "$story_address" "$@"
}
. "$VM_SOURCE/tests/support/door_story.sh"
bus_conf >bus.conf
dbus-daemon --config-file=bus.conf --fork --nopidfile

# configure SENSOR: writes isotherm.conf with these lines of [sensor], further sections from standard input, and the door's lines of the
# board qemu.
configure() {
    {
        printf '[sensor]\n%s\n' "$1"
        sed '1,/^path = /d' "$VM_SOURCE/board/qemu/isotherm.conf"
        cat
        stores_conf
    } >isotherm.conf
}

answers() {
    client status >/dev/null 2>&1
}

start() {
    "$isothermd" --config isotherm.conf 2>>daemon.log &
    daemon=$!
    wait_for 60 'the daemon does not answer' answers
}

say() {
    printf '%6.1f s  %s\n' "$(cut -d ' ' -f 1 /proc/uptime)" "$1"
}
