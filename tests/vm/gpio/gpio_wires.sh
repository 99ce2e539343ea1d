# For scripts of tests with a door: `. "$VM_SOURCE/tests/vm/gpio/gpio_wires.sh"`. It makes a chip of gpio-sim with the door's lines, and has
# functions that set and read the wires.
. "$VM_SOURCE/tests/vm/gpio/gpio_sim.sh"
sim=/sys/kernel/config/gpio-sim/door

RELAY=0 GRANTED=1 REFUSED=2 BUZZER=3 CONTACT=5 BUTTON=6 TAMPER=7
mkdir -p $sim/bank
echo 10 >$sim/bank/num_lines
# The lines are named, as on boards: the number of a chip changes when it is plugged in again.
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

# The door is shut, the button is not pressed, the housing is closed; board/qemu/isotherm.conf has the wiring.
rest_inputs() {
    pull $CONTACT down
    pull $BUTTON up
    pull $TAMPER down
}

is_at() {
    [ "$(voltage "$1")" = "$2" ]
}
