/* What every back end of the door class owes its user (drivers/door/door_io.h), as one suite. A
 * program gives it a table: how to open each back end, how to see an output from outside, and how
 * to move an input. */
#ifndef TESTS_DRIVERS_DOOR_DOOR_CONTRACT_H
#define TESTS_DRIVERS_DOOR_DOOR_CONTRACT_H

#include "drivers/door/door_io.h"

struct door_back_end {
    const char *name;
    const struct iso_option *options; /* with which every line is wired and nothing is debounced */
    size_t n_options;
    struct iso_clock clock;
    bool has_world;        /* inputs can be moved while nobody has opened it */
    void (*prepare)(void); /* every input inactive, before it is opened */
    bool (*see_output)(struct iso_door_io *io, enum iso_door_output output);
    void (*move_input)(struct iso_door_io *io, enum iso_door_input input, bool active);
};

/* Runs the suite as a group of cmocka: how many tests failed. */
int door_contract_run(const struct door_back_end *back_ends, size_t n);

#endif
