/* Sends Wiegand codes over two lines: a pulse on D0 is a zero, a pulse on D1 is a one.
 *
 * A code takes 50 to 70 ms, and its pulses are 50 us long. The appliance's thread can neither wait
 * that long nor keep such times, so each sender has a thread of its own, with SCHED_FIFO where that
 * is permitted (RLIMIT_RTPRIO). The thread reads CLOCK_MONOTONIC, not an injected clock.
 * Controllers accept pulses of 20 to 100 us and intervals of 0.2 to 20 ms. */
#ifndef ISO_DRIVERS_DOOR_WIEGAND_OUT_H
#define ISO_DRIVERS_DOOR_WIEGAND_OUT_H

#include <stdbool.h>
#include <stdint.h>

#include "core/base/fault.h"

enum {
    ISO_WIEGAND_PULSE_NS = 50 * 1000,
    ISO_WIEGAND_INTERVAL_NS = 2000 * 1000, /* from pulse to pulse */
    ISO_WIEGAND_PRIORITY = 20,             /* of SCHED_FIFO */
};

/* Switches line D0 or D1 to pulse or rest; 0 or a negative errno. Called by the sender's thread
 * only. */
struct iso_wiegand_lines {
    int (*set)(void *context, int line, bool pulse);
    void *context;
};

/* The times of all pulses so far: from switching on to switching off, and between two pulses of a
 * code. */
struct iso_wiegand_report {
    uint64_t codes, pulses;
    bool realtime; /* the thread has SCHED_FIFO */
    int64_t pulse_min_ns, pulse_max_ns;
    int64_t interval_min_ns, interval_max_ns;
};

struct iso_wiegand_out;

/* Makes a sender and starts its thread. `lines` need not outlive the call, but its context must
 * outlive the sender. -ENOMEM, -EAGAIN no thread can be started. */
int iso_wiegand_out_new(const struct iso_wiegand_lines *lines, struct iso_wiegand_out **out,
                        struct iso_fault *fault) __attribute__((warn_unused_result));

/* Cuts off the code that is being sent; both lines are at rest then. NULL is fine. */
void iso_wiegand_out_free(struct iso_wiegand_out *out);

/* Begins to send the lowest `bits` bits (1 to 64) and returns at once. -EBUSY the last code is
 * still being sent; or, once, the error of the lines that cut off the last code. */
int iso_wiegand_out_send(struct iso_wiegand_out *out, uint64_t code, int bits)
    __attribute__((warn_unused_result));

/* Waits until nothing is being sent. Returns 0, or once the error of the lines that cut off the
 * last code. */
int iso_wiegand_out_flush(struct iso_wiegand_out *out);

/* Copies the report. A code is included after its end. */
void iso_wiegand_out_report(struct iso_wiegand_out *out, struct iso_wiegand_report *report);

#endif
