#!/bin/sh
# Changes the root of the image into that of the test's machine, before it is sealed: a unit runs the script that the host gives it over
# 9p, as root. An image for doors has none of this (production.sh checks that).
#
#   extra.sh ROOT      ISOTHERM_CACHE: as for board/image/build.sh
set -eu
root=$1
source_dir=$(cd "$(dirname "$0")/../.." && pwd)
kernel=$ISOTHERM_CACHE/kernel
PATH=$PATH:/usr/sbin:/sbin
. "$source_dir/tests/image/machine_arch.sh"
release=$(cut -d ' ' -f 1 "$ISOTHERM_CACHE/kernel.release")

for name in 9p 9pnet_virtio configfs; do
    modprobe -d "$kernel" -S "$release" --show-depends $name
done | awk '$1 == "insmod" { print $2 }' | sort -u | while read -r module; do
    install -D -m 0644 "$module" "$root/usr/lib/modules/$release/${module#*modules/"$release"/}"
done
depmod -b "$root" "$release"

# An administrator, and the configuration: the camera plays stored frames, the door uses lines of gpio-sim, and the processor is slow.
printf 'u ada 1000\nm ada isotherm\n' | systemd-sysusers --root="$root" -
mkdir "$root/host"
(
    story_directory=/var/lib/isotherm story_source=$source_dir
    . "$source_dir/tests/support/door_story.sh"
    sed "s#^path = .*#path = /srv/slot\n$(patient_sensor_conf | sed ':a;N;$!ba;s/\n/\\n/g')#" "$source_dir/board/qemu/isotherm.conf"
    printf 'unlock_ms = 20000\nrefused_ms = 20000\nretry_ms = 100\n'
    patience_conf
) >"$root/usr/lib/isotherm-image/test.conf"
echo 'tmpfs /srv tmpfs size=64M 0 0' >>"$root/etc/fstab"

cat >"$root/usr/lib/systemd/system/image-test.service" <<'END'
[Unit]
Description=The test that this machine is for
RequiresMountsFor=/var /srv
[Service]
Type=exec
ExecStart=/usr/lib/isotherm-image/test
TimeoutStartSec=infinity
END
sed "s/@CONSOLE@/$machine_console/; s/@STATUS@/$machine_status/; s#@CACHE@#$machine_cache#" >"$root/usr/lib/isotherm-image/test" <<'END'
#!/bin/sh
# Runs the script of the host's tree for this phase of the test, prints its exit code on the second serial line, and switches off.
export PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root VM_SOURCE=/host VM_CACHE=/host/@CACHE@
mount -t 9p -o trans=virtio,version=9p2000.L,ro,msize=262144,cache=loose source /host
/host/tests/image/inside.sh "$(cat /sys/class/dmi/id/product_serial)" </dev/null >/dev/@CONSOLE@ 2>&1
echo "exit $?" >/dev/@STATUS@
sync
systemctl poweroff --force --force
END
chmod 755 "$root/usr/lib/isotherm-image/test"
ln -s /usr/lib/systemd/system/image-test.service "$root/etc/systemd/system/multi-user.target.wants/image-test.service"
