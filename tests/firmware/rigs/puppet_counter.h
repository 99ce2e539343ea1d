/* A counter that a test holds in its hand. */
#ifndef TESTS_FIRMWARE_RIGS_PUPPET_COUNTER_H
#define TESTS_FIRMWARE_RIGS_PUPPET_COUNTER_H

#include <stdbool.h>
#include <stdint.h>

#include "drivers/counter/counter.h"

struct puppet_counter {
    bool defined;
    uint64_t value;
    int error;         /* not 0: what every call returns */
    bool loses_answer; /* it counts, and says -EIO */
    int increments;
    void (*incremented)(void); /* NULL: nobody is told */
};

/* Closing it changes nothing. */
struct iso_counter puppet_counter(struct puppet_counter *puppet);

#endif
