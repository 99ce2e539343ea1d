/* The audit log: what the appliance did and why, append-only; each record is one JSON object.
 *
 *   {"sequence":17,"time":"2026-11-21T08:30:15.250Z","monotonic_ns":81250000000,"event":"visit",
 *    "person":"anna","verdict":"allow","reason":"match","score":7.25,"threshold":4,"frames":2}
 *
 * Sequences are 1, 2, ... without a gap. The log contains no biometric data: no template, no frame,
 * no landmark. On the disk every record is sealed, because it may contain names, and chained to the
 * record before it (audit_line.h). An anchor (anchor.h) beside it, PATH.anchor, has the last
 * sequence and the head of the chain. So an edit, a gap, a repetition and a missing end are
 * detected: when the log is opened, in its newest segment; by iso_audit_verify, in all segments.
 * anchor.h says what cannot be detected.
 *
 * The log is bounded: a full segment is closed and renamed to PATH.FIRST, and the oldest segments
 * are deleted with their keys. The first record of a segment ("log-rotated") says so.
 *
 * A record is written by one write(); with `sync` the record and the anchor are on the disk when
 * append returns. Records that are appended as a group are synchronised together: if that fails,
 * none of them is written; a crash leaves all of them, the first few, or none. Without `sync` the
 * anchor is written only at open, at close and with each segment, so that it never reaches the
 * disk before the records that it counts; then a missing end is found only up to that point. A
 * record that does not fit on the disk leaves nothing behind. A line that a crash has cut short is
 * removed at the next open, and a record says so (if there is room). Only one process at a time
 * can open the log. */
#ifndef ISO_FIRMWARE_AUDIT_AUDIT_H
#define ISO_FIRMWARE_AUDIT_AUDIT_H

#include <stdbool.h>
#include <stdint.h>

#include "core/base/fault.h"
#include "drivers/base/times.h"
#include "firmware/contract/work_listener.h"
#include "firmware/keys/key_ring.h"
#include "firmware/keys/state_counter.h"

/* The contents of a record. Members that are NULL, NaN or negative are left out. */
struct iso_audit_record {
    const char *event; /* REQUIRED: "start", "visit", "door", ... */
    const char *person, *verdict, *reason, *note;
    const char *sensor; /* its state at a decision: "started", "silent", "repeats", "lost" */
    /* Of a visit with the verdict "allow": what the door did (iso_door_answer_name), why it did not
     * unlock (NULL: it did), and the sequence of the "grant" record that was written before the
     * lock was switched (0: not known). */
    const char *door, *door_fault;
    uint64_t grant;
    const char *before, *after; /* the old and the new value of what an administrator changed */
    double score, threshold;
    int frames, attack_frames;
    /* The gallery and its number of changes (iso_gallery_version). They show later whether an old
     * gallery was put back. NULL, 0: not known. */
    const char *gallery;
    uint64_t gallery_changes;
    /* The time of the event by both clocks. 0, 0: the time at which the record is written. */
    int64_t wall_ns, monotonic_ns;
};

/* A record that has an event and no other member. */
struct iso_audit_record iso_audit_record_of(const char *event);

enum { ISO_AUDIT_HEAD_SIZE = 65 }; /* 64 hexadecimal digits and a NUL */

struct iso_audit_options {
    const char *path;
    bool sync;
    uint64_t segment_bytes; /* a segment of this size is closed; 0: never */
    int segments;           /* closed segments that are kept, at most 60 */
    bool migrate; /* seal a log of the previous version, in plain text, at the first start */
    struct iso_key_ring *ring; /* outlives the log */
    /* Outlives the log; the anchor of the log contains its number. NULL: the number stays as it
     * was. */
    struct iso_state_counter *counter;
    /* Called for every record after it was written, with the head of the log after it. It must not
     * wait, because callers wait for the record and for the log. NULL: no call. */
    void (*written)(void *context, const struct iso_audit_record *record, uint64_t sequence,
                    const char *head);
    void *context;
};

struct iso_audit;

/* Opens the log, or begins one; times must outlive it.
 *   -EBADMSG a record was changed or is out of order (the fault names it, and the remedy)
 *   -ESTALE  its end is missing, its anchor is gone or old, or it is no longer sealed
 *   -EKEYREJECTED the key ring does not have its key
 *   -EBUSY another process has it; -ENOSPC, -EACCES, -EROFS, -ENOENT (no such directory), -EIO,
 *   -ENOMEM */
int iso_audit_open(const struct iso_audit_options *options, const struct iso_times *times,
                   struct iso_audit **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Writes the anchor if it is behind; then closes, wipes and frees the log. NULL is accepted. */
void iso_audit_close(struct iso_audit *audit);

/* Writes a record. If this fails, the act that the record announces must not happen. -ENOSPC the
 * disk is full, -EIO it cannot be written or synchronised, -ENOMEM, -EINVAL it is too long. */
int iso_audit_append(struct iso_audit *audit, const struct iso_audit_record *record,
                     struct iso_fault *fault) __attribute__((warn_unused_result));

/* One record of a group, and its result. */
struct iso_audit_entry {
    const struct iso_audit_record *record; /* the caller keeps it until the group is written */
    uint64_t sequence;                     /* its sequence; 0: it was not written */
    int error;                      /* the error of iso_audit_append for this record, else 0 */
    struct iso_fault fault;         /* the same error as a text */
    char head[ISO_AUDIT_HEAD_SIZE]; /* head of the log after this record */
};

/* Writes n records in order and synchronises them together, so that many records take no more time
 * than one. A record that cannot be written (it is too long, the disk is full) does not prevent the
 * others from being written. If they cannot be synchronised, none is written. A group that reaches
 * the end of a segment is split; then this applies to each part. The entries contain the results.
 */
void iso_audit_append_group(struct iso_audit *audit, struct iso_audit_entry *entries, size_t n);

/* Sequence of the last record, 0 if there is none; sequence of the oldest record that is kept. */
uint64_t iso_audit_last(const struct iso_audit *audit);
uint64_t iso_audit_first(const struct iso_audit *audit);

/* The newest number of changes of this gallery that the log contains; 0 if the log does not contain
 * the gallery. */
uint64_t iso_audit_gallery_changes(const struct iso_audit *audit, const char *gallery);

/* The latest date in any of its records, in seconds since 1970; 0 if there is none. A record
 * "clock" with the reason "accepted" starts again with its own date. */
int64_t iso_audit_latest_s(const struct iso_audit *audit);

/* Passes at most `max` records (without newline) from sequence `from` on to `each`. Ends early if
 * `each` returns non-zero, and returns that value. -EIO, -EBADMSG, -ENOMEM; after a fault of the
 * disk also the errors of iso_audit_open. */
int iso_audit_read(struct iso_audit *audit, uint64_t from, uint32_t max,
                   int (*each)(void *context, const char *line), void *context)
    __attribute__((warn_unused_result));

/* Closes the present segment, and goes on with a new key. Closed segments stay sealed with their
 * keys, which are dropped with them. Errors of the key ring and of iso_audit_append. */
int iso_audit_rotate_key(struct iso_audit *audit, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Seals the anchor with the newest key of the ring, so that older keys can be dropped. */
int iso_audit_renew_anchor(struct iso_audit *audit, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The result of a check of every record. */
struct iso_audit_report {
    uint64_t first, last; /* the expected ones: the oldest that is kept, the newest */
    char head[ISO_AUDIT_HEAD_SIZE];
    bool sound;
    uint64_t flaw_at; /* if not sound: the first sequence with a flaw */
    char flaw[160];   /* description of the flaw: "record 17 was changed, ..." */
};

/* Checks every record of every segment. known_head (not NULL) is a head that was noted after record
 * known_sequence. A log that does not have it is another log, or an old one. The listener counts
 * records. Returns 0 also for a log that is not sound; -ENOMEM, -EIO. */
int iso_audit_verify(struct iso_audit *audit, uint64_t known_sequence, const char *known_head,
                     const struct iso_work_listener *listener, struct iso_audit_report *out,
                     struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
