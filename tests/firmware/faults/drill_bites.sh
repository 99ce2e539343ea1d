#!/bin/bash
# Shows that the tests of faults find mistakes. The script builds each of these mistakes into a copy of the tree, and one of the
# commands that are named for the mistake has to fail. Some mistakes change two places, because a second defence covers the first one.
# The script takes half an hour on two idle cores.
# usage: drill_bites.sh BUILD [--patterns] [PATTERN]
#        BUILD: a build of the preset dev; PATTERN: a regular expression that selects mistakes, such as "rule 3: stale".
#        --patterns: builds nothing and takes seconds. It only checks that each mistake can be built in: its text is in its file
#        exactly once, and BUILD knows the programs of the commands that are named for it (gate_mistakes of ctest).
#        DRILL_LONGEST_S in the environment: a command that takes more seconds is ended and counts as failed. The same holds for a
#        command that takes longer than half a minute plus ten times its time without a mistake.
#
# Each line has the mistake, the command that found it, and the output of that command. The last line counts the mistakes by rule:
#   1  after an error of COMMIT, or of an exchange of files, the state is read again from the disk
#   2  relay, exit button, contact and tamper switch never wait; a grant waits 250 ms for its record, then the answer is DENY
#   3  the age of a grant's frames is checked when the lock is switched
#   4  frames that repeat a frame of the last ten minutes do not count
#   5  files of an earlier time, in any mixture, are refused
#   6  all other mistakes that the plans of faults (make drill) have to find
set -euo pipefail
root=$(cd "$(dirname "$0")/../../.." && pwd)
build=$(cd "$1" && pwd)
patterns_only=''
if [ "${2:-}" = --patterns ]; then
    patterns_only=yes
    shift
fi
only=${2:-}
copy=$(mktemp -d "${TMPDIR:-/var/tmp}/drill-bites.XXXXXX")
trap 'rm -rf "$copy"' EXIT
tried=0 missed=0 outdated=0
rule=0
declare -A of_rule found_of_rule
judges=() # commands, of which one has to fail; run from tests/firmware of the build
longest_s=${DRILL_LONGEST_S:-90}
limit_s=$longest_s # of the command that runs
memory=/dev/shm # for the files of the tests: no mistake needs a slow disk to be found
[ -w "$memory" ] || memory=$copy

if [ "$patterns_only" ]; then
    sed -n 's|.*/\([^/]*\)\.dir$|\1|p' "$build/CMakeFiles/TargetDirectories.txt" >"$copy/programs"
else
    tar -C "$root" --exclude=./build --exclude=./out --exclude=./.git -cf - . | tar -C "$copy" -xf -
    cmake -S "$copy" -B "$copy/build/dev" -G Ninja -DCMAKE_BUILD_TYPE=RelWithDebInfo \
        -DCMAKE_C_COMPILER="$(sed -n 's/^CMAKE_C_COMPILER:[^=]*=//p' "$build/CMakeCache.txt")" >"$copy/log" 2>&1 || {
        cat "$copy/log" >&2
        exit 1
    }
fi

compile() {
    local targets=() judge
    for judge in "${judges[@]}"; do
        judge=${judge%% *}
        targets+=("${judge##*/}")
    done
    cmake --build "$copy/build/dev" --target "${targets[@]}" >"$copy/log" 2>&1
}

# Prints the line in which a failed command reports its failure: the oracle's line, else the first that cmocka marks, else the last.
word_of() {
    if [ "$1" -eq 124 ]; then
        echo "hangs for $limit_s s"
        return
    fi
    grep -a -m 1 -E '\(seed [0-9]+, step|, call [0-9]+ ' "$copy/said" || grep -a -m 1 -E '\[  FAILED  \] [^0-9]|ERROR' "$copy/said" ||
        tail -n 1 "$copy/said"
}

# Runs a judge. A judge that has reported a failed case is ended, because it may wait for something that the failed case has left.
run_judge() {
    local words judge_pid
    read -ra words <<<"$1"
    : >"$copy/said" # removes the output of the previous judge
    (cd "$copy/build/dev/tests/firmware" && TMPDIR=$memory exec timeout -k 5 "$limit_s" "./${words[0]}" "${words[@]:1}") >>"$copy/said" 2>&1 &
    judge_pid=$!
    while [ "$(jobs -rp)" ]; do
        if grep -a -q -E '^\[  FAILED  \] ' "$copy/said"; then
            kill %% 2>/dev/null || true
            break
        fi
        sleep 0.1
    done
    wait "$judge_pid"
}

# Runs the judges until one fails, and sets $judge and $status to that judge and its exit status. Returns false if none fails.
find_it() {
    for judge in "${judges[@]}"; do
        limit_s=$longest_s
        if [ "${sound_s[$judge]:-}" ]; then
            limit_s=$((30 + 10 * sound_s[$judge]))
            limit_s=$((limit_s < longest_s ? limit_s : longest_s))
        fi
        status=0
        run_judge "$judge" || status=$?
        [ "$status" -eq 0 ] || return 0
    done
    return 1
}

# Checks that the judges find nothing without a mistake. Each judge runs once.
declare -A sound_s # how long it takes
check_judges() {
    local wanted=("${judges[@]}") one begin_s
    for one in "${wanted[@]}"; do
        [ -z "${sound_s[$one]:-}" ] || continue
        judges=("$one")
        if ! compile; then
            tail -n 20 "$copy/log" >&2
            exit 1
        fi
        begin_s=$SECONDS
        if find_it; then
            cat "$copy/said" >&2
            echo "drill_bites: without a mistake, $one: fails" >&2
            exit 1
        fi
        sound_s[$one]=$((SECONDS - begin_s))
    done
    judges=("${wanted[@]}")
}

# Keeps the file without the mistake next to the copy, because the tree may change meanwhile. Prints a fault if there is no such file.
keep() {
    if [ ! -e "$root/$1" ]; then
        echo "there is no $1"
        return
    fi
    mkdir -p "$copy/$(dirname "$1")" "$copy/kept/$(dirname "$1")"
    [ -e "$copy/$1" ] || cp "$root/$1" "$copy/$1"
    [ -e "$copy/kept/$1" ] || cp "$copy/$1" "$copy/kept/$1"
}

# Replaces OLD, which has to be there exactly once, by NEW. Otherwise it prints the fault.
replace() {
    OLD=$2 NEW=$3 perl -0pi -e '
        BEGIN { $n = 0 }
        $n = () = /\Q$ENV{OLD}\E/g;
        s/\Q$ENV{OLD}\E/$ENV{NEW}/;
        END { print STDERR "$n times" if $n != 1 }' "$copy/$1" 2>"$copy/times"
    [ ! -s "$copy/times" ] || echo "$1 has $(cat "$copy/times"): $2"
}

# Prints the judges that the build does not know.
strangers() {
    local judge
    for judge in "${judges[@]}"; do
        judge=${judge%% *}
        grep -qFx "${judge##*/}" "$copy/programs" || echo "no program ${judge##*/}"
    done
}

# Builds the mistake and runs the judges.
try() {
    local name=$1
    if ! compile; then
        outdated=$((outdated + 1))
        printf 'rule %s  %-56s DOES NOT BUILD: %s\n' "$rule" "$name" "$(grep -a -m 1 'error:' "$copy/log" || tail -n 1 "$copy/log")"
    elif find_it; then
        found_of_rule[$rule]=$((${found_of_rule[$rule]:-0} + 1))
        printf 'rule %s  %-56s found by %s: %s\n' "$rule" "$name" "${judge##*/}" "$(word_of "$status")"
    else
        missed=$((missed + 1))
        printf 'rule %s  %-56s NOT FOUND by %s\n' "$rule" "$name" "$(printf '%s; ' "${judges[@]##*/}")"
    fi
}

# mistake NAME FILE OLD NEW [FILE OLD NEW]...: literal text; OLD has to be there exactly once
mistake() {
    local name=$1 files=() file stale=''
    shift
    [[ "rule $rule: $name" =~ $only ]] || return 0
    [ "$patterns_only" ] || check_judges
    tried=$((tried + 1))
    of_rule[$rule]=$((${of_rule[$rule]:-0} + 1))
    while [ $# -gt 0 ]; do
        stale+=$(keep "$1")
        if [ -e "$copy/kept/$1" ]; then
            files+=("$1")
            stale+=$(replace "$1" "$2" "$3")
        fi
        shift 3
    done
    [ -z "$patterns_only" ] || stale+=$(strangers)
    if [ -n "$stale" ]; then
        outdated=$((outdated + 1))
        printf 'rule %s  %-56s OUTDATED: %s\n' "$rule" "$name" "$stale"
    elif [ -z "$patterns_only" ]; then
        try "$name"
    fi
    for file in "${files[@]}"; do
        cp "$copy/kept/$file" "$copy/$file"
    done
}

# ---- 1: the state is read again from the disk ----
rule=1
judges=('storage_faults 3 remove')
mistake 'commit: an error always means not done' firmware/gallery/gallery_db.c \
    'error = error ? iso__gallery_settle(db, error, fault) : 0;' 'db->draft = error ? db->head : db->draft;'
mistake 'commit: an error is taken for a success' firmware/gallery/gallery_db.c \
    'error = error ? iso__gallery_settle(db, error, fault) : 0;' 'error = 0;'
mistake 'commit: a change that is done is reported as not done' firmware/gallery/gallery_truth.c \
    'if (is_same(&db->head, &after)) {' 'if (is_same(&db->head, &after) && is_same(&db->head, &before)) {'
mistake 'commit: a change that is not done is reported as done' firmware/gallery/gallery_truth.c \
    'if (is_same(&db->head, &after)) {' 'if (is_same(&db->head, &after) || is_same(&db->head, &before)) {'
mistake 'commit: the old connection is asked' firmware/gallery/gallery_truth.c \
    'iso__gallery_disconnect(db);
    int error = iso__gallery_connect(db, db->path, fault);' 'int error = 0;'
mistake 'commit: the head is not read again' firmware/gallery/gallery_truth.c \
    'error = iso__gallery_read_head(db, fault);' 'error = 0;'
judges=('storage_faults 3 enrol')
mistake 'commit: an error of an enrolment is swallowed' firmware/gallery/gallery.c \
    'additions, n, fault);
    }
    error = iso_gallery_db_end(gallery->db, error, fault);' 'additions, n, fault);
    }
    error = iso_gallery_db_end(gallery->db, error, fault) ? 0 : error;'
mistake 'commit: a store out of service goes on' firmware/gallery/gallery_truth.c 'db->lost = true;' 'db->lost = false;'
judges=('storage_faults 3 rename' 'storage_faults 1 rename')
mistake 'commit: the directory is not synchronised' firmware/gallery/gallery_truth.c \
    'return iso_directory_sync(db->path, fault);' 'return 0 * fault->text[0];'
judges=('storage_faults 3 log')
mistake 'log: the files are not read again after an exchange' firmware/audit/audit_rotate.c \
    '(void)!iso__audit_recover(audit, NULL);' ';'
mistake 'log: a failed group counts' firmware/audit/audit_append.c 'put_back(audit, before);' '(void)put_back;'
judges=(test_firmware_audit_chain)
mistake 'log: a file that lacks records is taken for the log' firmware/audit/audit_truth.c 'if (!has_all(found, audit)) {' 'if (!has_all(found, audit) && !found) {'
judges=('storage_faults 1 lockdown')
mistake 'lock-out: ended in memory only' firmware/appliance/appliance_refusal.c 'appliance->lockout.state = *before;' '(void)before;'
mistake 'lock-out: the file is not read after an error' firmware/appliance/appliance_refusal.c \
    'if (error && !is_kept(appliance)) {' 'if (error && (!is_kept(appliance) || error)) {' \
    firmware/keys/sealed_file.c \
    'if (error && iso_data_file_holds(path, bytes, size)) {' 'if (error && size_of_nothing(path)) {' \
    firmware/keys/sealed_file.c 'static int replace(' 'static int size_of_nothing(const char *path) { return !path; }
static int replace('

# ---- 2: the door never waits ----
rule=2
judges=(test_firmware_slow_disk)
mistake 'door: it waits for its records' firmware/appliance/appliance_door.c \
    'iso_audit_writer_post(appliance->log, &record, NULL)' \
    'iso_audit_writer_append(appliance->log, &record, ISO_NEVER_NS, NULL, NULL)'
mistake 'door: it waits for the thread of the appliance' firmware/config/door_options.c \
    '.threaded = threaded,' '.threaded = false && threaded,'
mistake 'door: the queue is locked while the disk works' firmware/audit/audit_group.c \
    '(void)pthread_mutex_unlock(&writer->mutex);
    (void)pthread_mutex_lock(&writer->log_mutex);' '(void)pthread_mutex_lock(&writer->log_mutex);' \
    firmware/audit/audit_group.c \
    '(void)pthread_mutex_lock(&writer->mutex);
    writer->last = iso_audit_last(writer->audit);' 'writer->last = iso_audit_last(writer->audit);'
mistake 'grant: it waits for its record without an end' firmware/appliance/appliance_log.c \
    'iso_audit_writer_append(appliance->log, record, wait_ns, NULL, &own);' \
    'iso_audit_writer_append(appliance->log, record, ISO_NEVER_NS, NULL, &own);'
mistake 'grant: the door opens while its record waits' firmware/appliance/verdict/verdict_finish.c \
    'error ? reason_of(error) : open_door(appliance, visit);' \
    'error == -ETIMEDOUT ? open_door(appliance, visit) : error ? reason_of(error) : open_door(appliance, visit);'
mistake 'grant: a full queue lets somebody in' firmware/appliance/verdict/verdict_finish.c \
    'error ? reason_of(error) : open_door(appliance, visit);' \
    'error == -ENOBUFS ? open_door(appliance, visit) : error ? reason_of(error) : open_door(appliance, visit);'
mistake 'door: each edge of a contact that chatters is a record' firmware/door/event_limit.c \
    'limit->passed < ISO_EVENT_LIMIT_BURST' 'limit->passed < 1000000'
judges=(test_firmware_door_guard)
mistake 'door: it waits until its news are taken' firmware/door/door_guard.c \
    'if (guard->n == ISO_DOOR_GUARD_NEWS) {' \
    'while (guard->n == ISO_DOOR_GUARD_NEWS) {
        (void)pthread_mutex_unlock(&guard->mutex);
        poll(NULL, 0, 1);
        (void)pthread_mutex_lock(&guard->mutex);
    }
    if (guard->n == ISO_DOOR_GUARD_NEWS) {'
mistake 'door: no edge wakes it' firmware/door/door_guard.c '{.fd = lines_fd, .events = POLLIN},' '{.fd = lines_fd < 0 ? lines_fd : -1, .events = POLLIN},'
mistake 'door: no time wakes it' firmware/door/door_guard.c '{.fd = guard->timer_fd, .events = POLLIN},' '{.fd = -1, .events = POLLIN},'
judges=(test_firmware_old_verdicts)
mistake 'grant: its record may take 3 s' firmware/appliance/appliance_log.c \
    'wait_ns = ISO_GRANT_WAIT_MS * ISO_NS_PER_MS;' 'wait_ns = 3000 * ISO_NS_PER_MS;'
mistake 'grant: its record may take any time' firmware/appliance/appliance_log.c 'took_ns > wait_ns' 'took_ns < 0'
judges=(test_firmware_audit_writer)
mistake 'log: a grant that was given up is written' firmware/audit/audit_writer.c \
    'slot->cancelled || slot->ticket == ticket;' 'slot->cancelled && slot->ticket == ticket;'
mistake 'log: a late grant has no outcome behind it' firmware/audit/audit_group.c \
    'known ? writer->awaited.sequence : 0;' 'known ? 0 : 0;'
mistake 'log: the number of lost records is not reported' firmware/audit/audit_group.c 'return writer->lost > 0 &&' 'return writer->lost > 1000 &&'
mistake 'log: a poster waits for its record' firmware/audit/audit_writer.c \
    'error = writer->threaded ? 0 : write_now(writer, &own);' \
    'error = writer->threaded ? !wait_for(writer, slot->ticket, ISO_NEVER_NS) : write_now(writer, &own);' \
    firmware/audit/audit_writer.c 'static int post_record(' 'static bool wait_for(struct iso_audit_writer *writer, uint64_t ticket, int64_t wait_ns);
static int post_record('
judges=(test_firmware_audit_priority)
if [ "$patterns_only" ] || chrt -f 1 true 2>/dev/null; then # the test needs the right to real-time priorities
    mistake 'log: a poster waits for the thread that it wakes' firmware/audit/audit_writer.c \
        '(void)sem_post(&writer->work);
    *out = slot;' '(void)pthread_cond_broadcast(&writer->finished_some);
    *out = slot;' firmware/audit/audit_writer.c '(void)pthread_mutex_unlock(&writer->mutex);
    while (sem_wait(&writer->work) && errno == EINTR) {
    }
    while (sem_trywait(&writer->work) == 0) {
    }
    (void)pthread_mutex_lock(&writer->mutex);' '(void)pthread_cond_wait(&writer->finished_some, &writer->mutex);' \
        firmware/audit/audit_writer.c '(void)sem_post(&writer->work);
        iso_disk_wait_begin();' '(void)pthread_cond_broadcast(&writer->finished_some);
        iso_disk_wait_begin();'
elif [[ 'rule 2: log: a poster waits for the thread that it wakes' =~ $only ]]; then
    echo 'rule 2  log: a poster waits for the thread that it wakes    SKIPPED: no right to real-time priorities (chrt)'
fi
judges=('test_firmware_faults 40 500')
mistake 'disk: the door opens without a record' firmware/appliance/verdict/verdict_finish.c \
    'error ? reason_of(error) : open_door(appliance, visit);' 'error ? open_door(appliance, visit) : open_door(appliance, visit);'

# ---- 3: the age of a grant's frames ----
rule=3
judges=(test_firmware_old_verdicts)
mistake 'stale: the age of a grant is not checked' firmware/door/door_guard.c 'if (begin_ns > until_ns) {' 'if (begin_ns < 0) {'
mistake 'stale: the age is not checked after the switching' firmware/door/door_guard.c \
    '!was_unlocked && now_ns(guard) > until_ns' '!was_unlocked && now_ns(guard) < 0'
mistake 'stale: the clock stops while the machine is suspended' firmware/config/door_options.c \
    '.clock = times->boottime.now_ns ? times->boottime : times->monotonic,' '.clock = times->monotonic,'
mistake 'stale: the newest frame counts, not the oldest' firmware/visit/decision.c \
    '*since_ns = decision->frames[i].t_ns;' '*since_ns = t_ns;'
mistake 'stale: counted from the verdict' firmware/appliance/appliance_door.c \
    'const int64_t until_ns = since_ns + appliance->suspension.asleep_ns + stale_ns;' \
    'const int64_t until_ns = iso_times_boot_ns(&appliance->borrowed.times) + stale_ns + 0 * since_ns;'
mistake 'suspended: frames from before count' firmware/appliance/appliance_face.c \
    'frame->t_ns < appliance->suspension.awake_ns' 'frame->t_ns < 0'
mistake 'suspended: a visit goes on' firmware/appliance/appliance.c \
    'if (iso_suspension_look(&appliance->suspension, &appliance->borrowed.times)) {' \
    'if (iso_suspension_look(&appliance->suspension, &appliance->borrowed.times) && 0) {'
mistake 'suspended: the present time asleep is added' firmware/appliance/appliance_door.c \
    'since_ns + appliance->suspension.asleep_ns + stale_ns;' \
    'since_ns + iso_times_boot_ns(&appliance->borrowed.times) - iso_times_now_ns(&appliance->borrowed.times) + stale_ns;'
mistake 'suspended: for less than a minute is not seen' firmware/visit/suspension.c \
    'least_ns = 10 * ISO_NS_PER_MS;' 'least_ns = 60000 * ISO_NS_PER_MS;'
judges=(test_firmware_door_guard)
mistake 'stale: the card of an old grant is sent' firmware/door/door_guard.c \
    'error = now_ns(guard) <= guard->granted_until_ns' 'error = now_ns(guard) <= INT64_MAX'
judges=(test_firmware_slow_disk)
mistake 'stale: a process that was stopped goes on' firmware/appliance/appliance_log.c 'took_ns > wait_ns' 'took_ns < 0' \
    firmware/door/door_guard.c 'if (begin_ns > until_ns) {' 'if (begin_ns < 0) {' \
    firmware/door/door_guard.c '!was_unlocked && now_ns(guard) > until_ns' '!was_unlocked && now_ns(guard) < 0' \
    firmware/audit/audit_writer.c 'pthread_cond_timedwait(&writer->finished_some, &writer->mutex, &until);' \
    'pthread_cond_wait(&writer->finished_some, &writer->mutex);'

# ---- 4: frames that repeat ----
rule=4
judges=(../core/test_presentation_frame_memory)
mistake 'repeats: one frame is remembered' core/presentation/frame_memory.c \
    'memory->n = memory->n < memory->options.capacity ? memory->n + 1 : memory->n;' 'memory->n = 1;'
mistake 'repeats: an offset makes a frame new' core/presentation/frame_memory.c \
    '(z_mm - before_mm) * steps_per_mm' 'z_mm * steps_per_mm'
mistake 'repeats: some pixels make a frame new' core/presentation/frame_memory.h \
    '#define ISO_FINGERPRINT_SAME 0.4' '#define ISO_FINGERPRINT_SAME 0.99'
mistake 'repeats: remembered for one minute' core/presentation/frame_memory.c '.span_ns = INT64_C(600000000000)' '.span_ns = INT64_C(60000000000)'
mistake 'repeats: room for one minute' core/presentation/frame_memory.c '.capacity = 18000' '.capacity = 1800'
mistake 'repeats: a ring of frames is forgotten again' core/presentation/frame_memory.c \
    'struct entry *entry = &memory->entries[memory->next];' 'if (known) { return known; }
    struct entry *entry = &memory->entries[memory->next];'
judges=(test_firmware_repeats)
mistake 'repeats: known frames count at the door' firmware/appliance/appliance_face.c \
    'return !repeats && !is_echo(appliance);' 'return (repeats || !repeats) && !is_echo(appliance);'
mistake 'repeats: known frames count for an enrolment' firmware/appliance/appliance_frame.c \
    'capture = evidence ?' 'capture = evidence || appliance->mode == ISO_APPLIANCE_ENROLL ?'
mistake 'repeats: known frames count for a client' firmware/appliance/appliance_frame.c \
    'capture = evidence ?' 'capture = evidence || appliance->mode == ISO_APPLIANCE_IDENTIFY ?'
mistake 'repeats: frames that were moving are not remembered' firmware/appliance/appliance_frame.c \
    'const bool evidence = iso__appliance_is_evidence(appliance, frame);' \
    'const bool evidence = capture == ISO_CAPTURE_OK && iso__appliance_is_evidence(appliance, frame);'
mistake 'repeats: a camera that starts again has new frames' firmware/appliance/appliance_repeat.c \
    'appliance->repeats.watch = (struct iso_repeat_watch){.stuck = false};
}' 'appliance->repeats.watch = (struct iso_repeat_watch){.stuck = false};
    const struct iso_frame_memory_options anew = iso_frame_memory_options_default();
    iso_frame_memory_free(appliance->repeats.shown);
    (void)!iso_frame_memory_new(&anew, &appliance->repeats.shown);
}'
mistake 'repeats: a stuck camera is not on record' firmware/visit/repeat_watch.c \
    'ISO_REPEATS_TO_STUCK)' 'ISO_REPEATS_TO_STUCK * 1000)'
judges=('test_firmware_faults 40 500')
mistake 'twice, frozen: a frame agrees with itself' firmware/appliance/appliance_face.c \
    'appliance->face.liveness.repeated > 0;' 'appliance->face.liveness.repeated > 1000;'

# ---- 5: files of an earlier time ----
rule=5
judges=(test_firmware_earlier_files)
mistake 'earlier: the stores are not compared' firmware/keys/heads.c \
    'store->found && store->count < claim->known.count[i]' 'store->found && store->count + 1 == 0'
mistake 'earlier: the daemon does not check the heads' firmware/daemon/components_stores.c \
    'const int error = iso_heads_check(iso_key_ring_board(components->ring), fault);' 'const int error = 0;'
mistake 'earlier: a count that is one too low is accepted' firmware/keys/heads.c \
    'store->count < claim->known.count[i]' 'store->count + 1 < claim->known.count[i]'
mistake 'earlier: anchors do not record the other stores' firmware/audit/anchor.c \
    'anchor->known = iso_heads_get(plain + PLAIN_1_BYTES);' ''
mistake 'earlier: the lock-out file records no other store' firmware/visit/lockout_file.c \
    '.known = iso_heads_get(plain + 29),' '.known = {{0}, {0}},'
mistake 'earlier: an old lock-out file is accepted' firmware/visit/lockout_file.c \
    'if (file.number < needed) {' 'if (file.number + 1 == 0) {' \
    firmware/keys/heads.c 'store->found && store->count < claim->known.count[i]' \
    'i != ISO_HEAD_LOCKOUT && store->found && store->count < claim->known.count[i]'
mistake 'earlier: the gallery does not record the other stores' firmware/gallery/gallery_seal.c \
    'out->known = iso_heads_get(plain + ISO_GALLERY_HEAD_1_BYTES);' 'out->known = (struct iso_heads){{0}, {0}};' \
    firmware/audit/anchor.c 'anchor->known = iso_heads_get(plain + PLAIN_1_BYTES);' \
    'if (anchor->kind[0] == 0x6c) { anchor->known = iso_heads_get(plain + PLAIN_1_BYTES); }'
mistake 'earlier: the key ring has no number' firmware/keys/key_ring_file.c \
    'const uint64_t number = ring->number + 1;' 'const uint64_t number = 1;'
mistake 'earlier: another history of the log is accepted' firmware/keys/heads.c \
    'claim->other_link = true;' 'claim->other_link = false;'
mistake 'earlier: closed segments are not counted' firmware/audit/audit_anchor.c 'return found == n ? 0' 'return found < UINT16_MAX ? 0'
judges=(test_firmware_gallery_sealed)
mistake 'earlier: a missing gallery is made anew' firmware/gallery/gallery_make.c \
    'db->anchor && iso_anchor_state(db->anchor)->value > 0' 'db->anchor && iso_anchor_state(db->anchor)->value + 1 == 0'
judges=(test_firmware_audit_group)
mistake 'earlier: an anchor behind a group is accepted' firmware/audit/audit_scan.c 'audit->proved > anchor->value' 'audit->proved > UINT64_MAX - 1'
mistake 'group: an anchor may lack only one record' firmware/audit/audit_scan.c \
    'audit->proved > anchor->value' 'audit->last > anchor->value + 1'
judges=(test_firmware_lockout_unread)
mistake 'lock-out: an unreadable file begins a lockdown' firmware/appliance/appliance_refusal.c 'if (may_pass(error)) {' 'if (may_pass(error) && 0) {'
judges=(test_firmware_refusal)
mistake 'earlier: a missing lock-out file means no lock-out' firmware/visit/lockout_file.c \
    'return needed == 0
' 'return needed + 1 != 0
'
judges=(test_firmware_earlier_files 'kill_stores 60')
mistake 'earlier: a count is known before it is written' firmware/audit/audit_append.c \
    'struct iso_heads known = iso_heads_now(iso_key_ring_board(audit->options.ring));' \
    'struct iso_heads known = iso_heads_now(iso_key_ring_board(audit->options.ring));
        known.count[ISO_HEAD_LOCKOUT]++;'

# ---- 6: the plans of faults ----
rule=6
judges=('test_firmware_faults 40 500')
mistake 'late: a pause of 1.5 s is not reported' tests/firmware/faults/test_faults.c \
    'config->sensor.silence_ms = 2000;' 'config->sensor.silence_ms = 2000; config->sensor.pause_ms = 1500;'
mistake 'drop: a blind sensor is no fault of the door' firmware/appliance/appliance_sensor.c \
    'iso_door_guard_set_fault(appliance->door, appliance->sensor.blind);' ''
mistake 'drop: a visit goes on while blind' firmware/appliance/appliance_sensor.c \
    'iso__appliance_forget_face(appliance);' '' \
    firmware/visit/decision.c \
    'decision->seen_ns + decision->options.gap_ns;' 'decision->seen_ns + 20 * decision->options.gap_ns;' \
    firmware/recognise/track.c 't_ns - track->t_ns < options->lost_ns' 't_ns - track->t_ns < 20 * options->lost_ns' \
    firmware/visit/decision.c '> decision->options.stale_ns' '> 20 * decision->options.stale_ns' \
    firmware/appliance/appliance_door.c 'asleep_ns + stale_ns;' 'asleep_ns + 20 * stale_ns;'
mistake 'gone: a sensor that is gone stays open' firmware/sensor/sensor_supervisor.c '    close_sensor(supervisor, now_ns);
    return ISO_SENSOR_GONE;
}

static int64_t' '    return ISO_SENSOR_FLAW;
}

static int64_t'
mistake 'corrupt: the last good frame is taken again' firmware/appliance/appliance_frame.c \
    'if (iso__appliance_extract(appliance, frame)) {' \
    'if (iso__appliance_extract(appliance, frame) && 0) {' \
    firmware/appliance/appliance_face.c 'iso_template_wipe(&appliance->face.extraction.tmpl);' '(void)appliance;'
mistake 'corrupt: a score that is no number counts' firmware/visit/decision.c \
    'isfinite(frame->score) && frame->score >= options->threshold &&' \
    '!(frame->score < options->threshold) &&' \
    firmware/visit/decision.c 'frame->score - frame->second_score >= options->margin;' \
    '!(frame->score - frame->second_score < options->margin);' \
    firmware/appliance/appliance_visit.c 'return person && iso_person_is_valid(' 'return !person || iso_person_is_valid('
mistake 'blank: a visit has no end' firmware/visit/decision.c \
    'decision->seen_ns + decision->options.gap_ns;' 'decision->seen_ns + 20 * decision->options.gap_ns;' \
    firmware/recognise/track.c 't_ns - track->t_ns < options->lost_ns' 't_ns - track->t_ns < 20 * options->lost_ns' \
    firmware/visit/decision.c '> decision->options.stale_ns' '> 20 * decision->options.stale_ns' \
    firmware/appliance/appliance_door.c 'asleep_ns + stale_ns;' 'asleep_ns + 20 * stale_ns;'
mistake 'blank: an empty frame keeps the person before' firmware/appliance/appliance_face.c \
    '    if (extraction->outcome != ISO_CAPTURE_OK) {' \
    '    if (extraction->outcome != ISO_CAPTURE_OK && extraction->outcome != ISO_CAPTURE_NOBODY) {' \
    firmware/appliance/appliance_face.c 'iso_template_wipe(&appliance->face.extraction.tmpl);' '' \
    tests/firmware/rigs/puppets.c '*out = (struct iso_extraction){.outcome = (enum iso_capture)((int)frame->depth_mm[1] - 100)};' \
    'out->outcome = (enum iso_capture)((int)frame->depth_mm[1] - 100);'
mistake 'clock: a person outside the dates is admitted' firmware/appliance/appliance_frame.c \
    'face->valid = appliance->mode' 'face->valid = true || appliance->mode'
mistake 'restart: the relay keeps its power' firmware/appliance/appliance.c \
    'iso_door_guard_stop(appliance->door);' ''

if [ "$patterns_only" ]; then
    printf 'drill_bites: %d mistakes, %d that do not apply to the code any more\n' "$tried" "$outdated"
    [ "$outdated" -eq 0 ] && [ "$tried" -gt 0 ]
    exit
fi
printf 'drill_bites:'
for rule in 1 2 3 4 5 6; do
    [ -z "${of_rule[$rule]:-}" ] || printf ' rule %d: %d of %d,' "$rule" "${found_of_rule[$rule]:-0}" "${of_rule[$rule]}"
done
printf ' in all %d mistakes, %d not found, %d that do not apply to the code any more\n' "$tried" "$missed" "$outdated"
[ $((missed + outdated)) -eq 0 ] && [ "$tried" -gt 0 ]
