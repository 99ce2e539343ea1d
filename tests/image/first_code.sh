#!/bin/sh
# Tests that an image of the appliance gets a code for the first account of the web server, and after a factory reset another one: isotherm-web
# with the option of the image's unit, and isothermd --factory-reset, on a scratch folder.
#
#   first_code.sh SOURCE BUILD      ends with 77 if there is no curl
set -eu
source_dir=$1 build=$2
command -v curl >/dev/null || exit 77
root=$(mktemp -d)
web_pid=''
mkdir -m 0700 "$root/web" "$root/run" "$root/run/isotherm-web" "$root/story"
story_directory=$root/story story_source=$source_dir
. "$source_dir/tests/support/door_story.sh"

# shellcheck disable=SC2317 # called by the trap
clean_up() {
    [ -z "$web_pid" ] || { kill "$web_pid" && wait "$web_pid"; } 2>/dev/null || true
    rm -rf "$root"
}
trap clean_up EXIT

die() {
    echo "FAILED: $1"
    cat "$root/web.log" "$root/said" 2>/dev/null || true
    exit 1
}

# The options are those of the image.
options=$(sed -n 's/^Environment=ISOTHERM_WEB_OPTIONS=//p' "$source_dir/board/image/units/isotherm-web.service.d/image.conf")
port=$(python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])')

start_web() {
    # shellcheck disable=SC2086 # a list of options
    RUNTIME_DIRECTORY=$root/run/isotherm-web "$build/enroll/web/isotherm-web" --state "$root/web" --bus "unix:path=$root/none" --pages "$source_dir/enroll/web/pages" \
        --updates "$root/none" --listen "127.0.0.1:$port" $options 2>"$root/web.log" &
    web_pid=$!
    waits_for 'the web server shows no code' test -s "$root/run/isotherm-web/setup-code"
}

# make_account CODE: prints the status of the answer
make_account() {
    curl --silent --insecure --output "$root/said" --write-out '%{http_code}' --header "Origin: https://127.0.0.1:$port" \
        --header 'Content-Type: application/json' --data "{\"code\":\"$1\",\"account\":\"ada\",\"password\":\"a long enough password\"}" \
        "https://127.0.0.1:$port/api/v1/setup"
}

start_web
first=$(cat "$root/run/isotherm-web/setup-code")
grep -q "the code for the first account, valid until an hour after the start: $first\$" "$root/web.log" || die 'the code is not in the journal'
[ "$(ISOTHERM_ROOT=$root "$source_dir/board/image/programs/tell-code")" = "tell-code: the code for the first account, valid until an hour after the start: $first" ] ||
    die 'the console does not show the code'
[ "$(stat -c %a "$root/run/isotherm-web/setup-code")" = 640 ] || die 'others can read the code'
[ "$(make_account "$first")" = 201 ] || die 'the code makes no account'
waits_for 'the code is shown although there is an account' test ! -e "$root/run/isotherm-web/setup-code"
[ -z "$(ISOTHERM_ROOT=$root "$source_dir/board/image/programs/tell-code")" ] || die 'the console shows a code that has gone'

{
    printf '[sensor]\nbackend = replay\npath = %s/slot\n' "$root"
    stores_conf
    printf '[reset]\nweb = %s/web\nlink = %s/link\ncredential = %s/key\n' "$root" "$root" "$root"
} >"$root/isotherm.conf"
"$build/firmware/isothermd" --config "$root/isotherm.conf" --factory-reset >"$root/said" 2>&1 || die 'the factory reset fails'
[ ! -e "$root/web/accounts.json" ] || die 'the factory reset leaves the accounts'
code=0
wait "$web_pid" || code=$?
web_pid=''
[ $code -eq 4 ] || die "the web server ends with $code after the reset, not with 4, after which systemd starts it anew"

start_web
second=$(cat "$root/run/isotherm-web/setup-code")
[ "$second" != "$first" ] || die 'the code is the same after the reset'
[ "$(make_account "$first")" = 401 ] || die 'the first code is taken again'
[ "$(make_account "$second")" = 201 ] || die 'the second code makes no account'
echo '    the code for the first account: at the first start, and after a factory reset'
