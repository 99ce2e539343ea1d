# Checks of the installed web server in a booted container: `. tests/install/web_story.sh`, after story.sh and say.sh. Plain sh. Its client
# is a program of this machine in the network of the container, because the container has neither curl nor Python.

web_print='' web_ada='{"account":"ada","password":"a door of iron"}'

# web SESSION METHOD PATH [JSON]: sends a request with the session of this name, and prints status and body
web() {
    story_session=$1
    shift
    nsenter --target "$(container_leader)" --net "$source_dir/tests/install/web_client.py" "$web_print" "$story_scratch/web.$story_session" "$@"
}

# web_ends STATUS SESSION METHOD PATH [JSON]: fails unless the answer has this status. The answer is in $story_answer.
web_ends() {
    story_expected=$1
    shift
    story_answer=$(web "$@") || die "the web server does not answer '$3': $story_answer"
    [ "$(echo "$story_answer" | head -n 1)" = "$story_expected" ] || die "'$2 $3' by $1 ends with '$story_answer', not $story_expected"
}

# web_says WORD: fails unless the last answer contains the word
web_says() {
    case $story_answer in *"$1"*) ;; *) die "the web server says '$story_answer', without $1" ;; esac
}

web_unit_is() {
    [ "$(inside systemctl is-active "isotherm-web.$1")" = "$2" ]
}

web_pid() {
    inside systemctl show --property MainPID --value isotherm-web.service
}

web_listens() {
    wait_for 10 'the socket of the web server is not active' web_unit_is socket active
    wait_for 10 'the web server is not active' web_unit_is service active
    web_print=$(inside isotherm web fingerprint) || die 'isotherm web fingerprint fails'
    [ "$(inside_as eve cat /run/isotherm-web/fingerprint)" = "$web_print" ] || die 'the fingerprint for the screen is missing or differs'
    web_ends 401 nobody GET /session
    web_says '"setup"'
    say 'the web server listens, with a certificate of its own'
}

web_makes_an_account() {
    if inside_as ada isotherm web setup >"$story_scratch/web.setup" 2>&1; then
        die 'a user who is not root gets a code'
    fi
    grep -q 'only root may' "$story_scratch/web.setup" || die "the refusal does not say why: $(cat "$story_scratch/web.setup")"
    inside isotherm web setup --json >"$story_scratch/web.setup" || die 'isotherm web setup fails'
    grep -q '"https://[^"]*:8443/"' "$story_scratch/web.setup" || die 'isotherm web setup prints no address'
    story_code=$(sed -n 's/.*"code": *"\([^"]*\)".*/\1/p' "$story_scratch/web.setup")
    web_ends 201 ada POST /setup "{\"code\":\"$story_code\",\"account\":\"ada\",\"password\":\"a door of iron\"}"
    web_ends 401 nobody POST /setup "{\"code\":\"$story_code\",\"account\":\"eve\",\"password\":\"a door of iron\"}"
    say 'isotherm web setup makes a code, with which one account is made, once'
}

web_asks_the_daemon() {
    web_ends 200 ada GET /status
    web_says '"daemon"'
    web_ends 200 ada GET /people
    web_says '"p01"'
    web_ends 200 ada GET /log
    say 'the web server has its rights on the bus: it reads state, people and log'
}

web_checks_roles() {
    web_ends 201 ada POST /accounts '{"name":"olga","password":"a gate of oak","role":"observer"}'
    isotherm log --event act | grep -q ada || die 'the log does not tell which account added another one'
    web_ends 401 olga POST /session '{"account":"olga","password":"a gate of ash"}'
    web_ends 201 olga POST /session '{"account":"olga","password":"a gate of oak"}'
    web_ends 200 olga GET /status
    web_ends 403 olga GET /people
    web_ends 403 olga GET /log
    web_ends 403 olga POST /accounts '{"name":"otto","password":"a gate of oak","role":"administrator"}'
    story_answer=$(ORIGIN=https://elsewhere.example web ada POST /accounts '{"name":"otto","password":"a gate of oak","role":"observer"}')
    [ "$(echo "$story_answer" | head -n 1)" = 403 ] || die "a request of another origin ends with '$story_answer'"
    say 'the web server refuses what a role may not do, and requests of other origins; acts are on record with the account'
}

# web_attempt WORD WHAT...: makes the web server execute a system call (intrude.c); fails unless it has this result
web_attempt() {
    story_expected=$1
    shift
    story_end=$(inside /srv/intrude "$(web_pid)" "$@")
    [ "$story_end" = "$story_expected" ] || die "'$*' by the web server ends with '$story_end', not $story_expected"
}

web_is_confined() {
    exposure 0.6 isotherm-web.service
    inside install -d -m 0777 /srv/open
    web_attempt done create /var/lib/isotherm-web/probe # the web server may do this
    inside rm /var/lib/isotherm-web/probe
    web_attempt EROFS create /srv/open/probe
    web_attempt EACCES read /var/lib/isotherm/gallery.db
    web_attempt EAFNOSUPPORT internet
    web_attempt EPERM realtime
    say 'the web server is confined: it writes its own state only, reads no templates, and opens no socket of the internet'
}

web_keeps_its_state() {
    inside systemctl restart isotherm-web.service
    web_ends 401 ada GET /people # sessions end with the server
    web_ends 201 ada POST /session "$web_ada"
    web_ends 200 ada GET /accounts
    web_says '"olga"'
    inside systemctl stop isotherm-web.service
    web_unit_is socket active || die 'the socket does not stay'
    web_ends 201 ada POST /session "$web_ada"
    web_unit_is service active || die 'a connection does not start the web server'
    say 'the web server keeps accounts and certificate over a restart, and a connection starts it'
}

web_works() {
    web_listens
    web_makes_an_account
    web_asks_the_daemon
    web_checks_roles
    web_is_confined
    web_keeps_its_state
}

# After an upgrade or a reboot: the server runs again, with the same certificate and accounts.
web_is_back() {
    wait_for 10 'the web server does not come back' web_unit_is service active
    web_ends 201 ada POST /session "$web_ada"
    say "the web server is back after $1"
}

web_is_gone() {
    if nsenter --target "$(container_leader)" --net python3 -c 'import socket; socket.create_connection(("127.0.0.1", 8443), 5)' 2>/dev/null; then
        die 'the port of the web server is open, though the server is not installed'
    fi
    say 'nothing listens at the port of the web server'
}
