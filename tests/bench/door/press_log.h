/* The presses of the exit button that bench_door makes: when each step happened, and what delayed
 * it. */
#ifndef TESTS_BENCH_DOOR_PRESS_LOG_H
#define TESTS_BENCH_DOOR_PRESS_LOG_H

#include <stdbool.h>
#include <stdint.h>

#include "tests/bench/door/door_bench.h"
#include "tests/bench/door/thread_account.h"

/* What happened during a wait. */
struct bench_wait {
    struct bench_account door, own; /* of the door's thread, and of the one that presses */
    int64_t stopped_ns;             /* see bench_watch_late_ns */
};

/* Times by CLOCK_MONOTONIC. */
struct bench_press {
    int64_t pressed_ns; /* the time of the edge */
    int64_t written_ns; /* the edge was on its way to the daemon */
    struct door_bench_switching on, off;
    struct bench_wait to_on, to_off;
};

struct bench_press_bounds {
    double debounce_ms, unlock_ms, late_ms;
};

/* The time from the edge to the relay, and the time by which the relay was on for longer than
 * unlock_ms. */
double bench_press_to_line_ms(const struct bench_press *press);
double bench_press_off_error_ms(const struct bench_press *press, double unlock_ms);

/* Prints a heading, and a line for each press whose relay was on later than late_ms after the edge
 * or was on for a time that differs from unlock_ms by more than late_ms, and for the five latest
 * presses. `watched`: stopped_ns is known. */
void bench_press_print_latest(const struct bench_press *presses, int n,
                              const struct bench_press_bounds *bounds, bool watched);

#endif
