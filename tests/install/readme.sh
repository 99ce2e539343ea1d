#!/bin/bash
# Runs the commands of the README's section "A real door", from the README's text, in a Debian that systemd boots, until a person is let
# in. Three things differ from a real door: the camera is a stored recording, the door has no lines, and the packages were built before.
# With README_BUILDS=yes the commands that build the packages run here, too (some minutes).
#
#   readme.sh PACKAGES TAR
set -eu
here=$(cd "$(dirname "$0")" && pwd)
source_dir=$(cd "$here/../.." && pwd)
packages=$(cd "$1" && pwd)
story_scratch=$(mktemp -d)
. "$here/container.sh"
. "$here/story.sh"
. "$here/say.sh"

# Prints the lines of the block after the comment that names this script.
commands() {
    awk '/tests\/install\/readme.sh/ { found = 1; next }
        found && /^    / { print substr($0, 5); lines++; next }
        found && lines { exit }' "$source_dir/README.md"
}

# in_shell COMMAND: runs it in the checkout, as a person would type it
in_shell() {
    inside bash -ec 'sudo() { "$@"; }; cd /root; [ ! -d isotherm ] || cd isotherm; eval "$1"' shell "$1"
}

people_come() {
    somebody_comes p01-v1
    wait_for 20 'nobody is let in' grep -q 'allow' "$story_scratch/follow"
    grep -q 'ada' "$story_scratch/follow" || die 'another person is let in'
}

# run_command COMMAND: runs it, and shows the camera what the command needs
run_command() {
    case $1 in
    *'apt install --yes git'* | 'git clone'* | 'make packages')
        [ "${README_BUILDS:-no}" = yes ] || return 0
        in_shell "$1"
        ;;
    *'isotherm enroll'*)
        in_shell "$1" >"$story_scratch/enroll" 2>&1 &
        local tool=$!
        wait_for 10 'the enrolment does not begin' grep -q . "$story_scratch/enroll"
        somebody_comes p01-enrol
        wait $tool || die "nobody is enrolled: $(cat "$story_scratch/enroll")"
        nobody_is_there
        ;;
    *'log --follow'*)
        in_shell "$1" >"$story_scratch/follow" 2>&1 &
        people_come
        ;;
    *) in_shell "${1//v4l2:\/dev\/video0 --board pc-usb/replay:/srv/slot --board generic}" ;;
    esac
}

mapfile -t lines < <(commands)
[ "${#lines[@]}" -ge 5 ] && [ "${#lines[@]}" -le 10 ] || die "the README has ${#lines[@]} commands, not 5 to 10"
container_unpack "$2"
cp -r "$source_dir/sim/stored" "$container_root/srv/stored"
mkdir -p "$container_root/root/isotherm/build/packages"
cp "$packages"/*.deb "$container_root/root/isotherm/build/packages"
in_root apt-get update -qq
if [ "${README_BUILDS:-no}" = yes ]; then
    rm -r "$container_root/root/isotherm"
    git clone -q --no-hardlinks "$source_dir" "$container_root/srv/isotherm.git"
    in_root sh -c 'printf "[url \"/srv/isotherm.git\"]\ninsteadOf = https://example.org/isotherm.git\n[safe]\ndirectory = *\n" >/root/.gitconfig'
fi
container_boot
for line in "${lines[@]}"; do
    say "\$ $line"
    run_command "$line" >"$story_scratch/out" 2>&1 || {
        tail -n 20 "$story_scratch/out" >&2
        die "$line"
    }
done
say 'the enrolled person is let in'
container_halt
