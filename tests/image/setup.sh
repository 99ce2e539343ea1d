# The check `setup` of run.sh: `. tests/image/setup.sh`, after machine.sh. Plain sh. A disk without a configuration, monitor and keyboard.

setup() {
    cp --reflink=auto "$out/test/isotherm.img" "$machine_out/setup.img"
    machine_disk "$machine_out/setup.img" "$machine_out/setup.qcow2"
    rm -f "$machine_out/asked.log" "$machine_out/asked.monitor"
    : >"$machine_out/asked.log"
    python3 "$here/type_keys.py" "$machine_out/asked.log" "$machine_out/asked.monitor" "$machine_out" &
    typing=$! code=0
    machine_devices="-device VGA -monitor unix:$machine_out/asked.monitor,server=on,wait=off" \
        machine_start asked asked "$machine_out/setup.qcow2" || code=$?
    kill $typing 2>/dev/null || true
    [ $code -eq 0 ] || die_with asked $code
    tell asked
    rm -f "$machine_out/setup.img" "$machine_out/setup.qcow2"
}
