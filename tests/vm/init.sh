#!/bin/busybox sh
# The first process of the virtual machine, in its initial RAM disk. It puts a writable layer in memory over the host's root, which it
# mounts read-only over 9p, and continues there with inside.sh.
/bin/busybox --install -s /bin
mount -t proc proc /proc
mount -t devtmpfs dev /dev
while read -r module; do
    insmod "/modules/$module" || echo "vm: $module does not load"
done </modules/order
# A test may have a separate root, which then boots as a machine does.
root=$(sed -n 's/.*vm_root=\([^ ]*\).*/\1/p' /proc/cmdline)
mount -t 9p -o trans=virtio,version=9p2000.L,ro,msize=262144,cache=loose root /host &&
    mount -t tmpfs -o size=75% write /write &&
    mkdir /write/upper /write/work &&
    mount -t overlay -o lowerdir=/host$root,upperdir=/write/upper,workdir=/write/work overlay /new || {
    echo 'vm: no root'
    poweroff -f
}
inside=$(sed 's/.*vm_inside=\([^ ]*\).*/\1/' /proc/cmdline)
umount /proc
mount -o move /dev /new/dev
[ -z "$root" ] || exec switch_root /new /sbin/init
exec switch_root /new /bin/sh "$inside"
