# Follows a machine that is started, and kills it at a moment: `. tests/image/watch.sh`, after machine.sh. Plain sh.

# ticks PID: prints the processor time of a process in hundredths of a second; nothing if it has ended
ticks() {
    awk '{ print $14 + $15 }' "/proc/$1/stat" 2>/dev/null || true
}

# watch NAME WORDS LIMIT: kills the machine NAME when it has used LIMIT hundredths of a second of processor time since its log said WORDS, and
# then makes the file NAME.cut
watch() {
    until pid=$(cat "$machine_out/$1.pid" 2>/dev/null) && [ -n "$pid" ]; do
        [ ! -e "$machine_out/$1.ended" ] || return 0
        sleep 0.1
    done
    until grep -q "$2" "$machine_out/$1.log" 2>/dev/null; do
        [ -n "$(ticks "$pid")" ] || return 0
        sleep 0.1
    done
    begin=$(ticks "$pid")
    while now=$(ticks "$pid") && [ -n "$now" ]; do
        if [ $((now - begin)) -ge "$3" ]; then
            ! kill -9 "$pid" || : >"$machine_out/$1.cut"
            return 0
        fi
        sleep 0.05
    done
}

# watched_start NAME PHASE DISK WORDS LIMIT: machine_start, with `watch`
watched_start() {
    rm -f "$machine_out/$1.pid" "$machine_out/$1.log" "$machine_out/$1.cut" "$machine_out/$1.ended"
    watch "$1" "$4" "$5" &
    watching=$!
    watched_code=0
    machine_start "$1" "$2" "$3" 2>/dev/null || watched_code=$? # the shell would say that a process was killed; NAME.qemu has errors
    : >"$machine_out/$1.ended"
    wait $watching
    return $watched_code
}
