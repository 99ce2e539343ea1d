#!/bin/sh
# Tests board/image/programs/check-health with a real daemon on a private bus, on a directory instead of the root of the image. isotherm and
# isothermd are those of the build. systemctl and rauc are programs of this test, which note what they are asked.
#
#   health.sh SOURCE BUILD      ends with 77 if there is no dbus-daemon
set -eu
source_dir=$1 build=$2
command -v dbus-daemon >/dev/null || exit 77
ISOTHERM_ROOT=$(mktemp -d)
ISOTHERM_ESP=$ISOTHERM_ROOT/efi
export ISOTHERM_ROOT ISOTHERM_ESP
story_directory=$ISOTHERM_ROOT/story story_source=$source_dir
root=$ISOTHERM_ROOT bus_pid='' daemon_pid=''
mkdir -p "$root/bin" "$root/down" "$root/story" "$root/etc/isotherm" "$root/run/isotherm" "$root/efi/EFI/Linux" \
    "$root/usr/share/isotherm/judge" "$root/usr/share/isotherm/boards/generic"
. "$source_dir/tests/support/door_story.sh"

# shellcheck disable=SC2317 # called by the trap
clean_up() {
    for pid in $daemon_pid $bus_pid; do
        kill "$pid" 2>/dev/null || true
        wait "$pid" 2>/dev/null || true
    done
    rm -rf "$root"
}
trap clean_up EXIT

die() {
    echo "FAILED: $1"
    cat "$root/daemon.log" "$root/said" 2>/dev/null || true
    exit 1
}

# program NAME: makes a program from standard input
program() {
    { echo '#!/bin/sh'; cat; } >"$root/bin/$1"
    chmod 755 "$root/bin/$1"
}

# A file in `down` with the name of a unit: this unit does not run.
program systemctl <<END
case "\$1" in
reboot) echo reboot >>"$root/asked" ;;
--quiet) shift 2; for unit; do [ ! -e "$root/down/\$unit" ] || exit 3; done ;;
*) exit 2 ;;
esac
END
# It is busy once for each line of the file `busy`. It marks the slot as good by the image's own program if there is a file `marks`.
program rauc <<END
echo "rauc \$*" >>"$root/asked"
cp "$root/run/isotherm/trial" "$root/trial-before"
[ ! -s "$root/busy" ] || {
    sed -i 1d "$root/busy"
    echo 'rauc: it already does something else' >&2
    exit 1
}
[ ! -e "$root/marks" ] || "$source_dir/board/image/programs/boot-slots" set-state b good
END
program isotherm <<END
exec "$build/enroll/isotherm" --bus "$story_address" "\$@"
END
program isothermd <<END
exec "$build/firmware/isothermd" "\$@"
END
PATH=$root/bin:$PATH

stands_before_the_camera() {
    ln -sfn "$source_dir/sim/stored/$1" "$root/slot"
}

start_daemon() {
    isothermd --config "$root/etc/isotherm/isotherm.conf" 2>"$root/daemon.log" &
    daemon_pid=$!
    tries=300
    until isotherm status >/dev/null 2>&1; do
        tries=$((tries - 1))
        [ $tries -gt 0 ] || die 'the daemon does not start'
        sleep 0.2
    done
}

stop_daemon() {
    kill "$daemon_pid"
    wait "$daemon_pid" || true
    daemon_pid=''
}

# finds CODE WORDS ASKED [SECONDS [PATIENCE]]: check-health ends with this code, says these words, and asks this of systemd and RAUC;
# "TEXT..." stands for TEXT once or several times
finds() {
    code=0
    rm -f "$root/asked"
    "$source_dir/board/image/programs/check-health" "${4:-1}" "${5:-60}" >"$root/said" 2>&1 || code=$?
    [ $code -eq "$1" ] || die "check-health ends with $code, not $1"
    grep -q "$2" "$root/said" || die "check-health does not say '$2'"
    case $3 in
    *...) [ "$(sort -u "$root/asked")..." = "$3" ] ;;
    *) [ "$(cat "$root/asked" 2>/dev/null)" = "$3" ] ;;
    esac || die "check-health asks: $(cat "$root/asked" 2>/dev/null), and not: $3"
}

# says_trial FILE WORD: everybody can read in the file whether the version is on trial
says_trial() {
    [ "$(cat "$root/$1")" = "TRIAL=$2" ] && [ "$(stat -c %a "$root/$1")" = 644 ] ||
        die "$1: $(stat -c %a "$root/$1") $(cat "$root/$1"), and not TRIAL=$2"
}

umask 022
bus_conf >"$root/bus.conf"
dbus-daemon --config-file="$root/bus.conf" --nofork --nopidfile &
bus_pid=$!
{
    printf '[sensor]\nbackend = replay\npath = %s/slot\n' "$root"
    stores_conf
} >"$root/etc/isotherm/isotherm.conf"
cp "$source_dir/board/generic/isotherm.conf" "$root/usr/share/isotherm/boards/generic"
judge=$root/usr/share/isotherm/judge
ln -s "$source_dir/sim/stored/p01-v2" "$judge/enrolled"
ln -s "$source_dir/sim/stored/p02-v1" "$judge/other"
ln -s "$source_dir/sim/stored/p01-v1" "$judge/visitor"
echo SLOT=b >"$root/run/isotherm/slot"
printf MZ >"$root/efi/EFI/Linux/isotherm-b+2-1.efi"

# The sensor works, but what it delivers is damaged.
mkdir "$root/damaged"
echo damaged >"$root/damaged/recording.ini"
ln -s "$root/damaged" "$root/slot"
start_daemon
finds 1 'the sensor shows nothing: .*recording.ini' reboot 5
# There is no sensor, and the daemon knows it.
rm "$root/slot"
finds 0 'slot b is good' 'rauc status mark-good' 60
# The sensor has been seen.
stands_before_the_camera none-nobody1
finds 0 'slot b is good' 'rauc status mark-good' 60

# It is on trial until RAUC has marked it as good; here RAUC has not done it.
says_trial run/isotherm/trial yes

# RAUC is busy with an update: twice, and for longer than check-health waits.
asked='rauc status mark-good'
printf '1\n2\n' >"$root/busy"
finds 0 'slot b is good' "$(printf '%s\n%s\n%s' "$asked" "$asked" "$asked")" 60
seq 100 >"$root/busy"
finds 1 'RAUC does not mark slot b as good' "$asked..." 60 3
rm "$root/busy"

touch "$root/down/nftables.service"
finds 1 'a unit does not run' reboot
rm "$root/down/nftables.service"

# Recognition does not work: somebody else is taken for the enrolled person.
ln -sfn "$source_dir/sim/stored/p02-v2" "$judge/visitor"
finds 1 'stored frames are not judged as they have to be' reboot
grep -q 'the visitor is taken for another person' "$root/said" || die 'check-health does not say why'
ln -sfn "$source_dir/sim/stored/p01-v1" "$judge/visitor"

stop_daemon
finds 1 'the daemon does not run or does not answer' reboot
says_trial run/isotherm/trial yes
# A slot that has been good before is not left.
mv "$root/efi/EFI/Linux/isotherm-b+2-1.efi" "$root/efi/EFI/Linux/isotherm-b.efi"
finds 1 'the daemon does not run or does not answer' ''
says_trial run/isotherm/trial no
# A door that is not set up yet; its version is on trial until RAUC has marked it.
mv "$root/efi/EFI/Linux/isotherm-b.efi" "$root/efi/EFI/Linux/isotherm-b+2-1.efi"
rm "$root/etc/isotherm/isotherm.conf" "$root/run/isotherm/trial"
touch "$root/marks"
finds 0 'slot b is good' 'rauc status mark-good'
says_trial trial-before yes
says_trial run/isotherm/trial no
# Without an entry nothing is known.
rm "$root/efi/EFI/Linux/isotherm-b.efi"
finds 0 'slot b is good' 'rauc status mark-good'
[ ! -e "$root/run/isotherm/trial" ] || die 'a slot without an entry is not on trial'
echo '    check-health: sensor damaged, absent, seen; RAUC busy; units, daemon and recognition that fail; no configuration; on trial or not'
