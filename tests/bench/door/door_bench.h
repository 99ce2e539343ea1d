/* The interface between bench_door and the library that it loads into the daemon (door_preload.c):
 * shared memory, and pipes that the daemon inherits. Line 0 of the chip "bench" is the relay, line
 * 1 the exit button. */
#ifndef TESTS_BENCH_DOOR_DOOR_BENCH_H
#define TESTS_BENCH_DOOR_DOOR_BENCH_H

#include <stdatomic.h>
#include <stdint.h>

/* The environment variable with their descriptors: "MEMORY EDGES SWITCHINGS". */
#define DOOR_BENCH_VARIABLE "ISOTHERM_BENCH_DOOR"

enum { DOOR_BENCH_RELAY, DOOR_BENCH_EXIT, DOOR_BENCH_LINES };

/* The contents of the shared memory. */
struct door_bench {
    atomic_int level[DOOR_BENCH_LINES];
    atomic_int sync_ms;  /* added to each fsync and fdatasync */
    atomic_int frame_ms; /* processor time that is added to each frame */
    atomic_int frames, syncs;
};

/* An edge of the exit button, to the daemon. Times by CLOCK_MONOTONIC. */
struct door_bench_edge {
    int64_t t_ns;
    int32_t line, level;
};

/* A switching of the relay, from the daemon, and what the thread that switched it did before. */
struct door_bench_switching {
    int64_t t_ns;
    int32_t line, level;
    int64_t read_ns;  /* when it read the last rising edge of the button */
    int64_t woken_ns; /* when its last poll(2) returned */
    int64_t lock_ns;  /* how long it has waited for mutexes since then */
};

#endif
