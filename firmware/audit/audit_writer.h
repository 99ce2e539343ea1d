/* Writes the audit log in a thread of its own, so that only callers wait for the disk that have
 * to.
 *
 * Records wait in a queue of ISO_AUDIT_WRITER_RECORDS, and are written in the order in which they
 * came; the log gives them their sequences when it writes them, so that the chain has no gap. A
 * record bears the time at which it was queued, unless it has one already. The thread takes all
 * records that are queued as one group and synchronises them together (iso_audit_append_group), so
 * that the speed of the disk bounds the number of groups in a second, and not that of records.
 * Posting a record returns at once. Appending a record waits until its group is on the disk, but
 * no longer than the caller says. A record that nobody waits for any more is taken out of the
 * queue if its writing has not begun.
 *
 * The last two places of the queue are for a record that is appended and for its outcome: posted
 * records, however many, never keep a grant from being queued.
 *
 * A posted record that finds no place, and one that cannot be written, is lost; the losses are
 * counted, and the log has a record "records-lost" with their number as soon as it can be written
 * again. What the lost records said is not kept.
 *
 * Without a thread every call writes before it returns, by the one who calls: for clocks that are
 * injected. With it all calls but new and free may come from any thread; only one thread appends.
 * A call that has to do with the disk (append, hold) must not come from a thread that the door
 * depends on. */
#ifndef ISO_FIRMWARE_AUDIT_AUDIT_WRITER_H
#define ISO_FIRMWARE_AUDIT_AUDIT_WRITER_H

#include "firmware/audit/audit.h"

enum { ISO_AUDIT_WRITER_RECORDS = 128 };

struct iso_audit_writer;

/* The log and the times are borrowed, and must outlive the writer; while it exists others use the
 * log between hold and release only. -ENOMEM, -EAGAIN no thread can be had. */
int iso_audit_writer_new(struct iso_audit *audit, const struct iso_times *times, bool threaded,
                         struct iso_audit_writer **out) __attribute__((warn_unused_result));

/* Writes what is queued before it ends; this takes as long as the disk does. NULL is fine. */
void iso_audit_writer_free(struct iso_audit_writer *writer);

/* Queues a copy of a record without waiting. -ENOBUFS the queue is full, -EINVAL the record is too
 * long; without a thread the errors of iso_audit_append. Then the record is lost, and counted. */
int iso_audit_writer_post(struct iso_audit_writer *writer, const struct iso_audit_record *record,
                          struct iso_fault *fault) __attribute__((warn_unused_result));

/* Queues a record and waits for at most wait_ns (ISO_NEVER_NS: as long as it takes) until it is on
 * the disk. *sequence (may be NULL) is then its number.
 *   -ETIMEDOUT it was not in time. It may get to the disk later: what it announces must not happen,
 *              and iso_audit_writer_post_outcome says so
 *   -ENOBUFS   the queue is full: records that were appended before wait for the disk
 * and the errors of iso_audit_append. */
int iso_audit_writer_append(struct iso_audit_writer *writer, const struct iso_audit_record *record,
                            int64_t wait_ns, uint64_t *sequence, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Posts what came of the record that was appended last: one place in the queue is kept for it, so
 * that it does not get lost behind an append that found a place. Its member `grant` becomes the
 * sequence of that record, or 0 if that one was not written. Errors as of post. */
int iso_audit_writer_post_outcome(struct iso_audit_writer *writer,
                                  const struct iso_audit_record *record, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The sequence of the last record that was written; waits for nothing. */
uint64_t iso_audit_writer_last(struct iso_audit_writer *writer);

/* What became of the posted records that were finished or refused since the last call. False: there
 * were none. *error: 0, or that of the newest one that is lost, with its fault. */
bool iso_audit_writer_take_result(struct iso_audit_writer *writer, int *error,
                                  struct iso_fault *fault);

/* Waits until everything that is queued is written, and lends the log until release. */
struct iso_audit *iso_audit_writer_hold(struct iso_audit_writer *writer);
void iso_audit_writer_release(struct iso_audit_writer *writer);

#endif
