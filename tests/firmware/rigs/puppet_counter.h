/* A counter that a test controls. */
#ifndef TESTS_FIRMWARE_RIGS_PUPPET_COUNTER_H
#define TESTS_FIRMWARE_RIGS_PUPPET_COUNTER_H

#include <stdbool.h>
#include <stdint.h>

#include "drivers/counter/counter.h"

struct puppet_counter {
    bool defined;
    uint64_t value;
    int error;                 /* if not 0, every call returns it */
    bool loses_answer;         /* it counts, but returns -EIO */
    int increments;            /* number of increments that were answered */
    void (*incremented)(void); /* called after each increment; NULL: no call */
};

/* Closing this counter does nothing. */
struct iso_counter puppet_counter(struct puppet_counter *puppet);

#endif
