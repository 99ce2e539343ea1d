/* Shows that a whole state directory was put back from an earlier time, by a counter in hardware
 * (drivers/counter/counter.h) that nobody can turn back. The knowledge of the stores about each
 * other (heads.h) cannot show that, because files that were on the disk together at one moment
 * agree.
 *
 * The anchor of the log has the counter's number. Since the stores know the log's head, and the
 * log theirs, this one number stands for all of them. To raise it takes two steps, in this order:
 *
 *   1. the anchor is written with the counter's value + 1, and is on the disk
 *   2. the counter is incremented
 *
 * After a kill between the two the anchor is one ahead of the counter, which is accepted and
 * caught up at the next start. An anchor behind the counter is one of an earlier time. So a copy
 * of the directory can be used only until the number is raised the next time.
 *
 * A counter in a TPM can be incremented some 100,000 times, and takes 10 to 100 ms each time. So
 * it is not raised for every record. (A daemon that its watchdog ends every 30 s would use 100,000
 * increments in 35 days.) It is raised
 *   - at the start, before anybody is let in, and at an orderly end
 *   - with a record of a change of the gallery, of the keys or of a lockdown, and with the record
 *     that stores were accepted
 *   - with the record of a lock-out, but not sooner than half an hour after the last time, because
 *     anybody at the door can cause lock-outs again and again, and must not wear out the TPM
 *   - with any other record when an hour has passed since the last time.
 *
 * The record makes the log write its anchor anyway, and the number is raised with it. A thread of
 * its own then increments the counter. Neither the door nor a visitor waits for it. While an
 * increment is under way, further changes wait for the record that comes after it.
 *
 * If the counter cannot be incremented while the appliance runs, the thread tries again and the
 * appliance goes on: the number stands still meanwhile, and so protects less. A start without the
 * counter is refused.
 *
 * Calls may come from any thread. */
#ifndef ISO_FIRMWARE_KEYS_STATE_COUNTER_H
#define ISO_FIRMWARE_KEYS_STATE_COUNTER_H

#include <stdbool.h>
#include <stdint.h>

#include "core/base/fault.h"
#include "drivers/base/times.h"
#include "drivers/counter/counter.h"

/* The largest number: the anchor has 32 bits for it. A TPM does not reach it in its lifetime,
 * because its counters begin near 0. */
#define ISO_STATE_COUNTER_MOST UINT64_C(0xfffffff0)

struct iso_state_counter;

/* Takes over the device, which it closes at its end; times must outlive it. -ENOMEM; then the
 * device still belongs to the caller. */
int iso_state_counter_new(const struct iso_counter *counter, const struct iso_times *times,
                          struct iso_state_counter **out) __attribute__((warn_unused_result));

/* Ends the thread, after one more attempt to increment a counter that is behind the anchor. NULL is
 * fine. */
void iso_state_counter_free(struct iso_state_counter *counter);

/* ---- at the start ---- */

/* Reports the number in the anchor as it was found; 0: the anchor never had one. Has no effect once
 * the counter has begun. */
void iso_state_counter_found(struct iso_state_counter *counter, uint32_t number);

/* Compares the number that was found with the counter. `path` names the state in faults. Returns 0
 * if they agree, or if neither exists yet. -ESTALE the state is of an earlier time, or its counter
 * is missing or is another one, so an administrator has to decide; -ERANGE the counter is beyond
 * ISO_STATE_COUNTER_MOST; else the errors of struct iso_counter_ops, except -ENOENT. */
int iso_state_counter_check(struct iso_state_counter *counter, const char *path,
                            struct iso_fault *fault) __attribute__((warn_unused_result));

/* Begins to count, whatever the number was, and makes the counter if it does not exist. The next
 * anchor that is written has a new number. Call it after a successful check, or when an
 * administrator accepts the state. Errors as of check, except -ESTALE. */
int iso_state_counter_begin(struct iso_state_counter *counter, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Leaves the increments to a thread from now on. Without the thread, the call which reports that
 * the anchor was written increments the counter before it returns, for clocks that are injected.
 * -EAGAIN, -ENOMEM no thread can be had. */
int iso_state_counter_start_thread(struct iso_state_counter *counter)
    __attribute__((warn_unused_result));

/* ---- when the log writes ---- */

/* The kinds of changes. Each may wait for the time given here since the number was raised last. */
enum iso_state_change {
    ISO_STATE_RECORD,        /* a record was written: an hour */
    ISO_STATE_LOCKOUT,       /* half an hour */
    ISO_STATE_ADMINISTRATOR, /* not at all */
};

/* Reports a change: the number is to be raised with the next anchor, or with the first one after
 * the time of this kind of change. */
void iso_state_counter_changed(struct iso_state_counter *counter, enum iso_state_change change);

/* Whether the next anchor would contain a new number. */
bool iso_state_counter_is_due(struct iso_state_counter *counter);

/* The number for the anchor that is written now. */
uint32_t iso_state_counter_next(struct iso_state_counter *counter);

/* Reports that the anchor with this number is on the disk. */
void iso_state_counter_wrote(struct iso_state_counter *counter, uint32_t number);

/* Returns a new fault of the counter since the last call, or the end of a fault (*error 0). False:
 * there is no news. */
bool iso_state_counter_take_news(struct iso_state_counter *counter, int *error,
                                 struct iso_fault *fault);

#endif
