#!/bin/sh
# Tests how an update comes to the image, on a directory instead of its root: install-update and restart-into-update, which the units of the
# pages run, and stick-update, which the unit of a USB stick runs. The bus, isotherm and isothermd are real; play_rauc stands for RAUC, files
# with file systems for the sticks (FAT, or ext4 where the kernel has no FAT), and systemctl is a program of this test, which notes what it is
# asked.
#
#   bring.sh SOURCE BUILD      ends with 77 if there is no dbus-daemon; without the right to mount, the sticks are left out
set -eu
source_dir=$1 build=$2
command -v dbus-daemon >/dev/null || exit 77
ISOTHERM_ROOT=$(mktemp -d)
export ISOTHERM_ROOT
story_directory=$ISOTHERM_ROOT/story story_source=$source_dir
root=$ISOTHERM_ROOT bus_pid='' daemon_pid='' rauc_pid='' loop=''
state=$root/var/lib/isotherm-update
mkdir -p "$root/bin" "$root/story" "$state/page"
. "$source_dir/tests/support/door_story.sh"

# shellcheck disable=SC2317 # called by the trap
clean_up() {
    for pid in $rauc_pid $daemon_pid $bus_pid; do
        kill "$pid" 2>/dev/null || true
        wait "$pid" 2>/dev/null || true
    done
    [ -z "$loop" ] || losetup --detach "$loop" || true
    rm -rf "$root"
}
trap clean_up EXIT

die() {
    echo "FAILED: $1"
    cat "$root/daemon.log" "$root/said" "$root/rauc.log" 2>/dev/null || true
    exit 1
}

# program NAME: makes a program from standard input
program() {
    { echo '#!/bin/sh'; cat; } >"$root/bin/$1"
    chmod 755 "$root/bin/$1"
}

program systemctl <<END
echo "\$*" >>"$root/asked"
END
program isotherm <<END
exec "$build/enroll/isotherm" --bus "$story_address" "\$@"
END
program busctl <<END
exec "$(command -v busctl)" --address="$story_address" "\$@"
END
PATH=$root/bin:$PATH

# rauc_is OPTIONS...: the stand-in for RAUC, with these options
rauc_is() {
    if [ -n "$rauc_pid" ]; then
        kill "$rauc_pid"
        wait "$rauc_pid" 2>/dev/null || true
    fi
    : >"$root/rauc.ready"
    "$build/tests/enroll/play_rauc" "$story_address" "$@" >"$root/rauc.ready" 2>"$root/rauc.log" &
    rauc_pid=$!
    waits_for 'the stand-in for RAUC does not start' test -s "$root/rauc.ready"
}

# says WORDS: the last program has said this
says() {
    grep -q "$1" "$root/said" || die "it does not say '$1'"
}

# The result for the pages; an act that must be on record.
result_is() {
    tr -d '\n' <"$state/result.json" | grep -q "$1" || die "the result is $(cat "$state/result.json"), and not $1"
    grep -q '"at_s":[1-9][0-9]*,' "$state/result.json" || die 'the result has no time'
}

# own_result_is WAY WORDS: what this way has said last, whatever another one has done since
own_result_is() {
    tr -d '\n' <"$state/result-$1.json" | grep -q "$2" || die "the result of $1 is $(cat "$state/result-$1.json"), and not $2"
}

act_is() {
    isotherm log --json | tr -d '\n' | grep -q "$1, asked by $2 of user" || die "not on record: $1 by $2"
}

dbus_begins() {
    bus_conf >"$root/bus.conf"
    dbus-daemon --config-file="$root/bus.conf" --nofork --nopidfile &
    bus_pid=$!
    mkdir "$root/slot"
    {
        printf '[sensor]\nbackend = replay\npath = %s/slot\n' "$root"
        stores_conf
    } >"$root/isotherm.conf"
    "$build/firmware/isothermd" --config "$root/isotherm.conf" 2>"$root/daemon.log" &
    daemon_pid=$!
    waits_for 'the daemon does not start' isotherm status
}

# ---- the pages ----

page() {
    echo "$1" >"$state/page/bundle.raucb"
    "$source_dir/board/image/programs/install-update" page "$state/page/bundle.raucb" >"$root/said" 2>&1 || die 'install-update fails'
    [ ! -e "$state/page/bundle.raucb" ] && [ ! -e "$state/page.raucb" ] || die 'the bundle is not removed'
}

dbus_begins
rauc_is
page good
says 'the update by page is installed'
result_is '"from":"page",.*"installed": true,.*"slot": "b",.*"version": "2.0.0"'
act_is update-installed page
grep -q "InstallBundle $state/page.raucb" "$root/rauc.log" || die 'RAUC is not asked'

rauc_is --error 'Pre-install handler error: Child process exited with code 3'
page old
says 'the update by page is not installed: .*: it is not newer than the running version$'
result_is '"from":"page",.*"code": "not-newer"'
act_is update-refused page
rauc_is --foreign-key
page foreign
says 'no update that is signed with a key of this appliance'
result_is '"code": "foreign-key"'
if grep -q InstallBundle "$root/rauc.log"; then
    die 'RAUC is asked to install a foreign bundle'
fi
# The hub and a page bring one each.
mkdir -p "$state/hub"
rauc_is --error 'Pre-install handler error: Child process exited with code 5'
echo early >"$state/hub/bundle.raucb"
"$source_dir/board/image/programs/install-update" hub "$state/hub/bundle.raucb" >"$root/said" 2>&1 || die 'install-update fails'
rauc_is
page good
own_result_is hub '"from":"hub",.*"code": "on-trial"'
own_result_is page '"from":"page",.*"installed": true'
result_is '"from":"page",.*"installed": true'
# What whoever has taken over the web server could put there: a folder, or a link to another file, which stays.
rauc_is
mkdir "$state/page/bundle.raucb"
"$source_dir/board/image/programs/install-update" page "$state/page/bundle.raucb" >"$root/said" 2>&1 || die 'install-update fails'
result_is '"code":"bad-file"'
echo kept >"$root/kept"
ln -s "$root/kept" "$state/page/bundle.raucb"
"$source_dir/board/image/programs/install-update" page "$state/page/bundle.raucb" >"$root/said" 2>&1 || die 'install-update fails'
result_is '"code":"bad-file"'
[ ! -s "$root/rauc.log" ] || die 'RAUC is asked for what is no file'
[ ! -L "$state/page/bundle.raucb" ] || die 'the link is not removed'
[ -e "$root/kept" ] || die 'what the link names is removed'
echo '    install-update: a good bundle, an older one, a foreign one, two ways, what is none'

# ---- the restart ----

restart() {
    rm -f "$root/asked"
    : >"$state/page/restart"
    "$source_dir/board/image/programs/restart-into-update" page >"$root/said" 2>&1 || die 'restart-into-update fails'
    [ ! -e "$state/page/restart" ] || die 'the wish is not removed'
    [ "$(cat "$root/asked" 2>/dev/null)" = "$1" ] || die "systemd is asked: $(cat "$root/asked" 2>/dev/null), and not: $1"
}

rauc_is
restart ''
rauc_is --installed
restart reboot
echo '    restart-into-update: only into an update'

# ---- a stick ----

# stick NAME...: makes a stick with these files; a name with a slash is in a folder
stick() {
    [ -z "$loop" ] || losetup --detach "$loop"
    loop=''
    rm -rf "$root/stick" "$root/files"
    mkdir "$root/files"
    for name; do
        mkdir -p "$(dirname "$root/files/$name")"
        echo "contents of $name" >"$root/files/$name"
    done
    truncate -s 16M "$root/stick"
    if [ "$ISOTHERM_STICK_TYPE" = vfat ]; then
        mkfs.vfat "$root/stick" >/dev/null
        find "$root/files" -mindepth 1 -maxdepth 1 -exec mcopy -s -i "$root/stick" {} :: \;
    else
        mke2fs -q -t ext4 -d "$root/files" "$root/stick"
    fi
    cp "$root/stick" "$root/stick.before"
    loop=$(losetup --show --find "$root/stick")
}

put_in() {
    mkdir -p "$root/runtime"
    rm -f "$state/result.json"
    RUNTIME_DIRECTORY=$root/runtime unshare --mount "$source_dir/board/image/programs/stick-update" "$loop" >"$root/said" 2>&1 || die 'stick-update fails'
    [ -z "$(find "$state" -name 'stick-*')" ] || die 'the copy is not removed'
    cmp -s "$root/stick" "$root/stick.before" || die 'the stick was written to'
}

export PATH="$PATH:/usr/sbin:/sbin"
ISOTHERM_STICK_TYPE=ext4
if command -v mkfs.vfat >/dev/null && command -v mcopy >/dev/null && { modprobe -q vfat 2>/dev/null || grep -qw vfat /proc/filesystems; }; then
    ISOTHERM_STICK_TYPE=vfat
fi
export ISOTHERM_STICK_TYPE
if [ "$(id -u)" -ne 0 ] || ! stick probe.txt 2>/dev/null ||
    ! unshare --mount mount -t $ISOTHERM_STICK_TYPE -o ro "$loop" /mnt 2>/dev/null; then
    echo '    stick-update: left out, because it needs root and a loop device'
    exit 0
fi
rauc_is
put_in
says 'there is no isotherm-\*.raucb on'
[ ! -e "$state/result.json" ] || die 'a stick without an update has a result'
stick isotherm-2.raucb notes.txt
put_in
says 'the update by stick is installed'
result_is '"from":"stick",.*"installed": true'
act_is update-installed stick
grep -q "InstallBundle $state/stick.raucb" "$root/rauc.log" || die 'RAUC is not asked'
# It stays in.
rauc_is
put_in
says 'was installed before$'
[ ! -e "$state/result.json" ] || die 'an update that was installed before has a result'
[ ! -s "$root/rauc.log" ] || die 'RAUC is asked for an update that was installed before'
rauc_is --error 'Pre-install handler error: Child process exited with code 4'
stick isotherm-4.raucb
put_in
result_is '"from":"stick",.*"code": "other-board"'
rauc_is
put_in
result_is '"from":"stick",.*"installed": true'
act_is update-refused stick
rauc_is
stick isotherm-2.raucb isotherm-3.raucb
put_in
result_is '"from":"stick",.*"code":"several-updates"'
says 'not installed: the stick has more than one isotherm-\*.raucb: leave one there$'
[ ! -s "$root/rauc.log" ] || die 'RAUC is asked for one of several updates'
# Only the top is looked at.
stick below/isotherm-2.raucb
put_in
says 'there is no isotherm-\*.raucb on'
# A stick whose file system is damaged.
dd if=/dev/zero of="$root/stick" bs=4096 count=1 conv=notrunc status=none
if RUNTIME_DIRECTORY=$root/runtime unshare --mount "$source_dir/board/image/programs/stick-update" "$loop" >"$root/said" 2>&1; then
    die 'a damaged stick is taken'
fi
echo "    stick-update on $ISOTHERM_STICK_TYPE: no update, one, the same again, for another board, several, below the top, damaged"
