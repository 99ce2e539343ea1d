# For scripts of tests with gpio-sim: `. "$VM_SOURCE/tests/vm/gpio/gpio_sim.sh"` loads the module. For programs, see gpio_sim.h.
set -eu
modprobe -d "$VM_CACHE/root" configfs
insmod "$VM_CACHE/gpio-sim.ko"
mount -t configfs configfs /sys/kernel/config
