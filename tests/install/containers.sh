# For scripts that boot several containers beside each other: `. tests/install/containers.sh`, after container.sh. Plain sh; needs root.
#
#   containers_network COMMAND...  runs COMMAND, this script with its arguments, anew in a network that has nothing but localhost;
#                              in_root stays in the network of the machine
#   container_add NAME TAR     makes the root of a container
#   on NAME COMMAND...         runs a function of container.sh, such as `inside`, for one of the containers
#   container_start NAME       boots it, in a control group of its own
#   containers_remove          ends all of them and removes their roots; for a trap
container_names=''
# Each systemd sees its own part of the control groups alone, so that two units of one name are not one group.
# shellcheck disable=SC2034
container_sys=''

# Servers in the containers have their usual ports, and nothing else on this machine meets them.
containers_network() {
    if [ -z "${CONTAINERS_NETWORK:-}" ]; then
        exec 9</proc/self/ns/net
        export CONTAINERS_NETWORK=own
        exec unshare --net "$@"
    fi
    ip link set lo up
    # shellcheck disable=SC2034
    container_online='nsenter --net=/proc/self/fd/9'
}

container_add() {
    container_unpack "$2"
    # Two machines with one identity would be one machine for D-Bus and systemd.
    : >"$container_root/etc/machine-id"
    rm -f "$container_root/var/lib/dbus/machine-id"
    echo '127.0.0.1 localhost' >"$container_root/etc/hosts"
    eval "container_root_of_$1=\$container_root container_nspawn_of_$1="
    container_names="$container_names $1"
}

on() {
    container_name=$1
    shift
    eval "container_root=\$container_root_of_$container_name container_nspawn=\$container_nspawn_of_$container_name"
    "$@"
}

# Each container has a control group of its own in each hierarchy that systemd uses; the script itself goes back.
container_start() {
    for hierarchy in /sys/fs/cgroup /sys/fs/cgroup/unified /sys/fs/cgroup/systemd; do
        [ -e "$hierarchy/cgroup.procs" ] || continue
        mkdir -p "$hierarchy/isotherm-$$-$1"
        echo $$ >"$hierarchy/isotherm-$$-$1/cgroup.procs"
    done
    on "$1" container_boot
    eval "container_nspawn_of_$1=\$container_nspawn"
    leave_control_group
}

leave_control_group() {
    for hierarchy in /sys/fs/cgroup /sys/fs/cgroup/unified /sys/fs/cgroup/systemd; do
        [ ! -e "$hierarchy/cgroup.procs" ] || echo $$ >"$hierarchy/cgroup.procs"
    done
}

containers_remove() {
    container_remove # the one that boots just now, whose process is not noted yet
    for name in $container_names; do
        on "$name" container_remove
    done
    # A group can be removed when its last process has ended.
    leave_control_group
    for _ in 1 2 3 4 5 6 7 8 9 10; do
        find /sys/fs/cgroup -depth -type d -path "/sys/fs/cgroup/*isotherm-$$-*" -exec rmdir {} + 2>/dev/null || true
        [ -n "$(find /sys/fs/cgroup -maxdepth 2 -name "isotherm-$$-*")" ] || break
        sleep 0.3
    done
}
