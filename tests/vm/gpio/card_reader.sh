#!/bin/sh
. "$VM_SOURCE/tests/vm/gpio/gpio_sim.sh"
exec "$VM_BUILD/tests/vm/vm_card_reader"
