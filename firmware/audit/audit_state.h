/* The state of an open log. Internal to firmware/audit. */
#ifndef ISO_FIRMWARE_AUDIT_AUDIT_STATE_H
#define ISO_FIRMWARE_AUDIT_AUDIT_STATE_H

#include <sys/types.h>

#include "firmware/audit/anchor.h"
#include "firmware/audit/audit.h"
#include "firmware/audit/audit_segment.h"

/* The position of every line whose number in its segment is a multiple of this is remembered, so
 * that reading need not begin at the first line. */
enum { ISO__AUDIT_MARK_LINES = 256 };

struct iso_audit {
    struct iso_audit_options options;
    const struct iso_times *times;
    char *path, *anchor_path;
    struct iso_anchor *anchor;
    struct iso_audit_segments closed;

    int fd; /* the segment that is written */
    struct iso_audit_seal seal;
    uint64_t segment_first, first, last; /* sequences: first of this segment, of the log; last */
    struct iso_audit_link link;          /* the head of the log */
    off_t size;                          /* size of the complete lines of this segment */
    bool opened;                         /* iso_audit_open has succeeded */
    bool torn;                           /* a part of a record may follow the complete lines */
    bool lost;                           /* it is not known which file has which name */
    off_t *marks; /* marks[i]: where the line of sequence segment_first + i * MARK_LINES begins */
    size_t n_marks, mark_capacity;

    struct iso_heads known; /* the knowledge of the newest record about the other stores */
    uint64_t proved;  /* records that were read prove that the anchor had at least this value */
    char gallery[20]; /* the gallery in the newest record that names one, and its changes */
    uint64_t gallery_changes;

    _Atomic int64_t latest_s; /* the latest date in the records; any thread may read it */

    struct iso_json_line json;
    char line[ISO_AUDIT_LINE_MAX];
};

#define ISO__AUDIT_ANCHOR "log"

/* Whether the anchor has to be written because of the number of the counter of the state. */
bool iso__audit_wants_number(const struct iso_audit *audit);

/* The anchor's state for the present head. sealing: a log in plain text is being sealed. Then:
 * whether the anchor that was read says so, whether it was written without synchronising records
 * (lax), and the writing of the anchor (errors of storage_fault.h). */
struct iso_anchor_state iso__audit_anchor_state(const struct iso_audit *audit, bool sealing);
bool iso__audit_anchor_is_sealing(const struct iso_audit *audit);
bool iso__audit_anchor_is_lax(const struct iso_audit *audit);
int iso__audit_write_anchor(struct iso_audit *audit, struct iso_fault *fault);

/* Parts of the anchor: the first sequence that is kept, and whether `link` is the link after the
 * last record. */
uint64_t iso__audit_anchored_first(const struct iso_audit *audit);
bool iso__audit_is_anchored(const struct iso_audit *audit, const struct iso_audit_link *link);

/* Tells the board (heads.h) what was found, and what the anchor knows of the other stores. */
void iso__audit_tell_anchor(const struct iso_audit *audit);

/* Checks that the closed segments are those that the anchor counts; -ESTALE. closed: the segment
 * that was read last is one of them. */
int iso__audit_check_closed(const struct iso_audit *audit, bool closed, struct iso_fault *fault);

/* Uses the dates in a record's text. (audit_clock.c) */
void iso__audit_note_clock(struct iso_audit *audit, const char *text);

/* Makes room for the mark of the next record (-ENOMEM). Then counts a record of so many bytes. */
int iso__audit_reserve_mark(struct iso_audit *audit);
void iso__audit_count_line(struct iso_audit *audit, size_t bytes);

/* Synchronises a segment's file if records are to be synchronised. Returns a negative errno on
 * failure. */
int iso__audit_sync(const struct iso_audit *audit, int fd);

/* Writes the anchor if it is behind the records and they are to be synchronised. An error of
 * storage_fault.h. */
int iso__audit_catch_up(struct iso_audit *audit, struct iso_fault *fault);

/* Reads a segment to its end. Finds the head, and how many bytes follow the last complete line.
 * Errors of iso_audit_open. (audit_scan.c) */
int iso__audit_scan(struct iso_audit *audit, const char *path, size_t *torn,
                    struct iso_fault *fault);

/* Compares the end that was found with the anchor, which may be behind by one group of records.
 * Then the anchor is written before the next record, and not here, because it may be an old one;
 * the other stores can tell. It is written here only if records were not synchronised, if that
 * setting has changed, or if sealing was interrupted. closed: the segment that was read is a closed
 * one, because there is no other. -ESTALE, or an error of writing the anchor. (audit_scan.c) */
int iso__audit_check_end(struct iso_audit *audit, bool closed, struct iso_fault *fault);

/* Sets the fault of a log that is not of this time, with that code. Returns -ESTALE.
 * (audit_scan.c) */
int iso__audit_stale(const struct iso_audit *audit, enum iso_fault_code code, const char *what,
                     struct iso_fault *fault);

/* Writes the header of a segment that follows the present head, with the newest key, into the open
 * file `fd`. Returns 0 when it is on the disk. */
int iso__audit_begin_segment(struct iso_audit *audit, int fd, struct iso_fault *fault);

/* Opens PATH, or the file beside it, for appending, and locks it. Makes the file if it does not
 * exist. -EBUSY another process has it, or an errno of opening. */
int iso__audit_open_file(const char *path, int flags, int *fd, struct iso_fault *fault);

/* Opens the log again, so that the memory agrees with the disk. Until that succeeds the log is
 * lost, and nothing is written to it. -ESTALE records that were written are missing; else the
 * errors of iso_audit_open. (audit_truth.c) */
int iso__audit_recover(struct iso_audit *audit, struct iso_fault *fault);

/* Brings files and memory together again after a fault of the disk: opens a lost log again, and
 * removes a part of a record. Returns 0 also if there is nothing to do. */
int iso__audit_settle(struct iso_audit *audit, struct iso_fault *fault);

/* Closes the segment, begins another one, and deletes the oldest ones. (audit_rotate.c) */
int iso__audit_rotate(struct iso_audit *audit, struct iso_fault *fault);

/* Deletes closed segments beyond the number that is kept, and those that remained after a kill.
 * (audit_rotate.c) */
int iso__audit_prune(struct iso_audit *audit, struct iso_fault *fault);

/* Replaces a log in plain text at audit->fd by a sealed one. (audit_migrate.c) */
int iso__audit_migrate(struct iso_audit *audit, struct iso_fault *fault);

#endif
