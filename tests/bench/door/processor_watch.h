/* Watches whether the processors run programs without delay. A thread on each of them, with the
 * highest real-time priority, wakes every millisecond and notes when it was woken late. No program
 * can delay such a thread; only the kernel, while it cannot be interrupted, and the host of a
 * virtual machine can. While it is delayed, all other threads of that processor are delayed too. */
#ifndef TESTS_BENCH_DOOR_PROCESSOR_WATCH_H
#define TESTS_BENCH_DOOR_PROCESSOR_WATCH_H

#include <stdint.h>

struct bench_watch;

/* NULL: the process may not have threads of real-time priority, or there is no memory. */
struct bench_watch *bench_watch_start(void);

/* Ends the threads and frees the watch. NULL is accepted. */
void bench_watch_stop(struct bench_watch *watch);

/* The longest delay of a waking on any processor between two times (CLOCK_MONOTONIC), in
 * nanoseconds; only the part between the two times counts. The watch remembers the last 4096
 * wakings of each processor that were late by more than 0.2 ms. */
int64_t bench_watch_late_ns(struct bench_watch *watch, int64_t from_ns, int64_t to_ns);

/* Counts of all processors since the start. */
struct bench_watch_total {
    int wakings, late; /* late: by more than 1 ms */
    int64_t latest_ns;
};

struct bench_watch_total bench_watch_total(struct bench_watch *watch);

#endif
