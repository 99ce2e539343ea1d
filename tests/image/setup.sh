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
    # A virtual console has sixteen colours.
    colours=$(python3 -c '
import sys
picture = open(sys.argv[1], "rb").read()  # PPM: a header of four words, then three bytes a pixel
pixels = picture.split(None, 4)[4] if picture.startswith(b"P6") else b""
print(len({pixels[i:i + 3] for i in range(0, len(pixels), 3)}))' "$machine_out/visitors.ppm")
    [ "$colours" -gt 16 ] || die "the monitor does not show the screen for visitors: $machine_out/visitors.png has $colours colours"
    say "the monitor shows the screen for visitors ($colours colours)"
    rm -f "$machine_out/setup.img" "$machine_out/setup.qcow2" "$machine_out"/*.ppm
}
