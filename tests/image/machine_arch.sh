# What the machines of the tests have that depends on the architecture of the image: `. tests/image/machine_arch.sh`. Plain sh. ISOTHERM_ARCH is as
# in board/image/arch.sh.
#
# It sets
#   machine_console     the serial line of the log
#   machine_status      the serial line on which the test gives its result
#   machine_cache       the folder of the tree where tests/vm/kernel.sh has put gpio-sim
#   machine_keys        the folder with key and certificate of the firmware for Secure Boot
#   machine_cmdline     words of the kernel's command line
case ${ISOTHERM_ARCH:-amd64} in
amd64) machine_console=ttyS0 machine_status=ttyS1 machine_cache=build/vm machine_keys=/usr/share/ovmf ;;
# QEMU's machine "virt" has one serial line of its own, and the other one is a PCI card.
arm64)
    machine_console=ttyAMA0 machine_status=ttyS0 machine_cache=build/vm-arm64 machine_keys=/usr/share/qemu-efi-aarch64
    ;;
esac
machine_cmdline="console=tty0 console=$machine_console systemd.show_status=false"
