/* The door I/O class: the lines between the appliance and a door.
 *
 * Levels are logical: true is "active". The options of the back end say which voltage that is and
 * which contact is normally closed. The door's state machine, not this class, decides what to
 * switch and when.
 *
 * One object is used by one thread at a time. Operations block for a few milliseconds at most. On a
 * failure *fault (which may be NULL) holds one line.
 *
 *   OPEN -> LOST   when an operation returns -ENODEV: the device is gone
 *   LOST -> OPEN   by iso_door_io_reopen; until then every operation returns -ENODEV */
#ifndef ISO_DRIVERS_DOOR_DOOR_IO_H
#define ISO_DRIVERS_DOOR_DOOR_IO_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/base/clock.h"
#include "core/base/fault.h"
#include "drivers/base/option.h"
#include "drivers/door/wiegand.h"

enum iso_door_output {
    ISO_DOOR_RELAY, /* of the strike or magnet: active is energised */
    ISO_DOOR_LED_GRANTED,
    ISO_DOOR_LED_REFUSED,
    ISO_DOOR_BUZZER,
    ISO_DOOR_PROJECTOR, /* of infrared dots, for stereo sensors */
    ISO_DOOR_OUTPUTS
};

/* "relay", "led_granted", "led_refused", "buzzer", "projector"; NULL outside the range. */
const char *iso_door_output_name(enum iso_door_output output);

enum iso_door_input {
    ISO_DOOR_CONTACT,     /* active: the door stands open */
    ISO_DOOR_EXIT_BUTTON, /* active: pressed */
    ISO_DOOR_TAMPER,      /* active: the housing is open */
    ISO_DOOR_INPUTS
};

/* "contact", "exit_button", "tamper"; NULL outside the range. */
const char *iso_door_input_name(enum iso_door_input input);

/* Levels of all lines, indexed by the enumerations. */
struct iso_door_outputs {
    bool active[ISO_DOOR_OUTPUTS];
};

struct iso_door_inputs {
    bool active[ISO_DOOR_INPUTS];
};

/* What an operation of a back end may and must do. `self` is the back end's own object. */
struct iso_door_io_ops {
    const char *name; /* as in the configuration */

    /* OPTIONAL. The table of the options that [door] may have with this back end (option.h), ended
     * by an entry without a name; NULL: there are none. `check` and `open` are called with options
     * that agree with the table: known, given once, within their ranges, none missing. An option
     * `relay` or `wiegand_d0` has the meaning that isotherm.conf(5) gives it. */
    const struct iso_option_spec *options;

    /* OPTIONAL. Checks what the table cannot express, such as options that exclude each other.
     * Touches no device. -EINVAL, -ENOMEM. */
    int (*check)(const struct iso_option *options, size_t n_options, struct iso_fault *fault);

    /* REQUIRED. Claims the lines. Each output has its initial level from the first moment, so that
     * a strike that must stay energised does not drop. Called after check has accepted the options.
     * *self becomes the back end's own object, which is not NULL. The errors of check; -EINVAL a
     * line does not support an option, -ENODEV there is no such chip or line, -EBUSY, -EACCES,
     * -ENOMEM, -EIO. */
    int (*open)(const struct iso_option *options, size_t n_options, const struct iso_clock *clock,
                const struct iso_door_outputs *initial, void **self, struct iso_fault *fault);

    /* REQUIRED. Sets one output; it has changed when the call returns 0. -EIO, -ENODEV. */
    int (*set_output)(void *self, enum iso_door_output output, bool active,
                      struct iso_fault *fault);

    /* REQUIRED. Reads the inputs, debounced. EXIT_BUTTON and TAMPER are active if they are active
     * now or were active since the last call, so that a short press is not missed. CONTACT is its
     * present level. An input without a line reads inactive. -EIO, -EBADMSG, -ENODEV. */
    int (*get_inputs)(void *self, struct iso_door_inputs *out, struct iso_fault *fault);

    /* OPTIONAL. Begins to send a card number to an access controller and returns at once. -ENOSYS
     * no controller is wired, -ERANGE the number does not fit the controller's format, -EBUSY the
     * last number is still being sent, -EIO, -ENODEV. A failure while a number is sent is returned
     * by the next call. */
    int (*send_card)(void *self, const struct iso_wiegand_card *card, struct iso_fault *fault);

    /* OPTIONAL. A descriptor that polls readable when an input may have changed, until get_inputs
     * is called. Owned by the back end. A negative errno if there is none now; the caller then
     * reads the inputs at intervals. */
    int (*poll_fd)(void *self);

    /* REQUIRED. Releases the lines without setting them: the caller has set the outputs to their
     * resting levels. Whether a released line keeps its level depends on the hardware. Cannot
     * fail. */
    void (*close)(void *self);
};

struct iso_door_io;

/* Checks whether lines of this back end could be opened with these options if their device exists,
 * as iso_door_io_new does first: by the table of options and by ops->check. -ENOENT the name is
 * unknown (the fault lists the known ones), -EINVAL an option is unknown, repeated, bad or missing,
 * else the errors of ops->check. */
int iso_door_io_check(const char *name, const struct iso_option *options, size_t n_options,
                      struct iso_fault *fault) __attribute__((warn_unused_result));

/* Makes door lines by the name of the back end (`null` is the simulated one), in the state LOST. It
 * touches no device; iso_door_io_reopen opens the lines. The errors of iso_door_io_check. Options
 * and clock need not outlive the call; what the clock's context points to must outlive the
 * object. */
int iso_door_io_new(const char *name, const struct iso_option *options, size_t n_options,
                    const struct iso_clock *clock, struct iso_door_io **out,
                    struct iso_fault *fault) __attribute__((warn_unused_result));

/* Opens the lines, or opens them anew with the same options. The errors of ops->open, after which
 * the object is lost; -EALREADY it is not lost. */
int iso_door_io_reopen(struct iso_door_io *io, const struct iso_door_outputs *initial,
                       struct iso_fault *fault) __attribute__((warn_unused_result));

/* iso_door_io_new and iso_door_io_reopen: opened lines, or nothing. The errors of both. */
int iso_door_io_open(const char *name, const struct iso_option *options, size_t n_options,
                     const struct iso_clock *clock, const struct iso_door_outputs *initial,
                     struct iso_door_io **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* iso_door_io_open with a back end that is not in the registry. -EINVAL if a REQUIRED operation is
 * missing. `ops` must outlive the object. */
int iso_door_io_open_ops(const struct iso_door_io_ops *ops, const struct iso_option *options,
                         size_t n_options, const struct iso_clock *clock,
                         const struct iso_door_outputs *initial, struct iso_door_io **out,
                         struct iso_fault *fault) __attribute__((warn_unused_result));

/* NULL is fine. */
void iso_door_io_close(struct iso_door_io *io);

/* As the operations. Also -EINVAL for an output outside the enumeration, and -ENODEV if the lines
 * are lost. */
int iso_door_io_set_output(struct iso_door_io *io, enum iso_door_output output, bool active,
                           struct iso_fault *fault) __attribute__((warn_unused_result));
int iso_door_io_get_inputs(struct iso_door_io *io, struct iso_door_inputs *out,
                           struct iso_fault *fault) __attribute__((warn_unused_result));

/* As the operation; -ENOSYS also if the back end has none, -ENODEV if the lines are lost. */
int iso_door_io_send_card(struct iso_door_io *io, const struct iso_wiegand_card *card,
                          struct iso_fault *fault) __attribute__((warn_unused_result));

/* As the operation; -ENOSYS also if the back end has none, -ENODEV if the lines are lost. */
int iso_door_io_poll_fd(struct iso_door_io *io) __attribute__((warn_unused_result));

/* Whether the lines are in the state LOST. */
bool iso_door_io_is_lost(const struct iso_door_io *io);

/* The back end's name. */
const char *iso_door_io_name(const struct iso_door_io *io);

/* The back end's own object if `io` is one of these ops and not lost, else NULL: for functions that
 * only one back end has. */
void *iso_door_io_self(struct iso_door_io *io, const struct iso_door_io_ops *ops);

/* The registered back ends: name number i, or NULL from the end on. */
const char *iso_door_io_registered(size_t i);

/* The table of the options of a registered back end, ended by an entry without a name; NULL: no
 * such back end, or it has no options. */
const struct iso_option_spec *iso_door_io_options(const char *name);

#endif
