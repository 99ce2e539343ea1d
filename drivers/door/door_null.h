/* The door I/O back end `null`: no hardware. It remembers what was switched when, and its inputs
 * are set by a test or by a file.
 *
 * Options:
 *   inputs   optional: a file that holds one line `NAME = 0|1` for each input (contact,
 *            exit_button, tamper). It is read at each iso_door_io_get_inputs. A missing file and an
 *            unknown, repeated or missing name are errors (-EBADMSG).
 *
 * Without the option every input is inactive until iso_door_null_set_input sets it. */
#ifndef ISO_DRIVERS_DOOR_DOOR_NULL_H
#define ISO_DRIVERS_DOOR_DOOR_NULL_H

#include <stdint.h>

#include "drivers/door/door_io.h"

extern const struct iso_door_io_ops iso_door_null_ops;

enum { ISO_DOOR_NULL_HISTORY = 256 };

/* One call that set an output. A call that did not change the level is an event, too. */
struct iso_door_null_event {
    int64_t t_ns; /* injected clock */
    enum iso_door_output output;
    bool active;
};

/* Sets an input. -EINVAL if io is not of this back end or is lost, if it has an `inputs` file, or
 * if the input is outside the enumeration; -EIO. */
int iso_door_null_set_input(struct iso_door_io *io, enum iso_door_input input, bool active)
    __attribute__((warn_unused_result));

/* The present level of an output. -EINVAL if io is not of this back end or is lost, or if the
 * output is outside the enumeration. */
int iso_door_null_get_output(struct iso_door_io *io, enum iso_door_output output, bool *active)
    __attribute__((warn_unused_result));

/* How many card numbers were sent since open, and the last of them; `card` is unchanged if there
 * was none. -EINVAL if io is not of this back end or is lost. */
int iso_door_null_get_card(struct iso_door_io *io, size_t *count, struct iso_wiegand_card *card)
    __attribute__((warn_unused_result));

/* The number of events since open, and one of the last ISO_DOOR_NULL_HISTORY of them: `index`
 * counts from 0 at open. -EINVAL if io is not of this back end or is lost, -ENOENT for an event
 * that has not happened yet or is no longer kept. */
int iso_door_null_event_count(struct iso_door_io *io, size_t *count)
    __attribute__((warn_unused_result));
int iso_door_null_event(struct iso_door_io *io, size_t index, struct iso_door_null_event *out)
    __attribute__((warn_unused_result));

#endif
