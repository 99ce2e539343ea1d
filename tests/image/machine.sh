# For scripts that start the image: `. tests/image/machine.sh`. Plain sh. Set machine_out to a directory for logs.
#
#   machine_start NAME PHASE DISK      starts a PC with UEFI (OVMF, systemd-boot) whose disk is DISK, and waits until it is off; the phase is for
#                                      inside.sh. Returns the exit code that it gives; 124: too long, 125: the machine ended without
# Set machine_reboots=reset for a machine that may restart, machine_firmware=secure for one with Secure Boot, machine_devices for further
# options of QEMU, and machine_drive for other options of the disk.
#
# ISOTHERM_ARCH=arm64 starts a machine "virt" with an ARM Cortex-A72 and UEFI (AAVMF) instead.
#
# The log of the serial line is machine_out/NAME.log, and machine_out/NAME.pid has the number of QEMU's process. The processor is emulated,
# that of the PC without AVX, which is slow so.
machine_source=$(cd "$(dirname "$0")/../.." && pwd)
. "$machine_source/tests/image/machine_arch.sh"
machine_seconds=${machine_seconds:-600}

machine_start() {
    name=$1
    rm -f "$machine_out/$name.status" "$machine_out/$name.pid"
    machine_system='qemu-system-x86_64 -machine q35 -cpu Nehalem'
    machine_lines="-serial file:$machine_out/$name.log -serial file:$machine_out/$name.status"
    case ${ISOTHERM_ARCH:-amd64}-${machine_firmware:-plain} in
    arm64-*)
        machine_code=AAVMF_CODE.fd machine_vars=AAVMF_VARS.fd machine_smm=''
        [ "${machine_firmware:-plain}" = plain ] || machine_vars=AAVMF_VARS.snakeoil.fd
        machine_system='qemu-system-aarch64 -machine virt -cpu cortex-a72'
        machine_lines="-serial file:$machine_out/$name.log -chardev file,id=status,path=$machine_out/$name.status -device pci-serial,chardev=status"
        ;;
    amd64-plain) machine_code=OVMF_CODE_4M.fd machine_vars=OVMF_VARS_4M.fd machine_smm='' ;;
    # Its variables can be written in the system management mode only.
    amd64-secure) machine_code=OVMF_CODE_4M.secboot.fd machine_vars=OVMF_VARS_4M.snakeoil.fd machine_smm='-machine smm=on -global driver=cfi.pflash01,property=secure,value=on' ;;
    esac
    machine_uefi=/usr/share/${machine_code%%_*}
    cp "$machine_uefi/$machine_vars" "$machine_out/$name.vars"
    # The limit is processor time, so that other work of the host fails no test, and six times as much by the clock.
    (ulimit -t "$machine_seconds" && exec timeout $((6 * machine_seconds)) $machine_system -accel tcg -smp 1 \
        -m "${machine_memory:-512}" -nodefaults -no-user-config -display none -pidfile "$machine_out/$name.pid" -action "reboot=${machine_reboots:-shutdown}" \
        $machine_smm -drive "if=pflash,format=raw,unit=0,readonly=on,file=$machine_uefi/$machine_code" \
        -drive "if=pflash,format=raw,unit=1,file=$machine_out/$name.vars" \
        $machine_lines \
        -smbios "type=1,serial=$2" -device virtio-rng-pci \
        -drive "if=virtio,${machine_drive:-format=qcow2,file=$3}" \
        -fsdev "local,id=source,path=$machine_source,security_model=none,readonly=on,multidevs=remap" \
        -device virtio-9p-pci,fsdev=source,mount_tag=source ${machine_devices:-} \
        </dev/null >"$machine_out/$name.qemu" 2>&1) || {
        case $? in 124 | 137 | 152) return 124 ;; esac # by the clock; by the processor's, SIGKILL or SIGXCPU
        cat "$machine_out/$name.qemu" >&2
        return 125
    }
    code=$(sed -n 's/^exit \([0-9]*\).*/\1/p' "$machine_out/$name.status")
    return "${code:-125}"
}

# machine_disk IMAGE DISK: makes a disk with room for /var whose content is the image; the image itself is not changed
machine_disk() {
    rm -f "$2"
    qemu-img create -q -f qcow2 -F raw -b "$1" "$2" 1G
}
