#!/bin/sh
# Prepares the root of the machine that tests the packages (packages.sh): Debian with systemd and udev, the packages, an account of an
# administrator, and a unit that runs the test and switches the machine off.
#
#   packages_root.sh PACKAGES CACHE ROOT      ends with 77 if this machine cannot make it
set -eu
here=$(cd "$(dirname "$0")" && pwd)
source_dir=$(cd "$here/../.." && pwd)
packages=$1 cache=$2 root=$3

skip() {
    echo "skipped: $1"
    exit 77
}
[ "$(id -u)" -eq 0 ] || skip 'only root can make the root of another system'
command -v mmdebstrap >/dev/null || skip 'mmdebstrap is not installed (cmake/install_packages.sh install)'
[ -n "$(ls "$packages"/isotherm_*.deb 2>/dev/null)" ] || skip "there are no packages in $packages (make packages)"

"$here/../install/root.sh" "$cache/base.tar"
rm -rf "$root"
mkdir -p "$root"
tar -x -C "$root" -f "$cache/base.tar"
cp /etc/resolv.conf "$root/etc/resolv.conf"
mkdir "$root/host" "$root/srv/packages"
for name in isotherm isotherm-data libisotherm0 isotherm-board-qemu; do
    cp "$packages/${name}"_*_amd64.deb "$packages/${name}"_*_all.deb "$root/srv/packages" 2>/dev/null || true
done
chroot "$root" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive sh -euc '
    apt-get update -q
    apt-get install -q -y --no-install-recommends udev kmod /srv/packages/*.deb
    useradd --create-home --groups isotherm ada'

# The configuration: the camera plays stored frames, the door uses lines of gpio-sim, and the processor is slow.
mkdir -p "$root/etc/isotherm"
(
    story_directory=/var/lib/isotherm story_source=$source_dir
    . "$source_dir/tests/support/door_story.sh"
    sed "s#^path = .*#path = /srv/slot\n$(patient_sensor_conf | sed ':a;N;$!ba;s/\n/\\n/g')#" "$root/usr/share/isotherm/boards/qemu/isotherm.conf"
    printf 'unlock_ms = 20000\nrefused_ms = 20000\nretry_ms = 100\n'
    patience_conf
) >"$root/etc/isotherm/isotherm.conf"
gcc -D_GNU_SOURCE -O1 -o "$root/srv/intrude" "$source_dir/tests/install/intrude.c"

cat >"$root/etc/systemd/system/vm-test.service" <<'END'
[Unit]
Description=The test that this machine is for
After=multi-user.target
[Service]
Type=oneshot
ExecStart=/srv/vm-test
[Install]
WantedBy=graphical.target
END
cat >"$root/srv/vm-test" <<'END'
#!/bin/sh
# The unit runs the test that the kernel's command line names, prints its exit code on the second serial line, and switches the machine off.
argument() {
    sed "s/.*$1=\([^ ]*\).*/\1/" /proc/cmdline
}
mount -t 9p -o trans=virtio,version=9p2000.L,ro,msize=262144,cache=loose host /host
VM_SOURCE=/host$(argument vm_source) VM_CACHE=/host$(argument vm_cache)
export VM_SOURCE VM_CACHE
"/host$(argument vm_test)" </dev/null >/dev/ttyS0 2>&1
echo "exit $?" >/dev/ttyS1
sync
systemctl poweroff --force --force
END
chmod 755 "$root/srv/vm-test"
chroot "$root" systemctl --quiet enable vm-test.service
# The test writes to that line.
chroot "$root" systemctl --quiet mask serial-getty@ttyS0.service
