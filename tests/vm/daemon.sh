# For scripts of tests with the daemon: `. "$VM_SOURCE/tests/vm/daemon.sh"`. The door's lines on a chip of gpio-sim, our hands on the
# wires; a bus; the daemon and its client.
. "$VM_SOURCE/tests/vm/gpio_sim.sh"
isotherm=$VM_BUILD/enroll/isotherm
isothermd=$VM_BUILD/firmware/isothermd
sim=/sys/kernel/config/gpio-sim/door

die() {
    echo "FAILED: $1"
    tail -n 20 daemon.log
    client doctor || true
    exit 1
}

# ---- the wires ----

RELAY=0 GRANTED=1 REFUSED=2 BUZZER=3 CONTACT=5 BUTTON=6 TAMPER=7
mkdir -p $sim/bank
echo 10 >$sim/bank/num_lines
# By name, as boards have them: the number of a chip is another one when it comes back.
for number in 0 1 2 3 4 5 6 7; do
    mkdir $sim/bank/line$number
    echo DOOR$number >$sim/bank/line$number/name
done
echo 1 >$sim/live

line() {
    echo "/sys/devices/platform/$(cat $sim/dev_name)/$(cat $sim/bank/chip_name)/sim_gpio$1"
}

voltage() {
    cat "$(line "$1")/value"
}

pull() {
    echo "pull-$2" >"$(line "$1")/pull"
}

# Shut, not pressed, closed; as wired below.
rest_inputs() {
    pull $CONTACT down
    pull $BUTTON up
    pull $TAMPER down
}

uptime_s() {
    cut -d . -f 1 /proc/uptime
}

# wait_for SECONDS WHAT COMMAND...: until the command is true. The seconds are those of an idle host; it gives up after six times as
# many.
wait_for() {
    local until_s=$(($(uptime_s) + 6 * $1)) what=$2
    shift 2
    until "$@"; do
        [ "$(uptime_s)" -le $until_s ] || die "$what"
        sleep 0.05
    done
}

is_at() {
    [ "$(voltage "$1")" = "$2" ]
}

# ---- the appliance ----

story_directory=$VM_DIRECTORY story_source=$VM_SOURCE
client() {
    "$isotherm" --bus "$story_address" "$@"
}
. "$VM_SOURCE/tests/support/door_story.sh"
bus_conf >bus.conf
dbus-daemon --config-file=bus.conf --fork --nopidfile

# configure SENSOR: writes isotherm.conf with those lines of [sensor], more from standard input; lines of qemu's.
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

told() {
    printf '%6.1f s  %s\n' "$(cut -d ' ' -f 1 /proc/uptime)" "$1"
}
