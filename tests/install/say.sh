# For scripts of tests in a container: `. tests/install/say.sh`, after container.sh and with story_scratch set. Functions that print
# results and end a failed test, and the removal of all temporary files.

say() {
    printf '%5d s  %s\n' $(($(date +%s) - began)) "$1"
}

die() {
    echo "FAILED: $1" >&2
    [ -z "$container_nspawn" ] || {
        inside systemctl --no-pager --full status isothermd || true
        inside journalctl --no-pager --unit isothermd | tail -n 20 || true
        inside journalctl --no-pager --unit isotherm-web.service | tail -n 20 || true
    } >&2
    exit 1
}

finish() {
    status=$?
    trap - EXIT
    container_remove
    rm -rf "$story_scratch"
    exit $status
}
trap finish EXIT
trap 'exit 130' INT TERM
began=$(date +%s)
