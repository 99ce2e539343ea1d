#!/bin/sh
# The first process of the virtual machine on the host's root. It mounts the file systems that programs expect, runs the test that the
# kernel's command line names, prints its exit code on the second serial line, and switches the machine off.
export PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 OPENBLAS_NUM_THREADS=1
mount -t proc proc /proc
mount -t sysfs sys /sys
mount -t tmpfs run /run
mount -t tmpfs shm /dev/shm 2>/dev/null || { mkdir -p /dev/shm && mount -t tmpfs shm /dev/shm; }
mkdir -p /dev/pts && mount -t devpts pts /dev/pts
ip link set lo up 2>/dev/null

argument() {
    sed "s/.*$1=\([^ ]*\).*/\1/" /proc/cmdline
}

# For tests: the directories of the built programs, the sources and the prepared kernel, and an empty directory.
VM_BUILD=$(argument vm_build) VM_SOURCE=$(argument vm_source) VM_CACHE=$(argument vm_cache)
VM_DIRECTORY=/run/test
export VM_BUILD VM_SOURCE VM_CACHE VM_DIRECTORY
mkdir "$VM_DIRECTORY"
cd "$VM_DIRECTORY" || exit

"$(argument vm_test)" </dev/null >/dev/ttyS0 2>&1
echo "exit $?" >/dev/ttyS1
sync
busybox poweroff -f
