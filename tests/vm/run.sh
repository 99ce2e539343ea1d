#!/bin/sh
# Runs tests that need devices of a kernel, each in a virtual machine of its own: Debian's kernel under QEMU (without KVM), the
# host's root read-only beneath a layer in memory, the project's own binaries.
#
#   run.sh BUILD CACHE [TEST...]     all tests of tests.txt, or those named; logs in BUILD/vm
#
# Ends with "N passed, N failed, N skipped"; non-zero if one failed. Where there is no QEMU, all are skipped.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
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

# Exit code of the test; 124: it ran out of time, 125: the machine ended without one.
boot() {
    name=$1 seconds=$2
    rm -f "$build/vm/$name.status"
    # Without AVX, which an emulated processor is slow at.
    timeout "$seconds" qemu-system-x86_64 -machine q35 -accel tcg -cpu Nehalem -smp 1 -m 1024 \
        -nodefaults -no-user-config -display none -no-reboot \
        -serial "file:$build/vm/$name.log" -serial "file:$build/vm/$name.status" \
        -fsdev local,id=root,path=/,security_model=none,readonly=on,multidevs=remap \
        -device virtio-9p-pci,fsdev=root,mount_tag=root \
        -kernel "$cache/vmlinuz" -initrd "$cache/initrd" \
        -append "console=ttyS0 loglevel=4 panic=-1 vm_inside=$here/inside.sh vm_test=$here/$name.sh vm_build=$build vm_source=$source_dir vm_cache=$cache" \
        </dev/null >"$build/vm/$name.qemu" 2>&1 || {
        [ $? -ne 124 ] || return 124
        cat "$build/vm/$name.qemu" >&2
        return 125
    }
    code=$(sed -n 's/^exit \([0-9]*\).*/\1/p' "$build/vm/$name.status")
    return "${code:-125}"
}

passed=0 failed=0 skipped=0
for name in $wanted; do
    seconds=$(awk -v name="$name" '$1 == name { print $2 }' "$here/tests.txt")
    [ -n "$seconds" ] || {
        echo "$0: no test '$name' in tests.txt" >&2
        exit 2
    }
    begin=$(date +%s)
    code=0
    boot "$name" "$seconds" || code=$?
    case $code in
    0) result=passed passed=$((passed + 1)) ;;
    77) result=skipped skipped=$((skipped + 1)) ;;
    *) result="FAILED ($code)" failed=$((failed + 1)) ;;
    esac
    printf '%-20s %-13s %3d s\n' "$name" "$result" $(($(date +%s) - begin))
    [ "$code" -ne 77 ] || grep '^skipped: ' "$build/vm/$name.log" || true
    case $code in 0 | 77) ;; *) tail -n 40 "$build/vm/$name.log" ;; esac
done
echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
