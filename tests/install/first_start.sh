#!/bin/sh
# Installs the appliance from the packages, or by `make install`, in a fresh Debian that systemd boots. Then it checks that the appliance
# starts, enrols, lets in and refuses, that it keeps its state over restart, reboot and upgrade, that it is confined, and that purging
# removes all of its files. The web server is installed once the appliance runs, and is checked in the same ways; so is the PAM module, from
# the packages.
#
#   first_start.sh packages DIR TAR      DIR: the packages of `make packages`
#   first_start.sh tree BUILD TAR        BUILD: a configured and built tree whose prefix is /usr/local
#
# root.sh makes TAR. Needs root. Ends with 0 if all checks passed.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
source_dir=$(cd "$here/../.." && pwd)
way=$1
from=$(cd "$2" && pwd)
tar=$3
story_scratch=$(mktemp -d)
install='apt-get install -q -y --no-install-recommends'
installed_packages='isotherm isotherm-data libisotherm0 isotherm-board-pc-usb isotherm-web libpam-isotherm'
. "$here/container.sh"
. "$here/story.sh"
. "$here/say.sh"
. "$here/web_story.sh"
. "$here/pam_story.sh"

# ---- installing ----

packages() {
    for package in "$@"; do
        ls "$from/${package}"_*_"$(dpkg --print-architecture)".deb "$from/${package}"_*_all.deb 2>/dev/null | head -n 1
    done
}

# Installs the packages and their dependencies, as apt would do from a repository.
install_packages() {
    mkdir "$container_root/srv/packages"
    # shellcheck disable=SC2046
    cp $(packages isotherm isotherm-data libisotherm0 isotherm-sim isotherm-board-pc-usb isotherm-web libpam-isotherm) "$container_root/srv/packages"
    in_root apt-get update -qq
    in_root dpkg-query -W -f '${Package}\n' | sort >"$story_scratch/before"
    quiet 'installing isotherm' in_root sh -c "$install"' /srv/packages/isotherm_*.deb /srv/packages/isotherm-data_*.deb /srv/packages/libisotherm0_*.deb'
    in_root dpkg-query -W -f '${Package}\n' | sort >"$story_scratch/after"
    new=$(comm -13 "$story_scratch/before" "$story_scratch/after")
    heavy=$(echo "$new" | grep -E '^lib(llvm|icu|gl|egl|gbm|z3|opencv|camera)|mesa' || true)
    # shellcheck disable=SC2086
    say "isotherm is installed: $(echo "$new" | wc -l) packages, $(in_root dpkg-query -W -f '${Installed-Size}\n' $new | awk '{ s += $1 } END { printf "%.0f", s / 1024 }') MiB"
    [ -z "$heavy" ] || die "isotherm alone pulls in $(echo "$heavy" | tr '\n' ' ')"
    quiet 'installing isotherm-board-pc-usb' in_root sh -c "$install"' /srv/packages/isotherm-board-pc-usb_*.deb'
}

# Installs the dependencies of the packages, and the files that `make install` has put into a staging folder.
install_tree() {
    libraries=$(find "$from" -maxdepth 3 -type f -perm /111 \( -name isothermd -o -name isotherm -o -name isotherm-web -o -name 'isotherm-*.so' -o -name 'libisotherm.so.*' \) -exec objdump -p {} + |
        awk '$1 == "NEEDED" { print $2 }' | sort -u | grep -v '^libisotherm' | while read -r library; do
        path=$(ldconfig -p | awk -v name="$library" '$1 == name { print $NF; exit }')
        dpkg -S "$(readlink -f "$path")" 2>/dev/null || dpkg -S "$path"
    done | cut -d : -f 1 | sort -u)
    in_root apt-get update -qq
    # shellcheck disable=SC2086
    quiet 'installing libraries' in_root apt-get install -q -y --no-install-recommends $libraries
    make -s -C "$source_dir" install DESTDIR="$container_root" >"$story_scratch/make" 2>&1 || {
        tail -n 20 "$story_scratch/make"
        die 'make install'
    }
    cp "$source_dir/cmake/after_install.sh" "$container_root/srv"
    say 'make install, with its default prefix'
}

configure() {
    mkdir -p "$container_root/etc/isotherm"
    cat >"$container_root/etc/isotherm/isotherm.conf" <<END
[sensor]
backend = replay
path = /srv/slot
repeats = yes
[door]
backend = null
unlock_ms = 500
[decision]
gap_ms = 500
[lockout]
failures = 2
first_ms = 600000
END
    cp -r "$source_dir/sim/stored" "$container_root/srv/stored"
    cp "$intrude" "$container_root/srv/intrude"
    cp "$slow_sync" "$container_root/srv/slow_sync.so"
}

# ---- the checks ----

# The web server is off unless it is installed: until now nothing listens at its port.
install_web() {
    web_is_gone
    case $way in
    packages) quiet 'installing isotherm-web' inside sh -c "$install"' /srv/packages/isotherm-web_*.deb' ;;
    tree) inside systemctl --quiet enable --now isotherm-web.service || die 'the unit of the web server does not start' ;;
    esac
    web_works
}

# Only the packages put the module where PAM finds it.
install_pam() {
    quiet 'installing libpam-isotherm' inside sh -c "$install"' pamtester /srv/packages/libpam-isotherm_*.deb'
    pam_works
}

everything_works() {
    others_are_refused
    p01_is_enrolled
    p01_is_let_in
    a_stranger_is_refused
    p01_is_let_in
    exposure 1.3 isothermd.service
    the_door_is_real_time
    calls_are_filtered
    leave_open
    files_are_restricted
    a_slow_disk_is_waited_for
}

state_is_lasting() {
    nobody_is_there
    until is_locked_out; do
        a_stranger_is_refused
    done
    remember_state
    inside systemctl restart isothermd
    wait_for 10 'the unit does not come back' unit_is active
    state_is_kept 'a restart'
    journal_tells 'nobody is let in for' 'as before the restart' 'Started isothermd'
    container_halt
    container_boot
    active_within 5
    state_is_kept 'a reboot'
    web_is_back 'a reboot'
}

upgrade_keeps() {
    mkdir "$container_root/srv/newer"
    for file in "$container_root"/srv/packages/*.deb; do
        "$here/repack.sh" "$file" +upgrade "$container_root/srv/newer"
    done
    before=$(daemon_pid)
    quiet 'the upgrade' inside sh -c "$install"' /srv/newer/isotherm_*.deb /srv/newer/isotherm-data_*.deb /srv/newer/libisotherm0_*.deb \
        /srv/newer/isotherm-board-pc-usb_*.deb /srv/newer/isotherm-web_*.deb /srv/newer/libpam-isotherm_*.deb'
    wait_for 10 'the unit does not come back' unit_is active
    [ "$(daemon_pid)" != "$before" ] || die 'the upgrade does not restart the daemon'
    state_is_kept 'an upgrade'
    pam_is_enabled || die 'an upgrade disables the profile of PAM'
    web_is_back 'an upgrade'
}

state_files() {
    inside ls -A /var/lib/isotherm
}

# The package manager cannot ask here, so purging keeps the files that cannot be restored.
removal_keeps_people() {
    state_files >"$story_scratch/state"
    # shellcheck disable=SC2086
    quiet 'the removal' inside apt-get remove -q -y $installed_packages
    [ -z "$(inside find /proc -maxdepth 2 -name exe -lname '*/isothermd*' 2>/dev/null)" ] || die 'the daemon outlives the removal of its package'
    pam_is_gone
    web_is_gone
    quiet 'the purge' inside apt-get purge -q -y isotherm
    state_files | cmp -s - "$story_scratch/state" || die 'purging removes people without a question'
    say 'removing and purging keep the people if the package manager cannot ask'
}

purge_leaves_nothing() {
    quiet 'the second installation' inside sh -c "$install"' /srv/newer/*.deb'
    echo 'isotherm isotherm/remove-people boolean true' | inside debconf-set-selections
    # shellcheck disable=SC2086
    quiet 'the purge' inside apt-get purge -q -y $installed_packages
    left=$(inside find / -xdev -path /srv -prune -o -path /proc -prune -o -path /sys -prune -o -path /var/lib/apt -prune -o \
        \( -iname '*isotherm*' -o -name 'org.isotherm*' \) -print)
    # The drop-in belongs to this test.
    left=$(echo "$left" | grep -v '^/etc/systemd/system/isothermd.service.d' || true)
    [ -z "$left" ] || die "purging leaves $(echo "$left" | tr '\n' ' ')"
    say 'purging, with the consent to remove the people, leaves no file'
}

intrude=$story_scratch/intrude
slow_sync=$story_scratch/slow_sync.so
gcc -D_GNU_SOURCE -O1 -o "$intrude" "$here/intrude.c"
gcc -D_GNU_SOURCE -O1 -shared -fPIC -o "$slow_sync" "$here/slow_sync.c"
container_unpack "$tar"
case $way in
packages) install_packages ;;
tree) install_tree ;;
esac
configure
container_boot
if [ "$way" = tree ]; then
    inside sh /srv/after_install.sh
    inside systemctl --quiet enable --now isothermd || die 'the unit does not start'
fi
active_within 5
add_users
everything_works
install_web
if [ "$way" = packages ]; then
    install_pam
fi
state_is_lasting
if [ "$way" = packages ]; then
    upgrade_keeps
fi
isotherm lockout clear >/dev/null
p01_is_let_in
if [ "$way" = packages ]; then
    removal_keeps_people
    purge_leaves_nothing
fi
container_halt
say 'the installed appliance opens the door, and shows it in a browser'
