/* The audit log: what the appliance did and why, append-only; each record is one JSON object.
 *
 *   {"sequence":17,"time":"2026-11-21T08:30:15.250Z","monotonic_ns":81250000000,"event":"visit",
 *    "person":"anna","verdict":"allow","reason":"match","score":7.25,"threshold":4,"frames":2}
 *
 * Sequences are 1, 2, ... without a gap. It holds no biometric data: no template, no frame, no
 * landmark. On the disk every record is sealed, because it has names in it, and chained to the
 * record before it (audit_line.h). An anchor (anchor.h) beside it, PATH.anchor, has the last
 * sequence and the head of the chain. So an edit, a gap, a repetition and a missing end are found:
 * in the segment that is written when the log is opened, and in all segments by iso_audit_verify.
 * anchor.h says what cannot be found.
 *
 * The log is bounded: a full segment is closed and renamed to PATH.FIRST, and the oldest segments
 * are deleted with their keys. The first record of a segment ("log-rotated") says so.
 *
 * A record is written by one write(); with `sync` the record and the anchor are on the disk when
 * append returns. Records that are appended as a group are synchronised together: if that fails,
 * none of them is written; a crash leaves the first few of them, or none. Without `sync` the
 * anchor is written only at open, at close and with each segment, so that it never reaches the
 * disk before the records that it counts; then a missing end is found only up to that point. A
 * record that does not fit on the disk leaves nothing behind. A line that a crash has cut short is
 * removed at the next open, and a record says so (if there is room). Only one process at a time
 * can open the log. / */
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
    const char *sensor; /* its health at a decision: "started", "silent", "repeats", "lost" */
    /* Of a visit with the verdict "allow": what the door did (iso_door_answer_name), why if it did
     * not unlock, and the sequence of the "grant" record that was written before the lock was
     * switched (0: not said). */
    const char *door, *door_fault;
    uint64_t grant;
    const char *before, *after; /* what an administrator changed: the old and the new value */
    double score, threshold;
    int frames, attack_frames;
    /* Which gallery, and its number of changes (iso_gallery_version), by which a gallery that is
     * put back later is recognised. NULL, 0: not said. */
    const char *gallery;
    uint64_t gallery_changes;
    /* When it happened, by both clocks; 0, 0: when the record is written. */
    int64_t wall_ns, monotonic_ns;
};

/* A record of an event and nothing more. */
struct iso_audit_record iso_audit_record_of(const char *event);

enum { ISO_AUDIT_HEAD_SIZE = 65 }; /* 64 hexadecimal digits, with their end */

struct iso_audit_options {
    const char *path;
    bool sync;
    uint64_t segment_bytes; /* a segment is closed when it is as long; 0: never */
    int segments;           /* closed ones that are kept, at most 60 */
    bool migrate; /* a log of the version before, in plain text, is sealed at the first start */
    struct iso_key_ring *ring; /* outlives the log */
    /* Outlives the log; its number stands in the anchor. NULL: the number stays what it was. */
    struct iso_state_counter *counter;
    /* Called for every record after it was written, with the head of the log after it. It must not
     * wait for anything, because callers wait for the record and for the log. NULL: no call. */
    void (*written)(void *context, const struct iso_audit_record *record, uint64_t sequence,
                    const char *head);
    void *context;
};

struct iso_audit;

/* Opens the log, or begins one; times must outlive it.
 *   -EBADMSG a record was changed or is out of order (the fault says which, and what to do)
 *   -ESTALE  its end is missing, its anchor is gone or old, or it is not sealed any more
 *   -EKEYREJECTED the key ring has not the key for it
 *   -EBUSY another process has it; -ENOSPC, -EACCES, -EROFS, -ENOENT (no such directory), -EIO,
 *   -ENOMEM */
int iso_audit_open(const struct iso_audit_options *options, const struct iso_times *times,
                   struct iso_audit **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));
void iso_audit_close(struct iso_audit *audit);

/* Writes a record. If this fails, what the record announces must not happen: -ENOSPC the disk is
 * full, -EIO it cannot be written or synchronised, -ENOMEM, -EINVAL it is too long. */
int iso_audit_append(struct iso_audit *audit, const struct iso_audit_record *record,
                     struct iso_fault *fault) __attribute__((warn_unused_result));

/* One record of a group, and what became of it. */
struct iso_audit_entry {
    const struct iso_audit_record *record; /* the caller's, until the group is written */
    uint64_t sequence;                     /* its number; 0: it was not written */
    int error;                             /* why it was not, as of iso_audit_append; else 0 */
    struct iso_fault fault;                /* the same in words */
    char head[ISO_AUDIT_HEAD_SIZE];        /* of the log behind the record */
};

/* Writes n records in their order and synchronises them together, so that many cost no more time
 * than one. A record that cannot be written (it is too long, the disk is full) does not keep the
 * others from being written; if they cannot be synchronised none is. A group that reaches the end
 * of a segment becomes two. The entries say what became of each. */
void iso_audit_append_group(struct iso_audit *audit, struct iso_audit_entry *entries, size_t n);

/* Sequence of the last record, 0 if there is none; of the first that is kept. */
uint64_t iso_audit_last(const struct iso_audit *audit);
uint64_t iso_audit_first(const struct iso_audit *audit);

/* The newest number of changes that the log knows of this gallery; 0 if it does not know it. */
uint64_t iso_audit_gallery_changes(const struct iso_audit *audit, const char *gallery);

/* The latest date that any of its records has, or knew, in seconds since 1970; 0 if it has none. A
 * record "clock" with the reason "accepted" begins anew with its own date. */
int64_t iso_audit_latest_s(const struct iso_audit *audit);

/* Hands out at most `max` records (without newline) from sequence `from` on; ends early if `each`
 * returns non-zero, which is then the result. -EIO, -EBADMSG, -ENOMEM. */
int iso_audit_read(struct iso_audit *audit, uint64_t from, uint32_t max,
                   int (*each)(void *context, const char *line), void *context)
    __attribute__((warn_unused_result));

/* Closes the segment that is written, and goes on with a new key. */
int iso_audit_rotate_key(struct iso_audit *audit, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Seals the anchor with the newest key of the ring, so that older ones can be dropped. */
int iso_audit_renew_anchor(struct iso_audit *audit, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* What a look at every record found. */
struct iso_audit_report {
    uint64_t first, last; /* as they should be: the oldest that is kept, the newest */
    char head[ISO_AUDIT_HEAD_SIZE];
    bool sound;
    uint64_t flaw_at; /* not sound: the sequence where it begins */
    char flaw[160];   /* ... and what it is: "record 17 was changed, ..." */
};

/* Looks at every record of every segment. known_head (not NULL): what was noted as the head behind
 * record known_sequence; a log that does not have it is another one, or an old one. The listener is
 * told of records. 0 also for a log that is not sound; -ENOMEM, -EIO. */
int iso_audit_verify(struct iso_audit *audit, uint64_t known_sequence, const char *known_head,
                     const struct iso_work_listener *listener, struct iso_audit_report *out,
                     struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
