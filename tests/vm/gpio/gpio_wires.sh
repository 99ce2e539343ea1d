# For scripts of tests with a door: `. "$VM_SOURCE/tests/vm/gpio/gpio_wires.sh"`. The door's lines on a chip of gpio-sim, our hands on the wires.
. "$VM_SOURCE/tests/vm/gpio/gpio_sim.sh"
sim=/sys/kernel/config/gpio-sim/door

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

is_at() {
    [ "$(voltage "$1")" = "$2" ]
}
