/* Connects the state machine of the door (door.h) with the lines of the door (door_io.h): reads the
 * inputs, passes them to the machine, and switches the outputs as the machine says.
 *
 * A line that cannot be read or switched is a fault of the door, which puts the machine in FAULT
 * until all lines work again. Lines that are lost (their chip is gone, or was never there) are
 * opened again after a wait that doubles with each failure. */
#ifndef ISO_FIRMWARE_DOOR_DOOR_CONTROL_H
#define ISO_FIRMWARE_DOOR_DOOR_CONTROL_H

#include <stdbool.h>
#include <stdint.h>

#include "core/base/fault.h"
#include "drivers/door/door_io.h"
#include "firmware/door/door.h"

/* What the door did when somebody was to be let in, as far as its lines show. */
enum iso_door_answer {
    ISO_DOOR_NOT_ASKED = 0, /* nobody was to be let in */
    ISO_DOOR_DID_UNLOCK,    /* the relay was switched now or before */
    ISO_DOOR_STOOD_OPEN,    /* the door was open, and the lock was not touched */
    ISO_DOOR_DID_NOT_UNLOCK,
};

/* "", "unlocked", "open", "not-unlocked". */
const char *iso_door_answer_name(enum iso_door_answer answer);

struct iso_door_timing {
    int64_t poll_ns;                /* interval of reading inputs that do not report changes */
    int64_t retry_ns, retry_max_ns; /* first and longest wait before lost lines are opened again */
};

/* What somebody else, such as an access panel, wants the lights and the buzzer to show. */
struct iso_door_lamps {
    bool granted, refused, buzzer;
};

struct iso_door_control {
    struct iso_door door;
    struct iso_door_timing timing;
    struct iso_door_io *io;
    struct iso_door_inputs inputs;   /* as they were read last */
    struct iso_door_outputs outputs; /* as they were switched last */
    struct iso_door_lamps lamps;     /* shown while the door is locked and has nothing to show */
    bool known;                      /* the levels of the outputs are certain */
    bool broken;                     /* the lines do not work */
    bool relay_failed;               /* the relay did not switch as it should */
    bool asked_fault; /* a fault outside the door lasts (iso_door_control_set_fault) */
    int64_t read_ns;  /* time of the next reading of the inputs */
    int64_t open_ns;  /* time of the next attempt to open lost lines */
    int64_t wait_ns;  /* the wait after the next failure */
    /* Called after each event that changed the state or concerns the housing. */
    void (*changed)(void *context, enum iso_door_event cause);
    void *context;
    struct iso_fault fault; /* the last fault of the lines; "" if there was none */
};

/* Makes a stopped door. io (which may be lost), and what `context` points to, must outlive it. */
void iso_door_control_init(struct iso_door_control *control, const struct iso_door_options *options,
                           const struct iso_door_timing *timing, struct iso_door_io *io,
                           void (*changed)(void *context, enum iso_door_event cause),
                           void *context);

/* Reads the inputs, starts the machine, and switches the outputs. With lost lines the machine
 * starts in FAULT. */
void iso_door_control_start(struct iso_door_control *control, int64_t now_ns);

/* Switches every output off. */
void iso_door_control_stop(struct iso_door_control *control, int64_t now_ns);

/* Lets somebody in, and returns what the door did. A grant whose relay could not be switched is
 * withdrawn at once: the door does not unlock later, when its lines work again. `changed` is called
 * after the switching. */
enum iso_door_answer iso_door_control_grant(struct iso_door_control *control, int64_t now_ns);

/* Withdraws a grant that has just unlocked the door: the lock goes to rest. */
void iso_door_control_withdraw(struct iso_door_control *control, int64_t now_ns);

/* Shows a refusal. */
void iso_door_control_refuse(struct iso_door_control *control, int64_t now_ns);

/* Switches the relay for a moment. Returns 0 if its line was switched. -EBUSY the door is not
 * locked, -ENODEV its lines do not work, each with a fault; then nothing was switched, except
 * perhaps the faulty line. */
int iso_door_control_test(struct iso_door_control *control, int64_t now_ns, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Whether a test is possible. Returns the errors of a test, and switches nothing. */
int iso_door_control_may_test(const struct iso_door_control *control, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Notes that a fault outside the door, such as one of the sensor, begins or ends. */
void iso_door_control_set_fault(struct iso_door_control *control, bool fault, int64_t now_ns);

/* Shows these lamps from now on, while the door is locked and shows neither a grant nor a refusal
 * of its own. The relay does not depend on them. */
void iso_door_control_show(struct iso_door_control *control, const struct iso_door_lamps *lamps,
                           int64_t now_ns);

/* Opens lost lines and reads the inputs if they are due, or reads them at once if `now` is set.
 * Then lets time pass, and switches outputs. */
void iso_door_control_step(struct iso_door_control *control, bool now, int64_t now_ns);

/* The time of the next step; ISO_NEVER_NS: no time is set. */
int64_t iso_door_control_due_ns(const struct iso_door_control *control);

#endif
