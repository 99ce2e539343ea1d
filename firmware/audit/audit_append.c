/* Writing the log in groups of records, which are synchronised together. */
#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "drivers/file/disk_wait.h"
#include "drivers/file/storage_fault.h"
#include "firmware/audit/audit_state.h"

struct iso_audit_record iso_audit_record_of(const char *event)
{
    return (struct iso_audit_record){
        .event = event,
        .score = NAN,
        .threshold = NAN,
        .frames = -1,
        .attack_frames = -1,
    };
}

/* ---- where the lines are ---- */

int iso__audit_reserve_mark(struct iso_audit *audit)
{
    const uint64_t in_segment = audit->last + 1 - audit->segment_first;
    if (in_segment % ISO__AUDIT_MARK_LINES != 0 || audit->n_marks < audit->mark_capacity) {
        return 0;
    }
    const size_t capacity = audit->mark_capacity ? 2 * audit->mark_capacity : 16;
    off_t *grown = reallocarray(audit->marks, capacity, sizeof *grown);
    if (!grown) {
        return -ENOMEM;
    }
    audit->marks = grown;
    audit->mark_capacity = capacity;
    return 0;
}

void iso__audit_count_line(struct iso_audit *audit, size_t bytes)
{
    if ((audit->last + 1 - audit->segment_first) % ISO__AUDIT_MARK_LINES == 0) {
        audit->marks[audit->n_marks++] = audit->size;
    }
    audit->last++;
    audit->size += (off_t)bytes;
}

/* ---- the text of a record ---- */

static void format_time(int64_t wall_ns, char text[40])
{
    const time_t seconds = (time_t)(wall_ns / ISO_NS_PER_S);
    struct tm utc;
    char date[24] = "1970-01-01T00:00:00";
    if (wall_ns >= 0 && gmtime_r(&seconds, &utc)) {
        (void)strftime(date, sizeof date, "%Y-%m-%dT%H:%M:%S", &utc);
    }
    (void)snprintf(text, 40, "%s.%03dZ", date,
                   wall_ns >= 0 ? (int)(wall_ns / ISO_NS_PER_MS % 1000) : 0);
}

static void add_string(struct iso_json_line *line, const char *key, const char *value)
{
    if (value) {
        iso_json_line_string(line, key, value);
    }
}

static void add_gallery(struct iso_json_line *line, const char *gallery, uint64_t changes)
{
    char text[48];
    (void)snprintf(text, sizeof text, "%s:%" PRIu64, gallery, changes);
    iso_json_line_string(line, "gallery", text);
}

/* Returns the length of the object without a newline, or 0 if it is too long. */
static size_t format_record(struct iso_audit *audit, const struct iso_audit_record *record)
{
    struct iso_json_line *line = &audit->json;
    const bool then = record->wall_ns != 0 || record->monotonic_ns != 0;
    char time[40];
    format_time(then ? record->wall_ns : iso_times_wall_ns(audit->times), time);
    iso_json_line_begin(line);
    iso_json_line_integer(line, "sequence", (int64_t)(audit->last + 1));
    iso_json_line_string(line, "time", time);
    iso_json_line_integer(line, "monotonic_ns",
                          then ? record->monotonic_ns : iso_times_now_ns(audit->times));
    iso_json_line_string(line, "event", record->event);
    add_string(line, "person", record->person);
    add_string(line, "verdict", record->verdict);
    add_string(line, "door", record->door);
    add_string(line, "door_fault", record->door_fault);
    if (record->grant > 0) {
        iso_json_line_integer(line, "grant", (int64_t)record->grant);
    }
    add_string(line, "reason", record->reason);
    if (!isnan(record->score)) {
        iso_json_line_number(line, "score", record->score);
    }
    if (!isnan(record->threshold)) {
        iso_json_line_number(line, "threshold", record->threshold);
    }
    if (record->frames >= 0) {
        iso_json_line_integer(line, "frames", record->frames);
    }
    if (record->attack_frames >= 0) {
        iso_json_line_integer(line, "attack_frames", record->attack_frames);
    }
    add_string(line, "sensor", record->sensor);
    if (record->gallery) {
        add_gallery(line, record->gallery, record->gallery_changes);
    }
    add_string(line, "before", record->before);
    add_string(line, "after", record->after);
    add_string(line, "note", record->note);
    const size_t length = iso_json_line_end(line);
    return length ? length - 1 : 0;
}

/* ---- files ---- */

int iso__audit_sync(const struct iso_audit *audit, int fd)
{
    return audit->options.sync && iso_disk_wait_fdatasync(fd) ? -errno : 0;
}

/* Removes everything after the last record, so that the next record begins a line. */
static int take_back(struct iso_audit *audit, struct iso_fault *fault)
{
    audit->torn = ftruncate(audit->fd, audit->size) != 0;
    return audit->torn ? iso_storage_refused(audit->path, -errno, fault) : 0;
}

int iso__audit_settle(struct iso_audit *audit, struct iso_fault *fault)
{
    const int error = audit->lost ? iso__audit_recover(audit, fault) : 0;
    return error || !audit->torn ? error : take_back(audit, fault);
}

int iso__audit_catch_up(struct iso_audit *audit, struct iso_fault *fault)
{
    if (!audit->options.sync || iso_anchor_state(audit->anchor)->value >= audit->last) {
        return 0;
    }
    /* A crash may have left records that are in the file but not yet on the disk. */
    const int error = iso__audit_sync(audit, audit->fd);
    return error ? iso_storage_refused(audit->path, error, fault)
                 : iso__audit_write_anchor(audit, fault);
}

/* Whether the next record begins a new segment. */
static bool is_full(const struct iso_audit *audit)
{
    const uint64_t limit = audit->options.segment_bytes;
    return limit > 0 && (uint64_t)audit->size >= limit && audit->last >= audit->segment_first;
}

/* Prepares for a group: checks the files, brings the anchor up to date, and begins a new segment if
 * the present one is full. */
static int prepare_files(struct iso_audit *audit, struct iso_fault *fault)
{
    int error = iso__audit_settle(audit, fault);
    if (!error) {
        error = iso__audit_catch_up(audit, fault);
    }
    return !error && is_full(audit) ? iso__audit_rotate(audit, fault) : error;
}

/* ---- groups ---- */

/* The state that a group changes, to be restored if the disk refuses the group. */
struct end {
    uint64_t last;
    struct iso_audit_link link;
    off_t size;
    size_t n_marks;
    char gallery[sizeof((struct iso_audit *)0)->gallery];
    uint64_t gallery_changes;
    int64_t latest_s;
};

static struct end end_of(const struct iso_audit *audit)
{
    struct end end = {
        .last = audit->last,
        .link = audit->link,
        .size = audit->size,
        .n_marks = audit->n_marks,
        .gallery_changes = audit->gallery_changes,
        .latest_s = audit->latest_s,
    };
    memcpy(end.gallery, audit->gallery, sizeof end.gallery);
    return end;
}

static void put_back(struct iso_audit *audit, const struct end *end)
{
    audit->last = end->last;
    audit->link = end->link;
    audit->size = end->size;
    audit->n_marks = end->n_marks;
    memcpy(audit->gallery, end->gallery, sizeof audit->gallery);
    audit->gallery_changes = end->gallery_changes;
    audit->latest_s = end->latest_s;
}

static void refuse_entry(struct iso_audit_entry *entry, int error, const struct iso_fault *fault)
{
    entry->error = error == -ENOSPC || error == -ENOMEM || error == -EINVAL ? error : -EIO;
    entry->sequence = 0;
    entry->fault = *fault;
    if (error != -EINVAL) {
        iso_storage_add(&entry->fault, "the record is not written");
    }
}

/* What a record that is written now states about the other stores and about the anchor. */
static struct iso_heads known_now(const struct iso_audit *audit)
{
    struct iso_heads known = iso_heads_now(iso_key_ring_board(audit->options.ring));
    known.count[ISO_HEAD_LOG] = 1 + iso_anchor_state(audit->anchor)->value;
    return known;
}

static void note_gallery(struct iso_audit *audit, const struct iso_audit_record *record)
{
    if (record->gallery && record->gallery != audit->gallery) {
        (void)snprintf(audit->gallery, sizeof audit->gallery, "%s", record->gallery);
        audit->gallery_changes = record->gallery_changes;
    }
}

/* The kind of change that a record stands for. The gallery is changed by an administrator or by
 * learning. */
static enum iso_state_change change_of(const struct iso_audit *audit,
                                       const struct iso_audit_record *record)
{
    static const char *const events[] = {"lockdown", "rotate-keys", "state-accepted"};
    for (size_t i = 0; i < sizeof events / sizeof *events; i++) {
        if (strcmp(record->event, events[i]) == 0) {
            return ISO_STATE_ADMINISTRATOR;
        }
    }
    /* A change of a setting has its new value; that the settings were loaded is no change. */
    if (strcmp(record->event, "setting") == 0 && record->after) {
        return ISO_STATE_ADMINISTRATOR;
    }
    if (record->gallery && (strcmp(record->gallery, audit->gallery) != 0 ||
                            record->gallery_changes != audit->gallery_changes)) {
        return ISO_STATE_ADMINISTRATOR;
    }
    return strcmp(record->event, "lockout") == 0 ? ISO_STATE_LOCKOUT : ISO_STATE_RECORD;
}

/* Writes the line of one record, without synchronising it. */
static int write_record(struct iso_audit *audit, const struct iso_audit_record *record,
                        struct iso_fault *fault)
{
    const struct iso_heads known = known_now(audit);
    struct iso_audit_link link = audit->link;
    const size_t size = format_record(audit, record);
    if (size == 0) {
        return iso_fault_set(fault, -EINVAL, "%s: the record is too long", audit->path);
    }
    if (iso__audit_reserve_mark(audit)) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", audit->path);
    }
    const size_t length = iso_audit_line_close(&audit->seal, audit->last + 1, &known,
                                               audit->json.text, size, audit->line, &link);
    const ssize_t written = write(audit->fd, audit->line, length);
    if (written < 0 || (size_t)written < length) {
        const int error = written < 0 ? -errno : -ENOSPC;
        (void)take_back(audit, NULL);
        return iso_storage_refused(audit->path, error, fault);
    }
    iso__audit_count_line(audit, length);
    audit->link = link;
    if (audit->options.counter) {
        iso_state_counter_changed(audit->options.counter, change_of(audit, record));
    }
    note_gallery(audit, record);
    iso__audit_note_clock(audit, audit->json.text);
    return 0;
}

static void write_entry(struct iso_audit *audit, struct iso_audit_entry *entry)
{
    struct iso_fault fault = {.text = ""};
    const int error = write_record(audit, entry->record, &fault);
    explicit_bzero(audit->json.text, sizeof audit->json.text); /* the text may contain a name */
    if (error) {
        refuse_entry(entry, error, &fault);
        return;
    }
    entry->sequence = audit->last;
    (void)sodium_bin2hex(entry->head, sizeof entry->head, audit->link.bytes,
                         sizeof audit->link.bytes);
}

/* Synchronises the records that were written after `before`. If this fails, the whole group is
 * removed again, because it is not known which part of it is on the disk. */
static void commit_group(struct iso_audit *audit, const struct end *before,
                         struct iso_audit_entry *entries, size_t n)
{
    struct iso_fault fault = {.text = ""};
    int error = 0;
    if (audit->last == before->last) {
        return; /* nothing was written */
    }
    if ((error = iso__audit_sync(audit, audit->fd))) {
        put_back(audit, before);
        (void)take_back(audit, NULL);
        (void)iso_storage_refused(audit->path, error, &fault);
        for (size_t i = 0; i < n; i++) {
            if (!entries[i].error) {
                refuse_entry(&entries[i], error, &fault);
            }
        }
        return;
    }
    if (audit->options.sync || iso__audit_wants_number(audit)) {
        /* If this fails, it is tried again before the next group. */
        (void)!iso__audit_write_anchor(audit, NULL);
    }
}

/* Writes as many entries as fit into one group, but at least one. Returns their number. */
static size_t append_some(struct iso_audit *audit, struct iso_audit_entry *entries, size_t n)
{
    struct iso_fault fault = {.text = ""};
    size_t done = 0;
    const int error = prepare_files(audit, &fault);
    if (error) {
        refuse_entry(&entries[0], error, &fault);
        return 1;
    }
    const struct end before = end_of(audit);
    do {
        write_entry(audit, &entries[done++]);
    } while (done < n && !is_full(audit) && !audit->torn);
    commit_group(audit, &before, entries, done);
    return done;
}

static void tell_listener(const struct iso_audit *audit, const struct iso_audit_entry *entries,
                          size_t n)
{
    for (size_t i = 0; audit->options.written && i < n; i++) {
        if (!entries[i].error) {
            audit->options.written(audit->options.context, entries[i].record, entries[i].sequence,
                                   entries[i].head);
        }
    }
}

void iso_audit_append_group(struct iso_audit *audit, struct iso_audit_entry *entries, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        entries[i].error = 0;
        entries[i].sequence = 0;
        entries[i].fault.text[0] = '\0';
    }
    for (size_t done = 0; done < n;) {
        const size_t some = append_some(audit, entries + done, n - done);
        tell_listener(audit, entries + done, some);
        done += some;
    }
}

int iso_audit_append(struct iso_audit *audit, const struct iso_audit_record *record,
                     struct iso_fault *fault)
{
    struct iso_audit_entry entry = {.record = record};
    iso_audit_append_group(audit, &entry, 1);
    return entry.error
               ? iso_fault_set_code(fault, entry.fault.code, entry.error, "%s", entry.fault.text)
               : 0;
}
