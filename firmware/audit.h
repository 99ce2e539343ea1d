/* The audit log: what the appliance did and why, append-only, one JSON object a line.
 *
 *   {"sequence":17,"time":"2026-11-21T08:30:15.250Z","monotonic_ns":81250000000,"event":"visit",
 *    "person":"anna","verdict":"allow","reason":"match","score":7.25,"threshold":4,"frames":2}
 *
 * Sequence and line number are the same: 1, 2, ...; every line begins with its sequence, so that a
 * line that is missing, doubled or out of place is found at open. It holds no biometric data: no
 * template, no frame, no landmark. Later versions add a member that chains each line to the one
 * before it; readers ignore members they do not know.
 *
 * A record is written by one write(); with `sync` it is on the disk when append returns. A record
 * that does not fit on the disk leaves nothing behind. A line that was cut short by a crash is
 * taken away at the next open, which is itself put on record (if there is room). One process at a
 * time has the log. */
#ifndef ISO_FIRMWARE_AUDIT_H
#define ISO_FIRMWARE_AUDIT_H

#include <stdbool.h>
#include <stdint.h>

#include "core/fault.h"
#include "firmware/times.h"

/* What the caller has to say; members that are NULL, NaN or negative are left out. */
struct iso_audit_record {
    const char *event; /* REQUIRED: "start", "visit", "door", ... */
    const char *person, *verdict, *reason, *note;
    double score, threshold;
    int frames, attack_frames;
};

/* A record of an event and nothing more. */
struct iso_audit_record iso_audit_record_of(const char *event);

struct iso_audit;

/* Opens the log, or begins one; times must outlive it. -EBADMSG a line is damaged or out of order
 * (the fault says which, and what to do), -EBUSY another process has it, -ENOSPC, -EACCES, -EROFS,
 * -ENOENT (no such directory), -EIO, -ENOMEM. */
int iso_audit_open(const char *path, bool sync, const struct iso_times *times,
                   struct iso_audit **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));
void iso_audit_close(struct iso_audit *audit);

/* Writes a record. What it stands for must not happen if this fails: -ENOSPC the disk is full, -EIO
 * it cannot be written or synchronised, -ENOMEM, -EINVAL it is too long. */
int iso_audit_append(struct iso_audit *audit, const struct iso_audit_record *record,
                     struct iso_fault *fault) __attribute__((warn_unused_result));

/* Sequence of the last record, 0 if there is none. */
uint64_t iso_audit_last(const struct iso_audit *audit);

/* Hands out at most `max` lines (without newline) from sequence `from` on; ends early if `each`
 * returns non-zero, which is then the result. -EIO. */
int iso_audit_read(struct iso_audit *audit, uint64_t from, uint32_t max,
                   int (*each)(void *context, const char *line), void *context)
    __attribute__((warn_unused_result));

#endif
