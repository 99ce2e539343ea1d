/* Writes the audit log in a thread of its own, so that callers wait for the disk only if they have
 * to.
 *
 * Records wait in a queue of ISO_AUDIT_WRITER_RECORDS, and are written in the order in which they
 * came. The log gives them their sequences when it writes them, so that the chain has no gap. A
 * record has the time at which it was queued, unless it has a time already. The thread takes all
 * queued records as one group and synchronises them together (iso_audit_append_group), so that the
 * speed of the disk limits the number of groups in a second, and not that of records. Posting a
 * record returns at once. Appending a record waits until its group is on the disk, but no longer
 * than the caller says. A record for which no caller waits any more is taken out of the queue if
 * its writing has not begun.
 *
 * The last two places of the queue are for a record that is appended and for its outcome. So posted
 * records, however many, never prevent a grant from being queued.
 *
 * A posted record that finds no place, or that cannot be written, is lost. The losses are counted,
 * and the log gets a record "records-lost" with their number as soon as it can be written again.
 * The contents of the lost records are not kept.
 *
 * Without a thread, every call writes before it returns, in the thread of its caller: for clocks
 * that are injected. With it, all calls but new and free may come from any thread; only one thread
 * appends. A call that uses the disk (append, hold) must not come from a thread on which the door
 * depends. */
#ifndef ISO_FIRMWARE_AUDIT_AUDIT_WRITER_H
#define ISO_FIRMWARE_AUDIT_AUDIT_WRITER_H

#include "firmware/audit/audit.h"

enum { ISO_AUDIT_WRITER_RECORDS = 128 };

struct iso_audit_writer;

/* Makes a writer. The log and the times are borrowed, and must outlive it. While it exists, others
 * may use the log only between hold and release. -ENOMEM, -EAGAIN no thread can be had. */
int iso_audit_writer_new(struct iso_audit *audit, const struct iso_times *times, bool threaded,
                         struct iso_audit_writer **out) __attribute__((warn_unused_result));

/* Writes all queued records, which takes as long as the disk needs; then frees the writer. NULL is
 * accepted. */
void iso_audit_writer_free(struct iso_audit_writer *writer);

/* Queues a copy of a record without waiting. -ENOBUFS the queue is full, -EINVAL the record is too
 * long; without a thread the errors of iso_audit_append. After an error the record is lost, and
 * counted. */
int iso_audit_writer_post(struct iso_audit_writer *writer, const struct iso_audit_record *record,
                          struct iso_fault *fault) __attribute__((warn_unused_result));

/* Queues a record and waits for at most wait_ns (ISO_NEVER_NS: as long as it takes) until it is on
 * the disk. *sequence (may be NULL) is then its number.
 *   -ETIMEDOUT it was not in time. It may get to the disk later: what it announces must not happen,
 *              and the outcome that the caller posts has to say so
 *   -ENOBUFS   the queue is full: records that were appended before wait for the disk
 * and the errors of iso_audit_append. */
int iso_audit_writer_append(struct iso_audit_writer *writer, const struct iso_audit_record *record,
                            int64_t wait_ns, uint64_t *sequence, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Posts the outcome of the record that was appended last. One place in the queue is reserved for
 * it, so that it is not lost after an append that found a place. Its member `grant` becomes the
 * sequence of that record, or 0 if that record was not written. Errors as of post. */
int iso_audit_writer_post_outcome(struct iso_audit_writer *writer,
                                  const struct iso_audit_record *record, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The sequence of the last record that was written. Does not wait. */
uint64_t iso_audit_writer_last(struct iso_audit_writer *writer);

/* The result of the posted records that were finished or refused since the last call. False: there
 * were none. *error: 0, or the error of the newest lost record, with its fault. */
bool iso_audit_writer_take_result(struct iso_audit_writer *writer, int *error,
                                  struct iso_fault *fault);

/* Waits until all queued records are written, and lends the log until release. */
struct iso_audit *iso_audit_writer_hold(struct iso_audit_writer *writer);
void iso_audit_writer_release(struct iso_audit_writer *writer);

#endif
