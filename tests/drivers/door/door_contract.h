/* Tests of the contract that every back end of the door class has to keep (drivers/door/door_io.h),
 * as one suite. A program passes a table to the suite. The table says how to open each back end,
 * how to read an output from outside, and how to change an input. */
#ifndef TESTS_DRIVERS_DOOR_DOOR_CONTRACT_H
#define TESTS_DRIVERS_DOOR_DOOR_CONTRACT_H

#include "drivers/door/door_io.h"

struct door_back_end {
    const char *name;
    const struct iso_option *options; /* every line is wired, and no input is debounced */
    size_t n_options;
    struct iso_clock clock;
    bool has_world;        /* inputs can change while the back end is closed */
    void (*prepare)(void); /* makes every input inactive before the back end is opened */
    bool (*see_output)(struct iso_door_io *io, enum iso_door_output output);
    void (*move_input)(struct iso_door_io *io, enum iso_door_input input, bool active);
};

/* Runs the suite as a cmocka group. Returns how many tests failed. */
int door_contract_run(const struct door_back_end *back_ends, size_t n);

#endif
