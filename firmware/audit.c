#include "firmware/audit.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <math.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <time.h>
#include <unistd.h>

#include "core/math/bytes.h"
#include "drivers/file/file.h"
#include "firmware/audit_state.h"
#include "firmware/directory.h"
#include "firmware/storage_fault.h"

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

/* ---- the anchor ---- */

static int make_anchor(struct iso_audit *audit, struct iso_fault *fault)
{
    const struct iso_anchor_state state = iso__audit_anchor_state(audit, false);
    return iso_anchor_make(audit->anchor_path, ISO__AUDIT_ANCHOR, audit->options.ring, true, &state,
                           &audit->anchor, fault);
}

/* ---- opening ---- */

static int refuse(const struct iso_audit *audit, int error, uint64_t sequence, const char *flaw,
                  struct iso_fault *fault)
{
    return iso_fault_set(fault, error,
                         "%s: record %" PRIu64
                         " %s; move the log and its anchor away (see --accept-state)",
                         audit->path, sequence, flaw);
}

static int stale(const struct iso_audit *audit, const char *what, struct iso_fault *fault)
{
    return iso_fault_set(fault, -ESTALE,
                         "%s: %s; move the log and its anchor away (see --accept-state)",
                         audit->path, what);
}

/* Remembers what a record says of the gallery: "gallery":"ID:CHANGES". */
static void note_gallery(struct iso_audit *audit, const char *text)
{
    static const char key[] = "\"gallery\":\"";
    const char *found = strstr(text, key);
    char gallery[20];
    uint64_t changes;
    if (found && sscanf(found + sizeof key - 1, "%16[0-9a-f]:%" SCNu64, gallery, &changes) == 2) {
        memcpy(audit->gallery, gallery, sizeof gallery);
        audit->gallery_changes = changes;
    }
}

/* Takes a record in that the reader has just read. */
static int take_record(struct iso_audit *audit, const struct iso_audit_reader *reader,
                       struct iso_fault *fault)
{
    const uint64_t anchored = iso_anchor_state(audit->anchor)->value;
    if (iso__audit_reserve_mark(audit)) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", audit->path);
    }
    iso__audit_count_line(audit, (size_t)(reader->position - audit->size));
    audit->link = reader->link;
    audit->known = reader->record.known;
    iso_heads_record(iso_key_ring_board(audit->options.ring), audit->last, audit->link.bytes);
    if (audit->last == anchored && !iso__audit_is_anchored(audit, &audit->link)) {
        return refuse(audit, -ESTALE, audit->last, "is of another log than the anchor", fault);
    }
    note_gallery(audit, reader->record.text);
    iso__audit_note_clock(audit, reader->record.text);
    return 0;
}

/* The segment's beginning, as the header says it. */
static int take_header(struct iso_audit *audit, const struct iso_audit_reader *reader,
                       struct iso_fault *fault)
{
    const struct iso_audit_header *header = &reader->header;
    const uint64_t anchored = iso_anchor_state(audit->anchor)->value;
    audit->seal = reader->seal;
    audit->segment_first = header->first;
    audit->last = header->first - 1;
    audit->link = header->link;
    audit->size = reader->position;
    audit->n_marks = 0;
    iso_heads_record(iso_key_ring_board(audit->options.ring), audit->last, audit->link.bytes);
    return audit->last == anchored && !iso__audit_is_anchored(audit, &audit->link)
               ? refuse(audit, -ESTALE, header->first, "is of another log than the anchor", fault)
               : 0;
}

/* Goes over a segment to its end: the head, and how many bytes stand behind the last whole line. */
static int scan(struct iso_audit *audit, const char *path, size_t *torn, struct iso_fault *fault)
{
    struct iso_audit_reader *reader = malloc(sizeof *reader);
    if (!reader) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", audit->path);
    }
    int error = iso_audit_reader_open(reader, path, audit->options.ring);
    if (error == -EBADMSG) {
        error = iso_fault_set(fault, error,
                              "%s: %s; move the log and its anchor away (see "
                              "--accept-state)",
                              path, reader->flaw);
    } else if (error) {
        error = iso_fault_set(fault, error, "%s: %s", path, strerror(-error));
        error = iso_storage_reword(path, error, fault);
    } else {
        error = take_header(audit, reader, fault);
    }
    int more = 0;
    while (!error && (more = iso_audit_reader_next(reader)) > 0) {
        error = take_record(audit, reader, fault);
    }
    if (!error && more < 0) {
        error = more == -EBADMSG ? refuse(audit, more, reader->next, reader->flaw, fault)
                                 : iso_fault_set(fault, more, "%s: cannot be read", path);
    }
    *torn = reader->torn;
    iso_audit_reader_close(reader);
    free(reader);
    return error;
}

/* The end that was found, against the anchor: the same, or one record ahead. Then the anchor
 * follows before the next record, and not here: it may be an old one, which the other stores know.
 * closed: what was read is a closed segment, since there is no other. */
static int check_end(struct iso_audit *audit, bool closed, struct iso_fault *fault)
{
    const struct iso_anchor_state *anchor = iso_anchor_state(audit->anchor);
    audit->first = iso__audit_anchored_first(audit);
    if (audit->last < anchor->value) {
        return refuse(audit, -ESTALE, audit->last + 1, "and what came after it are missing", fault);
    }
    const bool lax = iso__audit_anchor_is_lax(audit);
    if (!lax && audit->last > anchor->value + 1) {
        return stale(audit, "its anchor is an old one", fault);
    }
    const int error = iso__audit_check_closed(audit, closed, fault);
    if (error) {
        return error;
    }
    iso_heads_claim(iso_key_ring_board(audit->options.ring), audit->path, &audit->known);
    return (lax && audit->last > anchor->value) || iso__audit_anchor_is_sealing(audit) ||
                   lax == audit->options.sync
               ? iso__audit_write_anchor(audit, fault)
               : 0;
}

static int sync_file(const struct iso_audit *audit, int fd)
{
    return audit->options.sync && fdatasync(fd) ? -errno : 0;
}

int iso__audit_begin_segment(struct iso_audit *audit, int fd, struct iso_fault *fault)
{
    uint32_t number = iso_key_ring_newest(audit->options.ring, ISO_KEY_LOG);
    int error = number ? 0 : iso_key_ring_add(audit->options.ring, ISO_KEY_LOG, &number, fault);
    if (error) {
        return error;
    }
    const struct iso_audit_header header = {number, audit->last + 1, audit->link};
    const size_t length = iso_audit_header_put(&header, audit->line);
    const ssize_t written = write(fd, audit->line, length);
    error = written < 0 ? -errno : (size_t)written < length ? -ENOSPC : sync_file(audit, fd);
    if (error) {
        return iso_storage_refused(audit->path, error, fault);
    }
    iso_audit_seal_wipe(&audit->seal);
    audit->seal = iso_audit_seal_of(number,
                                    iso_key_ring_find(audit->options.ring, ISO_KEY_LOG, number));
    audit->segment_first = header.first;
    audit->size = (off_t)length;
    audit->n_marks = 0;
    return 0;
}

/* There is nothing in PATH: the log begins, or goes on where its newest closed segment ends. */
static int begin(struct iso_audit *audit, struct iso_fault *fault)
{
    size_t torn = 0;
    int error = 0;
    audit->first = 1;
    if (ftruncate(audit->fd, 0)) { /* of a header that was cut short */
        return iso_storage_refused(audit->path, -errno, fault);
    }
    if (!audit->anchor && audit->closed.n > 0) {
        return stale(audit, "its anchor is gone", fault);
    }
    if (audit->anchor && audit->closed.n > 0) {
        char path[PATH_MAX];
        error = iso_audit_segment_path(audit->path, audit->closed.first[audit->closed.n - 1], path,
                                       fault);
        error = error ? error : scan(audit, path, &torn, fault);
    }
    error = error           ? error
            : audit->anchor ? check_end(audit, true, fault)
                            : make_anchor(audit, fault);
    return error ? error : iso__audit_begin_segment(audit, audit->fd, fault);
}

static int go_on(struct iso_audit *audit, size_t *torn, struct iso_fault *fault)
{
    if (!audit->anchor) {
        return stale(audit, "its anchor is gone", fault);
    }
    const int error = scan(audit, audit->path, torn, fault);
    return error ? error : check_end(audit, false, fault);
}

/* Takes away what a crash left of a record, and says so on record if there is room. */
static int mend(struct iso_audit *audit, size_t torn, struct iso_fault *fault)
{
    char note[80];
    struct iso_audit_record record = iso_audit_record_of("log-recovered");
    if (torn == 0) {
        return 0;
    }
    if (ftruncate(audit->fd, audit->size)) {
        return iso_storage_refused(audit->path, -errno, fault);
    }
    (void)snprintf(note, sizeof note, "%zu bytes of an unfinished record taken away", torn);
    record.note = note;
    const int error = iso_audit_append(audit, &record, fault);
    return error == -ENOSPC ? 0 : error;
}

int iso__audit_open_file(const char *path, int flags, int *fd, struct iso_fault *fault)
{
    int opened = -1;
    const int failed = iso_file_open(path, O_RDWR | O_APPEND | O_CREAT | flags, ISO_FILE_ANY_SIZE,
                                     &opened, fault);
    if (failed) {
        return iso_storage_reword(path, failed, fault);
    }
    if (flock(opened, LOCK_EX | LOCK_NB)) {
        const int error = errno == EWOULDBLOCK ? -EBUSY : -errno;
        (void)close(opened);
        return iso_fault_set(fault, error, "%s: %s", path,
                             error == -EBUSY ? "another process writes it" : strerror(-error));
    }
    *fd = opened;
    return 0;
}

enum content { EMPTY, PLAIN, SEALED };

/* What PATH holds; a header without its end is nothing yet. */
static int look(const struct iso_audit *audit, enum content *out, struct iso_fault *fault)
{
    char begin[ISO_AUDIT_LINE_MAX];
    const ssize_t n = pread(audit->fd, begin, sizeof begin, 0);
    if (n < 0) {
        return iso_storage_refused(audit->path, -errno, fault);
    }
    *out = n > 0 && begin[0] == '{'                                                   ? PLAIN
           : n == 0 || (n < (ssize_t)sizeof begin && !memchr(begin, '\n', (size_t)n)) ? EMPTY
                                                                                      : SEALED;
    return 0;
}

static int open_log(struct iso_audit *audit, struct iso_fault *fault)
{
    enum content content = EMPTY;
    size_t torn = 0;
    int error = iso__audit_open_file(audit->path, 0, &audit->fd, fault);
    error = error ? error : iso_directory_sync(audit->path, fault);
    if (!error) {
        error = iso_anchor_open(audit->anchor_path, ISO__AUDIT_ANCHOR, audit->options.ring, true,
                                &audit->anchor, fault);
        error = error == -ENOENT ? 0 : error;
    }
    if (!error) {
        iso__audit_tell_anchor(audit);
    }
    error = error ? error : iso_audit_segments_find(audit->path, &audit->closed, fault);
    error = error ? error : look(audit, &content, fault);
    if (!error && content == PLAIN) {
        error = iso__audit_migrate(audit, fault);
    } else if (!error) {
        error = content == EMPTY ? begin(audit, fault) : go_on(audit, &torn, fault);
    }
    error = error ? error : iso__audit_prune(audit, fault);
    return error ? error : mend(audit, torn, fault);
}

int iso_audit_open(const struct iso_audit_options *options, const struct iso_times *times,
                   struct iso_audit **out, struct iso_fault *fault)
{
    struct iso_audit *audit = calloc(1, sizeof *audit);
    if (!audit || !(audit->path = strdup(options->path)) ||
        asprintf(&audit->anchor_path, "%s.anchor", options->path) < 0) {
        free(audit ? audit->path : NULL);
        free(audit);
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", options->path);
    }
    audit->fd = -1;
    audit->options = *options;
    audit->options.path = audit->path;
    audit->times = times;
    const int error = open_log(audit, fault);
    if (error) {
        iso_audit_close(audit);
        return error;
    }
    audit->opened = true;
    *out = audit;
    return 0;
}

void iso_audit_close(struct iso_audit *audit)
{
    if (audit) {
        if (audit->opened && !audit->lost && audit->last > iso_anchor_state(audit->anchor)->value) {
            (void)!iso__audit_write_anchor(audit, NULL);
        }
        if (audit->fd >= 0) {
            (void)close(audit->fd);
        }
        iso_anchor_close(audit->anchor);
        free(audit->marks);
        free(audit->path);
        free(audit->anchor_path);
        sodium_memzero(audit, sizeof *audit);
        free(audit);
    }
}

/* ---- writing ---- */

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

/* Length of the object, without a newline; 0 if it is too long. */
static size_t format(struct iso_audit *audit, const struct iso_audit_record *record)
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

/* Takes away what a failed write left, so that the next record begins a line. */
static int take_back(struct iso_audit *audit, struct iso_fault *fault)
{
    audit->torn = ftruncate(audit->fd, audit->size) != 0;
    return audit->torn ? iso_storage_refused(audit->path, -errno, fault) : 0;
}

int iso__audit_write_line(struct iso_audit *audit, size_t length)
{
    const ssize_t written = write(audit->fd, audit->line, length);
    if (written < 0) {
        return -errno;
    }
    return (size_t)written < length ? -ENOSPC : sync_file(audit, audit->fd);
}

int iso__audit_settle(struct iso_audit *audit, struct iso_fault *fault)
{
    const int error = audit->lost ? iso__audit_recover(audit, fault) : 0;
    return error || !audit->torn ? error : take_back(audit, fault);
}

/* What has to be in order before a record can be written: files that are as they are known, an
 * anchor that is no more behind, a segment with room. */
static int prepare(struct iso_audit *audit, struct iso_fault *fault)
{
    const uint64_t limit = audit->options.segment_bytes;
    int error = iso__audit_settle(audit, fault);
    if (!error && audit->options.sync && iso_anchor_state(audit->anchor)->value < audit->last) {
        error = iso__audit_write_anchor(audit, fault);
    }
    if (!error && limit > 0 && (uint64_t)audit->size >= limit &&
        audit->last >= audit->segment_first) {
        error = iso__audit_rotate(audit, fault);
    }
    if (!error && iso__audit_reserve_mark(audit)) {
        error = iso_fault_set(fault, -ENOMEM, "%s: out of memory", audit->path);
    }
    return error;
}

static void tell(const struct iso_audit *audit, const struct iso_audit_record *record)
{
    if (audit->options.written) {
        char head[ISO_AUDIT_HEAD_SIZE];
        (void)sodium_bin2hex(head, sizeof head, audit->link.bytes, sizeof audit->link.bytes);
        audit->options.written(audit->options.context, record, audit->last, head);
    }
}

/* Writes the record that was formatted; *link is then the head behind it. */
static int write_record(struct iso_audit *audit, size_t size, struct iso_audit_link *link,
                        struct iso_fault *fault)
{
    const struct iso_heads known = iso_heads_now(iso_key_ring_board(audit->options.ring));
    *link = audit->link;
    const size_t length = iso_audit_line_close(&audit->seal, audit->last + 1, &known,
                                               audit->json.text, size, audit->line, link);
    const int error = iso__audit_write_line(audit, length);
    if (error) {
        (void)take_back(audit, NULL);
        return iso_storage_refused(audit->path, error, fault);
    }
    iso__audit_count_line(audit, length);
    return 0;
}

int iso_audit_append(struct iso_audit *audit, const struct iso_audit_record *record,
                     struct iso_fault *fault)
{
    struct iso_audit_link link;
    int error = prepare(audit, fault);
    const size_t size = error ? 0 : format(audit, record);
    if (!error && size == 0) {
        return iso_fault_set(fault, -EINVAL, "%s: the record is too long", audit->path);
    }
    error = error ? error : write_record(audit, size, &link, fault);
    if (error) {
        iso_storage_add(fault, "the record is not written");
        return error == -ENOSPC || error == -ENOMEM ? error : -EIO;
    }
    audit->link = link;
    if (record->gallery && record->gallery != audit->gallery) {
        (void)snprintf(audit->gallery, sizeof audit->gallery, "%s", record->gallery);
        audit->gallery_changes = record->gallery_changes;
    }
    if (audit->options.sync) {
        (void)!iso__audit_write_anchor(audit, NULL); /* or before the next record */
    }
    tell(audit, record);
    iso__audit_note_clock(audit, audit->json.text);
    explicit_bzero(audit->json.text, sizeof audit->json.text); /* it may name somebody */
    return 0;
}

/* ---- what is known ---- */

uint64_t iso_audit_last(const struct iso_audit *audit)
{
    return audit->last;
}

uint64_t iso_audit_first(const struct iso_audit *audit)
{
    return audit->first;
}

uint64_t iso_audit_gallery_changes(const struct iso_audit *audit, const char *gallery)
{
    return strcmp(audit->gallery, gallery) == 0 ? audit->gallery_changes : 0;
}

int iso_audit_renew_anchor(struct iso_audit *audit, struct iso_fault *fault)
{
    const int error = iso__audit_write_anchor(audit, fault);
    return error ? error : iso__audit_write_anchor(audit, fault); /* both of its slots */
}
