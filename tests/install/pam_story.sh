# Checks of the PAM module in a booted container: `. tests/install/pam_story.sh`, after tests/install/story.sh. p01 is enrolled. Plain sh. The
# program that logs somebody in is pamtester: as root, and as the user eve in place of a screen locker.

pam_is_enabled() {
    inside grep -q pam_isotherm /etc/pam.d/common-auth
}

# pam_service NAME LINE...: a service of PAM that authenticates by these lines
pam_service() {
    story_service=$1
    shift
    printf '%s\n' "$@" 'account required pam_permit.so' | inside tee "/etc/pam.d/$story_service" >/dev/null
}

# logs_in RECORDING COMMAND...: whether the command lets somebody in; the visitor comes when the camera looks. The command prints each line
# at once (stdbuf).
logs_in() {
    story_recording=$1
    shift
    nobody_is_there
    "$@" >"$story_scratch/pam" 2>&1 </dev/null &
    story_login=$!
    wait_for 10 "the camera does not look: $(cat "$story_scratch/pam")" grep -q 'Look at the camera' "$story_scratch/pam"
    somebody_comes "$story_recording"
    story_end=0
    wait $story_login || story_end=$?
    nobody_is_there
    return $story_end
}

# does_not_look COMMAND...: fails if the command lets somebody in, or if the camera looks
does_not_look() {
    if "$@" >"$story_scratch/pam" 2>&1 </dev/null; then
        die "'$*' lets somebody in"
    fi
    if grep -q 'Look at the camera' "$story_scratch/pam"; then
        die "'$*' looks at a face"
    fi
}

pam_is_off_at_first() {
    if pam_is_enabled; then
        die 'installing libpam-isotherm enables it'
    fi
    pam_service isotherm-test 'auth required pam_isotherm.so'
    pam_service isotherm-common '@include common-auth'
    printf 'ada p01\neve p01\n' | inside tee /etc/isotherm/pam-users >/dev/null
    does_not_look inside stdbuf -oL pamtester isotherm-test ada authenticate
    inside journalctl --no-pager --quiet | grep -q 'guards a door and serves no logins' || die 'the journal does not say why a login is refused'
    say 'the PAM module is off when it is installed, and a door gives no login its camera'
}

pam_serves_a_desk() {
    printf '[login]\ndesk = yes\n' | inside tee -a /etc/isotherm/isotherm.conf >/dev/null
    inside systemctl restart isothermd
    wait_for 10 'the unit does not come back' unit_is active
    logs_in p01-v1 inside stdbuf -oL pamtester isotherm-test ada authenticate || die "ada does not log in by face: $(cat "$story_scratch/pam")"
    logs_in p01-v2 inside_as eve stdbuf -oL pamtester isotherm-test eve authenticate || die "eve, in no group, is not verified: $(cat "$story_scratch/pam")"
    does_not_look inside_as eve stdbuf -oL pamtester isotherm-test ada authenticate
    does_not_look inside stdbuf -oL pamtester isotherm-test root authenticate
    does_not_look inside stdbuf -oL pamtester -I rhost=192.0.2.7 isotherm-test ada authenticate
    inside chmod 0666 /etc/isotherm/pam-users
    does_not_look inside stdbuf -oL pamtester isotherm-test ada authenticate
    inside chmod 0644 /etc/isotherm/pam-users
    say 'root logs a user in by face, a program of a user verifies this user alone, and a remote login does not look'
}

pam_profile_can_be_enabled() {
    inside pam-auth-update --enable isotherm
    pam_is_enabled || die 'pam-auth-update does not enable the profile'
    logs_in p01-v1 inside stdbuf -oL pamtester isotherm-common ada authenticate || die "the profile lets nobody in: $(cat "$story_scratch/pam")"
    say 'pam-auth-update enables the profile, which lets a face in before the password'
}

pam_works() {
    pam_is_off_at_first
    pam_serves_a_desk
    pam_profile_can_be_enabled
    inside rm /etc/pam.d/isotherm-test /etc/pam.d/isotherm-common
    # The next checks are those of a door.
    inside sed -i '/^\[login\]$/,$d' /etc/isotherm/isotherm.conf
    inside systemctl restart isothermd
    wait_for 10 'the unit does not come back' unit_is active
}

# After the package is removed: no login needs a file that is gone.
pam_is_gone() {
    if inside grep -rq isotherm /etc/pam.d /var/lib/pam; then
        die "removing libpam-isotherm leaves it in PAM: $(inside grep -r isotherm /etc/pam.d /var/lib/pam)"
    fi
    say 'PAM is as before when libpam-isotherm is removed'
}
