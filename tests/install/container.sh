# For scripts that install the appliance into a container with a fresh Debian and boot it: `. tests/install/container.sh`. Plain sh; needs
# root.
#
#   container_unpack TAR     makes the root of the container, $container_root
#   container_boot           boots it by systemd and waits until systemd has started all units
#   inside COMMAND...        runs a command in the booted container, as root
#   inside_as USER COMMAND...  the same as a user, with the user's groups
#   container_halt           shuts the container down, in order
#   container_remove         ends it at once and removes its root; for a trap
container_root='' container_nspawn='' container_sys=--bind=/sys

container_unpack() {
    container_root=$(mktemp -d /var/tmp/isotherm-container.XXXXXX)
    tar -x -C "$container_root" -f "$1"
    # The image has no name server; the container uses this machine's.
    cp /etc/resolv.conf "$container_root/etc/resolv.conf"
    # systemd-nspawn needs a mount point.
    mount --bind "$container_root" "$container_root"
}

# in_root COMMAND...: runs a command in the root while the container does not run, as an installer does. container_online is set by
# containers.sh.
in_root() {
    ${container_online:-} chroot "$container_root" /usr/bin/env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin LANG=C.UTF-8 DEBIAN_FRONTEND=noninteractive "$@"
}

container_boot() {
    # shellcheck disable=SC2086
    systemd-nspawn --quiet --directory="$container_root" --boot $container_sys --register=no --keep-unit --private-users=no \
        --console=pipe </dev/null >"$container_root.log" 2>&1 &
    container_nspawn=$!
    wait_for 60 'the container does not boot' container_is_up
}

container_leader() {
    pgrep -P "$container_nspawn" | head -n 1
}

inside() {
    nsenter --target "$(container_leader)" --all --wdns=/ /usr/bin/env -i HOME=/root PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin LANG=C.UTF-8 \
        DEBIAN_FRONTEND=noninteractive "$@"
}

inside_as() {
    user=$1
    shift
    inside runuser -u "$user" -- "$@"
}

# "degraded" means that a unit failed; the container runs nevertheless, and the tests check the units that matter.
container_is_up() {
    kill -0 "$container_nspawn" || die 'the container ended'
    [ -n "$(container_leader)" ] && case $(inside systemctl is-system-running 2>/dev/null) in running | degraded) ;; *) false ;; esac
}

container_halt() {
    inside systemctl poweroff
    wait "$container_nspawn" || true
    container_nspawn=''
}

container_remove() {
    [ -z "$container_nspawn" ] || { kill -KILL "$(container_leader)" && wait "$container_nspawn"; } 2>/dev/null || true
    [ -z "$container_root" ] || {
        umount -l "$container_root" 2>/dev/null || true
        rm -rf --one-file-system "$container_root" "$container_root.log" "${container_root%/*}/.#${container_root##*/}.lck"
    }
    container_root='' container_nspawn=''
}

# wait_for SECONDS WHAT COMMAND...: waits until the command succeeds. An idle machine needs at most SECONDS; it fails after six times as
# many.
wait_for() {
    wait_until=$(($(date +%s) + 6 * $1)) wait_what=$2
    shift 2
    until "$@"; do
        [ "$(date +%s)" -le "$wait_until" ] || die "$wait_what"
        sleep 0.1
    done
}
