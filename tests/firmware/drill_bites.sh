#!/bin/bash
# The oracles of the fault plans (test_faults.c) and of storage faults (test_storage_faults.c) see what they are there to see: each
# of these mistakes is built into a copy of the tree, and the test has to fail on it. Some defences stand behind each other; then the
# mistake is in both. What needs threads or a suspended machine is seen by tests of its own. Takes some minutes.
# usage: drill_bites.sh BUILD [NAME]      BUILD: of the preset dev; NAME: only mistakes with this in their names
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
build=$(cd "$1" && pwd)
only=${2:-}
copy=$(mktemp -d "${TMPDIR:-/var/tmp}/drill-bites.XXXXXX")
trap 'rm -rf "$copy"' EXIT
missed=0
judge=(test_firmware_faults 40 500) # the test that has to fail, and its arguments

tar -C "$root" --exclude=./build --exclude=./out --exclude=./.git -cf - . | tar -C "$copy" -xf -
cmake -S "$copy" -B "$copy/build" -G Ninja -DCMAKE_BUILD_TYPE=RelWithDebInfo \
    -DCMAKE_C_COMPILER="$(sed -n 's/^CMAKE_C_COMPILER:[^=]*=//p' "$build/CMakeCache.txt")" >"$copy/log" 2>&1 || {
    cat "$copy/log" >&2
    exit 1
}

drill() {
    cmake --build "$copy/build" --target "${judge[0]##*/}" >"$copy/log" 2>&1 || {
        tail -n 20 "$copy/log" >&2
        echo "drill_bites: $1: does not build" >&2
        exit 1
    }
    timeout 300 "$copy/build/tests/firmware/${judge[0]}" "${judge[@]:1}" >"$copy/drill" 2>&1
}

# mistake NAME FILE OLD NEW [FILE OLD NEW]...: literal text; OLD has to be there
mistake() {
    name=$1
    files=()
    shift
    [[ $name == *"$only"* ]] || return 0
    while [ $# -gt 0 ]; do
        files+=("$1")
        OLD=$2 NEW=$3 perl -0pi -e '$n = s/\Q$ENV{OLD}\E/$ENV{NEW}/; END { exit !$n }' "$copy/$1" || {
            echo "drill_bites: $name: $1 has no more: $2" >&2
            exit 1
        }
        shift 3
    done
    if drill "$name"; then
        missed=$((missed + 1))
        printf '%-44s not noticed\n' "$name"
    else
        printf '%-44s %s\n' "$name" "$(grep -m 1 -E '\(seed [0-9]+, step' "$copy/drill" || grep -m 1 -F 'ERROR' "$copy/drill" || tail -n 1 "$copy/drill")"
    fi
    for file in "${files[@]}"; do
        cp "$root/$file" "$copy/$file"
    done
}

drill 'without a mistake' || {
    cat "$copy/drill" >&2
    exit 1
}
mistake 'late: a pause of 1.5 s is no silence' tests/firmware/test_faults.c \
    'config->sensor.silence_ms = 2000;' 'config->sensor.silence_ms = 2000; config->sensor.pause_ms = 1500;'
mistake 'drop: blind, and the door says nothing' firmware/appliance.c \
    'iso_door_guard_set_fault(appliance->door, appliance->blind);' ''
mistake 'drop: a visit goes on while blind' firmware/appliance.c \
    '        iso_decision_reset(&appliance->decision);
        iso_track_reset(&appliance->track);' '' \
    firmware/decision.c \
    'decision->seen_ns + decision->options.gap_ns;' 'decision->seen_ns + 20 * decision->options.gap_ns;' \
    firmware/track.c 't_ns - track->t_ns < options->lost_ns' 't_ns - track->t_ns < 20 * options->lost_ns' \
    firmware/decision.c '> decision->options.stale_ns' '> 20 * decision->options.stale_ns' \
    firmware/appliance_door.c 'asleep_ns + stale_ns;' 'asleep_ns + 20 * stale_ns;'
mistake 'gone: the sensor is kept' firmware/sensor_keeper.c '    close_sensor(keeper, now_ns);
    return ISO_SENSOR_GONE;
}

int64_t' '    return ISO_SENSOR_FLAW;
}

int64_t'
mistake 'twice, frozen: a frame agrees with itself' firmware/appliance_frame.c \
    'appliance->liveness.repeated > 0;' 'appliance->liveness.repeated > 1000;'
mistake 'corrupt: the last good frame is taken again' firmware/appliance_frame.c \
    'appliance->mode == ISO_APPLIANCE_CLAIMED || extract(appliance, frame)' \
    'appliance->mode == ISO_APPLIANCE_CLAIMED || (extract(appliance, frame) && 0)' \
    firmware/appliance_frame.c 'iso_template_wipe(&appliance->extraction.tmpl);' ''
mistake 'corrupt: a score that is no number counts' firmware/decision.c \
    'isfinite(frame->score) && frame->score >= options->threshold &&' \
    '!(frame->score < options->threshold) &&' \
    firmware/decision.c 'frame->score - frame->second_score >= options->margin;' \
    '!(frame->score - frame->second_score < options->margin);' \
    firmware/appliance_visit.c 'return person && is_valid_at(person, now_s);' \
    'return !person || is_valid_at(person, now_s);'
mistake 'blank: a visit has no end' firmware/decision.c \
    'decision->seen_ns + decision->options.gap_ns;' 'decision->seen_ns + 20 * decision->options.gap_ns;' \
    firmware/track.c 't_ns - track->t_ns < options->lost_ns' 't_ns - track->t_ns < 20 * options->lost_ns' \
    firmware/decision.c '> decision->options.stale_ns' '> 20 * decision->options.stale_ns' \
    firmware/appliance_door.c 'asleep_ns + stale_ns;' 'asleep_ns + 20 * stale_ns;'
mistake 'blank: nobody is whoever was there before' firmware/appliance_frame.c \
    '    if (extraction->outcome != ISO_CAPTURE_OK) {' \
    '    if (extraction->outcome != ISO_CAPTURE_OK && extraction->outcome != ISO_CAPTURE_NOBODY) {' \
    firmware/appliance_frame.c 'iso_template_wipe(&appliance->extraction.tmpl);' '' \
    tests/firmware/puppets.c '*out = (struct iso_extraction){.outcome = (enum iso_capture)((int)frame->depth_mm[1] - 100)};' \
    'out->outcome = (enum iso_capture)((int)frame->depth_mm[1] - 100);'
mistake 'clock: whom the calendar shuts out enters' firmware/appliance_frame.c \
    'face.valid = appliance->mode' 'face.valid = true || appliance->mode'
mistake 'disk: the door opens without a record' firmware/appliance_visit.c \
    'error ? reason_of(error) : open_door(appliance, visit);' 'error ? open_door(appliance, visit) : open_door(appliance, visit);'
mistake 'restart: the relay keeps its power' firmware/appliance.c \
    'iso_door_guard_stop(appliance->door);' ''

judge=(test_firmware_earlier_files)
mistake 'earlier: nobody compares the stores' firmware/heads.c \
    'store->found && store->count < claim->known.count[i]' 'store->found && store->count + 1 == 0'
mistake 'earlier: anchors know nothing' firmware/anchor.c \
    'anchor->known = iso_heads_get(plain + PLAIN_1_BYTES);' ''
mistake 'earlier: the gallery knows nothing' firmware/gallery_seal.c \
    'out->known = iso_heads_get(plain + ISO_GALLERY_HEAD_1_BYTES);' 'out->known = (struct iso_heads){{0}, {0}};' \
    firmware/anchor.c 'anchor->known = iso_heads_get(plain + PLAIN_1_BYTES);' \
    'if (anchor->kind[0] == 0x6c) { anchor->known = iso_heads_get(plain + PLAIN_1_BYTES); }'
mistake 'earlier: the key ring has no number' firmware/key_ring.c \
    'const uint64_t number = ring->number + 1;' 'const uint64_t number = 1;'
mistake 'earlier: another history of the log is taken' firmware/heads.c \
    'claim->other_link = true;' 'claim->other_link = false;'
mistake 'earlier: nobody counts closed segments' firmware/audit_anchor.c 'return found == n ? 0' 'return found < UINT16_MAX ? 0'
mistake 'earlier: a count is known before it is written' firmware/audit_append.c \
    'struct iso_heads known = iso_heads_now(iso_key_ring_board(audit->options.ring));' \
    'struct iso_heads known = iso_heads_now(iso_key_ring_board(audit->options.ring));
        known.count[ISO_HEAD_LOCKOUT]++;'

judge=(storage_faults 3 'remove')
mistake 'storage remove: an error of COMMIT is believed' firmware/gallery_db.c \
    'error = error ? iso__gallery_settle(db, error, fault) : 0;' 'db->draft = error ? db->head : db->draft;'
judge=(storage_faults 3 'enrol')
mistake 'storage enrol: out of service, and it goes on' firmware/gallery_truth.c 'db->lost = true;' 'db->lost = false;'
judge=(storage_faults 3 'log append')
mistake 'storage log append: an exchange is believed' firmware/audit_rotate.c \
    '(void)!iso__audit_recover(audit, NULL);' ';'
judge=(storage_faults 3 'log groups')
mistake 'storage log groups: a failed group counts' firmware/audit_append.c \
    'put_back(audit, before);' '(void)put_back;'
judge=(storage_faults 3 'lockdown off')
mistake 'storage lockdown off: ended in memory only' firmware/appliance_refusal.c \
    'appliance->lockout = *before;' '(void)before;'

judge=(test_firmware_slow_disk)
mistake 'door: it waits for its records' firmware/appliance_door.c \
    'iso_audit_writer_post(appliance->log, &record, NULL)' \
    'iso_audit_writer_append(appliance->log, &record, ISO_NEVER_NS, NULL, NULL)'
mistake 'chatter: each edge is a record' firmware/event_limit.c \
    'limit->passed < ISO_EVENT_LIMIT_BURST' 'limit->passed < 1000000'
judge=(test_firmware_audit_group)
mistake 'group: an old anchor is taken' firmware/audit_scan.c 'audit->proved > anchor->value' 'audit->proved > UINT64_MAX - 1'
mistake 'group: one record ahead, and no more' firmware/audit_scan.c \
    'audit->proved > anchor->value' 'audit->last > anchor->value + 1'
judge=(test_firmware_lockout_unread)
mistake 'lock-out: what cannot be read is a lockdown' firmware/appliance_refusal.c 'if (may_pass(error)) {' 'if (may_pass(error) && 0) {'
judge=(test_firmware_audit_writer)
mistake 'log: a grant that was given up is written' firmware/audit_writer.c \
    'slot->cancelled || slot->ticket == ticket;' 'slot->cancelled;'
mistake 'log: a late grant has no outcome behind it' firmware/audit_group.c \
    'known ? writer->awaited.sequence : 0;' 'known ? 0 : 0;'
mistake 'log: what was lost is not said' firmware/audit_group.c 'return writer->lost > 0 &&' 'return writer->lost > 1000 &&'
judge=(test_firmware_old_verdicts)
mistake 'stale: a record may take any time' firmware/appliance.c 'took_ns > wait_ns' 'took_ns < 0'
mistake 'stale: nobody asks how old a grant is' firmware/door_guard.c 'if (begin_ns > until_ns) {' 'if (begin_ns < 0) {'
mistake 'stale: nobody asks again behind the switching' firmware/door_guard.c \
    '!was_unlocked && now_ns(guard) > until_ns' '!was_unlocked && now_ns(guard) < 0'
mistake 'suspended: frames from before count' firmware/appliance_frame.c \
    'frame->t_ns < appliance->suspension.awake_ns' 'frame->t_ns < 0'
mistake 'suspended: a visit goes on' firmware/appliance.c \
    'if (iso_suspension_look(&appliance->suspension, &appliance->parts.times)) {' \
    'if (iso_suspension_look(&appliance->suspension, &appliance->parts.times) && 0) {'
judge=(../core/test_presentation_frame_memory)
mistake 'repeats: one frame is remembered' core/presentation/frame_memory.c \
    'memory->n = memory->n < memory->options.capacity ? memory->n + 1 : memory->n;' 'memory->n = 1;'
mistake 'repeats: an offset makes a frame new' core/presentation/frame_memory.c \
    '(z_mm - before_mm) * steps_per_mm' 'z_mm * steps_per_mm'
mistake 'repeats: some pixels make a frame new' core/presentation/frame_memory.h \
    '#define ISO_FINGERPRINT_SAME 0.4' '#define ISO_FINGERPRINT_SAME 0.99'
judge=(../e2e/test_e2e_appliance)
mistake 'repeats: a frame that is known counts' firmware/appliance_frame.c \
    'return !repeats && !is_echo(appliance);' 'return (repeats || !repeats) && !is_echo(appliance);'
[ "$missed" -eq 0 ] || {
    echo "drill_bites: $missed mistakes were not noticed" >&2
    exit 1
}
