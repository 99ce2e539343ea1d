#!/bin/sh
# Runs tests that need devices of a kernel, each in its own virtual machine: Debian's kernel under QEMU (without KVM), the host's root
# read-only under a layer in memory, and the project's binaries.
#
#   run.sh BUILD CACHE [TEST...]     runs all tests of tests.txt, or the named ones; writes logs to BUILD/vm
#
# Runs as many tests at a time as there are processors. Ends with "N passed, N failed, N skipped"; non-zero if one failed. Without QEMU all
# tests are skipped.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
# shellcheck source=tests/support/verdict.sh
. "$here/../support/verdict.sh"
source_dir=$(cd "$here/../.." && pwd)
[ $# -ge 2 ] || {
    echo "usage: $0 BUILD CACHE [TEST...]" >&2
    exit 2
}
build=$(cd "$1" && pwd)
mkdir -p "$2" "$build/vm"
cache=$(cd "$2" && pwd)
shift 2

tests=$(awk '!/^#/ && NF { print $1 }' "$here/tests.txt")
wanted=${*:-$tests}
count=$(echo "$wanted" | wc -w)

skip_all() {
    echo "skipped: $1"
    echo "0 passed, 0 failed, $count skipped"
    exit 0
}

for program in qemu-system-x86_64 busybox cpio depmod make; do
    PATH=$PATH:/usr/sbin:/sbin command -v $program >/dev/null || skip_all "$program is not installed (cmake/install_packages.sh vm)"
done
[ "$(dpkg --print-architecture)" = amd64 ] || skip_all 'the virtual machine is for amd64'
PATH=$PATH:/usr/sbin:/sbin "$here/kernel.sh" "$cache"

# Prints the path of a test's script: next to this file, or in the folder of its devices.
script_of() {
    find "$here" -name "$1.sh"
}

# Prints further options for QEMU: the words of NAME.qemu next to the test's script, if there is one.
devices_of() {
    options=$(dirname "$(script_of "$1")")/$1.qemu
    [ ! -e "$options" ] || sed -e '/^#/d' -e "s|@OUT@|$build/vm|" "$options"
}

# Boots the machine. The exit code is that of the test; 124: it took too long, 125: the machine ended without an exit code. The limit is
# processor time, so that other work of the host fails no test, and six times as much by the clock, for a machine that waits forever.
boot() {
    name=$1 seconds=$2 programs=$3
    rm -f "$build/vm/$name.status" "$build/vm/$name"_*.ppm
    root=
    if [ -x "$here/${name}_root.sh" ]; then
        root="vm_root=$build/vm/$name.root"
        "$here/${name}_root.sh" "$source_dir/build/packages" "$cache" "$build/vm/$name.root" >"$build/vm/$name.log" 2>&1 || return $?
    fi
    # Without AVX, which is slow on an emulated processor.
    # shellcheck disable=SC2046 # the words of devices_of are options
    (ulimit -t "$seconds" && exec timeout $((6 * seconds)) qemu-system-x86_64 -machine q35 -accel tcg -cpu Nehalem -smp 1 -m 1536 \
        -nodefaults -no-user-config -display none -no-reboot \
        -serial "file:$build/vm/$name.log" -serial "file:$build/vm/$name.status" $(devices_of "$name") \
        -fsdev local,id=root,path=/,security_model=none,readonly=on,multidevs=remap \
        -device virtio-9p-pci,fsdev=root,mount_tag=root \
        -fsdev local,id=host,path=/,security_model=none,readonly=on,multidevs=remap \
        -device virtio-9p-pci,fsdev=host,mount_tag=host \
        -kernel "$cache/vmlinuz" -initrd "$cache/initrd" \
        -append "console=ttyS0 loglevel=4 oops=panic panic=-1 vm_inside=$here/inside.sh vm_test=$(script_of "$name") vm_build=$programs vm_source=$source_dir vm_cache=$cache systemd.show_status=false $root" \
        </dev/null >"$build/vm/$name.qemu" 2>&1) || {
        case $? in 124 | 137 | 152) return 124 ;; esac # by the clock; by the processor's, SIGKILL or SIGXCPU
        cat "$build/vm/$name.qemu" >&2
        return 125
    }
    code=$(sed -n 's/^exit \([0-9]*\).*/\1/p' "$build/vm/$name.status")
    return "${code:-125}"
}

# Linux 6.1 releases the media entity of an unplugged camera after its media device if the last file on it is closed at the wrong moment
# (v4l2_device_release). No program can avoid this fault of the kernel, which happens here once in some hundred unplugs. The machine is then
# started again; any other fault of the kernel fails the test.
kernel_broke() {
    grep -q '__media_device_unregister_entity+' "$build/vm/$1.log"
}

# Runs one test. It prints one line, and the log if the test failed, and writes the result to BUILD/vm/NAME.result.
run_one() {
    name=$1
    seconds=$(awk -v name="$name" '$1 == name { print $2 }' "$here/tests.txt")
    preset=$(awk -v name="$name" '$1 == name { print $3 }' "$here/tests.txt")
    programs=$build
    [ "$preset" = - ] || programs=$(dirname "$build")/$preset
    begin=$(date +%s)
    code=0
    if [ -x "$programs/firmware/isothermd" ]; then
        for boot in 1 2 3; do
            code=0
            boot "$name" "$seconds" "$programs" || code=$?
            [ $code -ne 0 ] && kernel_broke "$name" && [ $boot -lt 3 ] || break
            echo "$name: the kernel failed while it released an unplugged camera; boot $((boot + 1))"
        done
    else
        echo "skipped: it needs $programs/firmware/isothermd" >"$build/vm/$name.log"
        code=77
    fi
    case $code in
    0) result=passed ;;
    77) result=skipped ;;
    *) result="FAILED ($code)" ;;
    esac
    case $code in
    0) colour=good ;;
    77) colour=warning ;;
    *) colour=bad ;;
    esac
    printf '%-20s ' "$name"
    paint $colour "$(printf '%-13s' "$result")"
    printf ' %3d s\n' $(($(date +%s) - begin))
    [ "$code" -ne 77 ] || grep '^skipped: ' "$build/vm/$name.log" || true
    case $code in
    0 | 77) ;;
    *)
        grep -n '^\[   LINE   \]\|^\[  ERROR   \]\|^\[  FAILED' "$build/vm/$name.log" || true
        tail -n 40 "$build/vm/$name.log"
        ;;
    esac
    echo "$result" >"$build/vm/$name.result"
}

running=0
for name in $wanted; do
    grep -q "^$name " "$here/tests.txt" || {
        echo "$0: no test '$name' in tests.txt" >&2
        exit 2
    }
    rm -f "$build/vm/$name.result"
done
# Each worker takes the next free test. Making a folder claims a test, because a folder can be made only once. The table has the long tests
# first.
taken=$(mktemp -d)
jobs=$(nproc)
while [ $running -lt "$jobs" ]; do
    for name in $wanted; do
        ! mkdir "$taken/$name" 2>/dev/null || run_one "$name"
    done &
    running=$((running + 1))
done
wait
rm -r "$taken"

tally() {
    for name in $wanted; do
        cat "$build/vm/$name.result" 2>/dev/null || echo 'FAILED (no result)'
    done | grep -c "^$1" || true
}
failed=$(tally FAILED)
say_tally "$(tally passed)" "$failed" "$(tally skipped)"
[ "$failed" -eq 0 ]
