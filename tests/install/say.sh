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

# quiet WHAT COMMAND...: shows the output of COMMAND only if it fails
quiet() {
    quiet_what=$1
    shift
    "$@" >"$story_scratch/output" 2>&1 || {
        tail -n 20 "$story_scratch/output" >&2
        die "$quiet_what"
    }
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
