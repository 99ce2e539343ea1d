# The setup of a door without a configuration, at monitor and keyboard: `. tests/image/inside_setup.sh`, in inside.sh. Plain sh. The host
# follows the lines "keys:" and "picture:" of this machine (type_keys.py).

# types KEY...: the names of QEMU, at the first virtual console
types() {
    echo "keys: $*"
}

# The text of the first virtual console, which is in one line.
monitor_shows() {
    tr -d '\0' </dev/vcs1 | grep -q "$1"
}

# waits_for_words WORDS: on the monitor
waits_for_words() {
    wait_for 60 "the monitor does not show: $1" monitor_shows "$1"
}

# The answers of somebody who has no camera yet, up to the last question.
answers() {
    waits_for_words 'This door has no configuration yet'
    types ret
    waits_for_words 'No depth camera was found'
    types 1 ret
    waits_for_words 'Folder of the recording'
    types slash s r v slash s l o t ret
    waits_for_words 'Write it and start the service?'
}

setup_was_ended() {
    [ "$(systemctl show --property NRestarts --value isotherm-setup)" -ge 1 ] && monitor_shows 'This door has no configuration yet'
}

asked() {
    rest_inputs
    ln -s "$VM_SOURCE/sim/stored" /srv/stored
    nobody_is_there
    answers
    types ctrl-c
    wait_for 60 'after Ctrl-C it does not begin again' setup_was_ended
    [ ! -e /etc/isotherm/isotherm.conf ] || die 'Ctrl-C leaves a configuration'
    say 'Ctrl-C at the last question: no configuration, and it begins again'
    answers
    echo 'picture: question'
    types ret
    waits_for_words 'For the screen for visitors, press Enter'
    echo 'picture: result'
    unit_is active || die 'the daemon does not run after the setup'
    grep -qx 'path = /srv/slot' /etc/isotherm/isotherm.conf || die "the configuration has not what was typed: $(cat /etc/isotherm/isotherm.conf)"
    door_is locked || die 'the daemon does not hold the lines of the board'
    monitor_shows "$(cat /run/isotherm-web/setup-code)" || die 'the monitor does not show the code for the first account'
    monitor_shows ':8443/' || die 'the monitor does not show the address of the web server'
    [ -z "$(find /run/isotherm-setup -name '*.png' 2>/dev/null)" ] || die 'the picture of the camera is left'
    say 'typed: the configuration, and the daemon runs; the monitor shows where the first account is made'
    types ret
    wait_for 60 'the screen for visitors does not start' screen_runs
    sleep 10 # it fades in
    echo 'picture: visitors'
    sleep 2
    wait_for 60 'the setup does not end' setup_has_ended
    systemctl start isotherm-setup
    setup_has_ended || die 'a door with a configuration asks for one'
    wait_for 60 'the machine does not settle' settled
    nothing_else_runs
    say 'the screen for visitors runs, and nobody is asked again'
}

screen_runs() {
    [ "$(systemctl is-active isotherm-screen)" = active ]
}

setup_has_ended() {
    [ "$(systemctl is-active isotherm-setup)" = inactive ]
}
