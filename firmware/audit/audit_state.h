/* What an open log holds. Internal to firmware/audit. */
#ifndef ISO_FIRMWARE_AUDIT_AUDIT_STATE_H
#define ISO_FIRMWARE_AUDIT_AUDIT_STATE_H

#include <sys/types.h>

#include "firmware/audit/anchor.h"
#include "firmware/audit/audit.h"
#include "firmware/audit/audit_segment.h"

/* Every so many lines the place of one is remembered, so that reading need not begin at the first.
 */
enum { ISO__AUDIT_MARK_LINES = 256 };

struct iso_audit {
    struct iso_audit_options options;
    const struct iso_times *times;
    char *path, *anchor_path;
    struct iso_anchor *anchor;
    struct iso_audit_segments closed;

    int fd; /* of the segment that is written */
    struct iso_audit_seal seal;
    uint64_t segment_first, first, last; /* sequences: of this segment, of the log, of its end */
    struct iso_audit_link link;          /* the head */
    off_t size;                          /* of the whole lines of this segment */
    bool opened;                         /* all of it was found sound */
    bool torn;                           /* part of a record may stand behind them */
    bool lost;                           /* which file has which name is not known */
    off_t *marks; /* marks[i]: where the line of sequence segment_first + i * MARK_LINES begins */
    size_t n_marks, mark_capacity;

    struct iso_heads known; /* what the newest record that was read knows of the other stores */
    uint64_t proved;        /* the anchor had this value at least, as records that were read say */
    char gallery[20];       /* that the newest record spoke of, and its changes */
    uint64_t gallery_changes;

    _Atomic int64_t latest_s; /* the latest date that the records know; any thread may ask */

    struct iso_json_line json;
    char line[ISO_AUDIT_LINE_MAX];
};

#define ISO__AUDIT_ANCHOR "log"

/* Whether the anchor has to be written for the number of the counter of the state. */
bool iso__audit_wants_number(const struct iso_audit *audit);

/* The anchor's state for the present head; sealing: a log in plain text is being sealed. */
struct iso_anchor_state iso__audit_anchor_state(const struct iso_audit *audit, bool sealing);
bool iso__audit_anchor_is_sealing(const struct iso_audit *audit);
bool iso__audit_anchor_is_lax(const struct iso_audit *audit);
int iso__audit_write_anchor(struct iso_audit *audit, struct iso_fault *fault);

/* What the anchor says: the first sequence that is kept; whether this is the link behind the last
 * one. */
uint64_t iso__audit_anchored_first(const struct iso_audit *audit);
bool iso__audit_is_anchored(const struct iso_audit *audit, const struct iso_audit_link *link);

/* Tells the board (heads.h) what was found, and what the anchor knows of the other stores. */
void iso__audit_tell_anchor(const struct iso_audit *audit);

/* Whether the closed segments are those that the anchor knows of; -ESTALE. closed: the segment that
 * was read last is one of them. */
int iso__audit_check_closed(const struct iso_audit *audit, bool closed, struct iso_fault *fault);

/* Takes note of the dates in a record's text. (audit_clock.c) */
void iso__audit_note_clock(struct iso_audit *audit, const char *text);

/* Room for the mark of the record that comes next; then the record of so many bytes. */
int iso__audit_reserve_mark(struct iso_audit *audit);
void iso__audit_count_line(struct iso_audit *audit, size_t bytes);

/* Synchronises a segment's file, if records are to be synchronised. A negative errno. */
int iso__audit_sync(const struct iso_audit *audit, int fd);

/* Writes the anchor, if it is behind the records and they are to be synchronised. An error of
 * storage_fault.h. */
int iso__audit_catch_up(struct iso_audit *audit, struct iso_fault *fault);

/* Reads a segment to its end: the head, and how many bytes stand behind the last whole line. The
 * errors of iso_audit_open. (audit_scan.c) */
int iso__audit_scan(struct iso_audit *audit, const char *path, size_t *torn,
                    struct iso_fault *fault);

/* Compares the end that was found with the anchor: it may be ahead of it by one group of records.
 * Then the anchor follows before the next record, and not here: it may be an old one, which the
 * other stores know. closed: what was read is a closed segment, since there is no other. -ESTALE,
 * or an error of writing the anchor. (audit_scan.c) */
int iso__audit_check_end(struct iso_audit *audit, bool closed, struct iso_fault *fault);

/* Describes that the log is not of this time, with that code: returns -ESTALE. (audit_scan.c) */
int iso__audit_stale(const struct iso_audit *audit, enum iso_fault_code code, const char *what,
                     struct iso_fault *fault);

/* A segment that begins behind the present head, under the newest key, in the open file `fd`; 0
 * with it on the disk. */
int iso__audit_begin_segment(struct iso_audit *audit, int fd, struct iso_fault *fault);

/* Opens PATH or what is beside it for appending, with the lock. */
int iso__audit_open_file(const char *path, int flags, int *fd, struct iso_fault *fault);

/* Opens the log again, so that what is known of it is what the disk holds; until that succeeds the
 * log is lost, and nothing is written to it. -ESTALE it has not all the records that were written,
 * else as iso_audit_open. (audit_truth.c) */
int iso__audit_recover(struct iso_audit *audit, struct iso_fault *fault);

/* Brings files and memory together again after a fault of the disk: a lost log is opened anew, part
 * of a record is taken away. 0 also if there is nothing to do. */
int iso__audit_settle(struct iso_audit *audit, struct iso_fault *fault);

/* Closes the segment and begins another; the oldest ones go. (audit_rotate.c) */
int iso__audit_rotate(struct iso_audit *audit, struct iso_fault *fault);

/* Forgets closed segments beyond what is kept, and those that a kill left. (audit_rotate.c) */
int iso__audit_prune(struct iso_audit *audit, struct iso_fault *fault);

/* Exchanges a log in plain text at audit->fd for a sealed one. (audit_migrate.c) */
int iso__audit_migrate(struct iso_audit *audit, struct iso_fault *fault);

#endif
