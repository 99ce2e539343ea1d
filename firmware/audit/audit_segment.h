/* The files of the audit log: the segment that is written, and closed ones beside it, named by
 * their first record (PATH.00000000000000000001). Internal to the log. */
#ifndef ISO_FIRMWARE_AUDIT_AUDIT_SEGMENT_H
#define ISO_FIRMWARE_AUDIT_AUDIT_SEGMENT_H

#include <limits.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "core/base/fault.h"
#include "firmware/audit/audit_line.h"
#include "firmware/keys/key_ring.h"

enum { ISO_AUDIT_SEGMENTS_MAX = 64 };

struct iso_audit_segments {
    size_t n;
    uint64_t first[ISO_AUDIT_SEGMENTS_MAX]; /* in ascending order */
};

/* The path of a closed segment; -ENAMETOOLONG. */
int iso_audit_segment_path(const char *path, uint64_t first, char out[PATH_MAX],
                           struct iso_fault *fault) __attribute__((warn_unused_result));

/* Finds the closed segments of the log at `path`. -E2BIG there are too many, or the errno of
 * reading the directory. */
int iso_audit_segments_find(const char *path, struct iso_audit_segments *out,
                            struct iso_fault *fault) __attribute__((warn_unused_result));

/* Reads a segment, record by record. */
struct iso_audit_reader {
    FILE *file;
    struct iso_audit_seal seal;
    struct iso_audit_header header;
    uint64_t next;  /* sequence of the next record */
    off_t position; /* where the next record begins; at the end: the end of complete lines */
    size_t torn;    /* bytes after the last complete line, once the end is reached */
    struct iso_audit_link link; /* the next record has to begin with it, except after a seek */
    bool sought;
    struct iso_audit_opened record; /* the last record that was read */
    char line[ISO_AUDIT_LINE_MAX + 2];
    const char *flaw; /* description of the flaw; NULL: none */
};

/* Opens a segment and reads its header. -EBADMSG with ->flaw set if it is not a regular file, has
 * no valid header, or its key is not in the ring; else the errno of opening. Call
 * iso_audit_reader_close in any case. */
int iso_audit_reader_open(struct iso_audit_reader *reader, const char *path,
                          const struct iso_key_ring *ring) __attribute__((warn_unused_result));

/* Closes the file, if it is open, and wipes the reader. */
void iso_audit_reader_close(struct iso_audit_reader *reader);

/* Reads a record into ->record. Returns 1, or 0 at the end; -EBADMSG with ->flaw set if it is not
 * the next one in the chain, -EIO. */
int iso_audit_reader_next(struct iso_audit_reader *reader) __attribute__((warn_unused_result));

/* Skips records, without opening them, until `sequence` comes next. The chain of the skipped
 * records is not checked. `position` is that of an earlier record, of sequence `at`; 0: the first
 * of the segment. Returns 0 or -EIO. */
int iso_audit_reader_seek(struct iso_audit_reader *reader, uint64_t at, off_t position,
                          uint64_t sequence) __attribute__((warn_unused_result));

#endif
