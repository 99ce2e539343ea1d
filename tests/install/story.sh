# Checks of an installed appliance in a booted container or machine: `. tests/install/story.sh`, after the functions `inside` and
# `inside_as` (tests/install/container.sh) and `say`, `die`, `wait_for`. The stored recordings are in /srv/stored, and the program
# `intrude` is in /srv. Plain sh. The user ada is in the group isotherm, and eve is in none of the groups.

isotherm() {
    inside_as ada isotherm "$@"
}

unit_is() {
    [ "$(inside systemctl is-active isothermd)" = "$1" ]
}

daemon_pid() {
    inside systemctl show --property MainPID --value isothermd
}

log_records() {
    isotherm log --count 100000 --json
}

# count_logged PERSON VERDICT: prints how many visits ended with them; "" is an unknown person.
count_logged() {
    log_records | tr -d ' \n' | { grep -o "\"person\":\"$1\",\"verdict\":\"$2\"" || true; } | wc -l
}

has_denied_more_than() {
    [ "$(log_records | tr -d ' \n' | { grep -o '"verdict":"deny"' || true; } | wc -l)" -gt "$1" ]
}

count_denied() {
    log_records | tr -d ' \n' | { grep -o '"verdict":"deny"' || true; } | wc -l
}

has_let_in_more_than() {
    [ "$(count_logged p01 allow)" -gt "$1" ]
}

# ---- the visitor before the camera ----

somebody_comes() {
    inside ln -s "/srv/stored/$1" /srv/slot.next
    inside mv -T /srv/slot.next /srv/slot
}

nobody_is_there() {
    inside rm -f /srv/slot
    sleep 1
}

# ---- the checks ----

add_users() {
    inside useradd --create-home --groups isotherm ada
    inside useradd --create-home eve
}

others_are_refused() {
    if inside_as eve isotherm status >/dev/null 2>&1; then
        die 'an account outside the groups may ask for the state'
    fi
    inside_as eve isotherm status 2>&1 | grep -q 'not permitted' || die 'the refusal does not say that it is not permitted'
    say 'an account outside the groups is refused'
}

p01_is_enrolled() {
    nobody_is_there
    isotherm enroll p01 --quick --timeout 60 >"$story_scratch/enroll" 2>&1 &
    story_enroll=$!
    wait_for 10 'the enrolment does not begin' grep -q . "$story_scratch/enroll"
    somebody_comes p01-enrol
    wait $story_enroll || die "p01 is not enrolled: $(cat "$story_scratch/enroll")"
    nobody_is_there
    isotherm list | grep -q '^p01 ' || die 'p01 is not in the list'
    say 'ada, who is in the group isotherm, has enrolled p01'
}

p01_is_let_in() {
    story_allowed=$(count_logged p01 allow)
    somebody_comes p01-v1
    wait_for 20 'p01 is not let in' has_let_in_more_than "$story_allowed"
    nobody_is_there
    say 'p01 is let in'
}

a_stranger_is_refused() {
    story_allowed=$(log_records | grep -c '"allow"' || true) story_denied=$(count_denied)
    somebody_comes x01-v1
    wait_for 20 'no verdict about a stranger' has_denied_more_than "$story_denied"
    nobody_is_there
    [ "$(log_records | grep -c '"allow"' || true)" = "$story_allowed" ] || die 'a stranger is let in'
    say 'a stranger is refused'
}

is_locked_out() {
    [ "$(isotherm status --json | sed -n 's/.*"lockout-ms": *\([0-9]*\).*/\1/p')" -gt 0 ]
}

# Notes the state that a restart must keep: the people, the records up to now, the lock-out.
remember_state() {
    isotherm list >"$story_scratch/people"
    isotherm log --count 100000 >"$story_scratch/log"
}

# state_is_kept WHAT
state_is_kept() {
    isotherm list | cmp -s - "$story_scratch/people" || die "$1: other people"
    isotherm log --count 100000 >"$story_scratch/log.now"
    sed "$(wc -l <"$story_scratch/log")q" "$story_scratch/log.now" | cmp -s - "$story_scratch/log" || die "$1: other records"
    isotherm log verify >/dev/null || die "$1: the log is not sound"
    is_locked_out || die "$1: the lock-out is forgotten"
    say "$1 keeps people, log and lock-out"
}

journal_tells() {
    inside journalctl --no-pager --unit isothermd >"$story_scratch/journal"
    for story_word in "$@"; do
        grep -q -- "$story_word" "$story_scratch/journal" || {
            cat "$story_scratch/journal"
            die "the journal does not contain: $story_word"
        }
    done
    say 'the journal tells what happened'
}

# ---- confinement ----

# attempt WHAT...: makes the daemon execute a system call, as an attacker could who has taken it over, and prints the result
attempt() {
    inside /srv/intrude "$(daemon_pid)" "$@"
}

# ends WORD WHAT...: fails unless the attempt has this result
ends() {
    story_expected=$1
    shift
    story_end=$(attempt "$@")
    [ "$story_end" = "$story_expected" ] || die "'$*' by the daemon ends with '$story_end', not $story_expected"
}

calls_are_filtered() {
    inside grep -q '^Seccomp:.*2$' "/proc/$(daemon_pid)/status" || die 'no filter of system calls is in force'
    ends done create /var/lib/isotherm/probe # the daemon may do this
    inside rm /var/lib/isotherm/probe
    ends EPERM internet
    story_pid=$(daemon_pid)
    ends killed execute /bin/true
    wait_for 10 'the unit does not come back' unit_is active
    [ "$(daemon_pid)" != "$story_pid" ] || die 'a daemon that executes a program is not killed'
    say 'the filter of system calls works: it refuses an internet socket, and kills a daemon that executes a program, which is then restarted'
}

# Every user may write to /srv/open, and the unit permits it to the daemon: only Landlock forbids it. Needs the drop-in of leave_open.
files_are_restricted() {
    ends done create /var/lib/isotherm/probe
    inside rm /var/lib/isotherm/probe
    if inside journalctl --no-pager --unit isothermd | grep -q 'the kernel has no Landlock'; then
        say 'skipped: this kernel has no Landlock; the journal says so'
        return
    fi
    ends EACCES create /srv/open/probe
    say 'Landlock works: the daemon cannot write outside its folders, not even where every user may'
}

leave_open() {
    inside install -d -m 0777 /srv/open
    inside install -d /etc/systemd/system/isothermd.service.d
    printf '[Service]\nReadWritePaths=/srv/open\n' | inside tee /etc/systemd/system/isothermd.service.d/test.conf >/dev/null
    inside systemctl daemon-reload
    inside systemctl restart isothermd
    wait_for 10 'the unit does not come back' unit_is active
}

# exposure MOST UNIT
exposure() {
    story_level=$(inside systemd-analyze security --no-pager "$2" | sed -n 's/.*Overall exposure level[^:]*: \([0-9.]*\) .*/\1/p')
    awk -v level="$story_level" -v most="$1" 'BEGIN { exit !(level != "" && level + 0 <= most) }' ||
        die "systemd-analyze security $2: '$story_level', at most $1 is allowed"
    say "systemd-analyze security $2: exposure $story_level (at most $1)"
}

# thread_policy NAME: prints priority and policy of a thread of the daemon; "20 1" is SCHED_FIFO with priority 20, "0 0" is an ordinary
# thread
thread_policy() {
    inside sh -c "cat /proc/$(daemon_pid)/task/*/stat" | awk -v name="($1)" '$2 == name { print $40, $41 }'
}

# has_policy NAME POLICY
has_policy() {
    story_policy=$(thread_policy "$1")
    [ "$story_policy" = "$2" ] || die "the thread $1 has priority and policy '$story_policy', not '$2'"
}

doctor_misses_priority() {
    isotherm doctor 2>/dev/null | grep -q 'door thread *no real-time priority'
}

# The machine around a container may forbid to raise limits; systemd then sets the highest limit that is permitted. The daemon must report
# this. For the other checks the unit gets a capability that replaces the limit.
replace_priority_limit() {
    has_policy isothermd-door '0 0'
    doctor_misses_priority || die 'isotherm doctor does not report that the thread of the door has no real-time priority'
    inside journalctl --no-pager --unit isothermd | grep -q 'the thread of the door has no real-time priority' ||
        die 'the journal does not report that the thread of the door has no real-time priority'
    say 'skipped: LimitRTPRIO=, which this container may not have; journal and doctor report it'
    inside install -d /etc/systemd/system/isothermd.service.d
    printf '[Service]\nCapabilityBoundingSet=CAP_SYS_NICE\nAmbientCapabilities=CAP_SYS_NICE\n' |
        inside tee /etc/systemd/system/isothermd.service.d/priority.conf >/dev/null
    inside systemctl daemon-reload
    inside systemctl restart isothermd
}

the_door_is_real_time() {
    inside systemd-run --quiet --wait --property User=nobody --property LimitRTPRIO=20 chrt --fifo 20 true 2>/dev/null || replace_priority_limit
    has_policy isothermd-door '20 1'
    has_policy isothermd '0 0'
    has_policy isothermd-log '0 0'
    has_policy isothermd-jrnl '0 0'
    ends EPERM realtime
    has_policy isothermd '0 0'
    if doctor_misses_priority; then
        die 'isotherm doctor says that the thread of the door has no real-time priority'
    fi
    say 'the thread of the door has a real-time priority (SCHED_FIFO, 20); the other threads have none and cannot get one'
    if inside rm /etc/systemd/system/isothermd.service.d/priority.conf 2>/dev/null; then
        inside systemctl daemon-reload
        inside systemctl restart isothermd
    fi
}

restarts() {
    inside systemctl show --property NRestarts --value isothermd
}

answers() {
    isotherm status >/dev/null 2>&1
}

# The disk takes 1.5 s for an fsync. The unit allows 6 s for a start, and 6 s between two signals to the watchdog. A start and a rotation of
# keys take longer, because they make many fsyncs.
a_slow_disk_is_waited_for() {
    inside install -d /etc/systemd/system/isothermd.service.d
    printf '[Service]\nTimeoutStartSec=6\nWatchdogSec=6\nEnvironment=LD_PRELOAD=/srv/slow_sync.so SLOW_SYNC_MS=1500\n' |
        inside tee /etc/systemd/system/isothermd.service.d/slow.conf >/dev/null
    inside systemctl daemon-reload
    inside systemctl reset-failed isothermd
    story_restarts=$(restarts)
    story_began=$(date +%s)
    inside systemctl restart isothermd || die 'a start on a slow disk fails'
    story_start=$(($(date +%s) - story_began))
    story_pid=$(daemon_pid)
    story_began=$(date +%s)
    isotherm key rotate >/dev/null 2>&1 || true # the client may stop waiting before the daemon is done
    wait_for 60 'the daemon does not answer after a rotation of the keys on a slow disk' answers
    story_rotation=$(($(date +%s) - story_began))
    [ "$(daemon_pid)" = "$story_pid" ] && [ "$(restarts)" = "$story_restarts" ] || die 'the daemon was restarted because of a slow disk'
    [ "$story_start" -gt 6 ] && [ "$story_rotation" -gt 6 ] || die "too quick to show anything: $story_start s, $story_rotation s"
    inside rm /etc/systemd/system/isothermd.service.d/slow.conf
    inside systemctl daemon-reload
    inside systemctl restart isothermd
    say "a slow disk does not end the daemon: a start took $story_start s and a rotation of keys $story_rotation s, where 6 s are allowed"
}

# active_within SECONDS: the unit belongs to multi-user.target; it is active before the target, or at most SECONDS later.
active_within() {
    story_unit_us=$(inside systemctl show --property ActiveEnterTimestampMonotonic --value isothermd)
    story_target_us=$(inside systemctl show --property ActiveEnterTimestampMonotonic --value multi-user.target)
    story_began_us=$(inside systemctl show --property InactiveExitTimestampMonotonic --value isothermd)
    unit_is active || die "the unit is $(inside systemctl is-active isothermd) after the boot"
    [ "$story_unit_us" -le $((story_target_us + $1 * 1000000)) ] || die "the unit is active $(((story_unit_us - story_target_us) / 1000)) ms after multi-user"
    say "the unit is active: $(((story_unit_us - story_began_us) / 1000)) ms after its start"
}
