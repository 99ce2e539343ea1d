/* Watches whether the processors are there for programs at all. A thread on each of them, with the
 * highest real-time priority, wakes every millisecond and notes when it was woken late. No program
 * can keep such a thread waiting, only the kernel, where it does not let itself be interrupted, and
 * the host of a virtual machine. While it is late, no other thread of that processor runs in time.
 */
#ifndef TESTS_BENCH_DOOR_PROCESSOR_WATCH_H
#define TESTS_BENCH_DOOR_PROCESSOR_WATCH_H

#include <stdint.h>

struct bench_watch;

/* NULL: the process may not have threads of real-time priority, or there is no memory. */
struct bench_watch *bench_watch_start(void);

/* NULL is fine. */
void bench_watch_stop(struct bench_watch *watch);

/* By how many nanoseconds the latest waking between these two times (CLOCK_MONOTONIC) was late, of
 * all processors; at most what lies between the two. Remembers the last few thousand wakings that
 * were late by more than 0.2 ms. */
int64_t bench_watch_late_ns(struct bench_watch *watch, int64_t from_ns, int64_t to_ns);

/* Of all processors since the start. */
struct bench_watch_total {
    int wakings, late; /* late: by more than 1 ms */
    int64_t latest_ns;
};

struct bench_watch_total bench_watch_total(struct bench_watch *watch);

#endif
