/* The door I/O back end `null`: no hardware. It remembers what was switched when, and its inputs
 * are set by a test or by a file.
 *
 * Options:
 *   inputs   optional: a file that holds one line `NAME = 0|1` for each input (contact,
 *            exit_button, tamper), read whenever the inputs are asked for. Stricter than a wire:
 *            a missing file, an unknown, repeated or missing name is an error, not a level.
 *
 * Without the option every input is inactive until iso_door_null_set_input says otherwise. */
#ifndef ISO_DRIVERS_DOOR_DOOR_NULL_H
#define ISO_DRIVERS_DOOR_DOOR_NULL_H

#include <stdint.h>

#include "drivers/door/door_io.h"

extern const struct iso_door_io_ops iso_door_null_ops;

enum { ISO_DOOR_NULL_HISTORY = 256 };

/* One setting of an output, repeated ones included. */
struct iso_door_null_event {
    int64_t t_ns; /* injected clock */
    enum iso_door_output output;
    bool active;
};

/* Sets an input. -EINVAL if io is not of this back end, has an `inputs` file, or the input is
 * outside the enumeration. */
int iso_door_null_set_input(struct iso_door_io *io, enum iso_door_input input, bool active)
    __attribute__((warn_unused_result));

/* The level of an output now. -EINVAL as above. */
int iso_door_null_get_output(struct iso_door_io *io, enum iso_door_output output, bool *active)
    __attribute__((warn_unused_result));

/* How many card numbers were sent since open, and the last of them; `card` is untouched if there
 * was none. -EINVAL as above. */
int iso_door_null_get_card(struct iso_door_io *io, size_t *count, struct iso_wiegand_card *card)
    __attribute__((warn_unused_result));

/* How many outputs were set since open, and the last ISO_DOOR_NULL_HISTORY of them: event `index`
 * counts from 0 at open. -EINVAL if io is not of this back end, -ENOENT for an index that has not
 * happened or is no longer kept. */
int iso_door_null_event_count(struct iso_door_io *io, size_t *count)
    __attribute__((warn_unused_result));
int iso_door_null_event(struct iso_door_io *io, size_t index, struct iso_door_null_event *out)
    __attribute__((warn_unused_result));

#endif
