/* Connects the state machine of the door (door.h) with the lines of the door (door_io.h): reads
 * the inputs, gives them to the machine, and switches the outputs that it asks for.
 *
 * A line that cannot be read or switched is a fault of the door, which puts the machine in FAULT
 * until all of them work again. Lines that are lost (their chip is gone, or was not there to begin
 * with) are opened anew, after a wait that doubles with each failure. */
#ifndef ISO_FIRMWARE_DOOR_DOOR_CONTROL_H
#define ISO_FIRMWARE_DOOR_DOOR_CONTROL_H

#include <stdbool.h>
#include <stdint.h>

#include "core/base/fault.h"
#include "drivers/door/door_io.h"
#include "firmware/door/door.h"

/* What the door did when it was asked to let somebody in, as far as its lines tell. */
enum iso_door_answer {
    ISO_DOOR_NOT_ASKED = 0, /* nobody was to be let in */
    ISO_DOOR_DID_UNLOCK,    /* the relay was switched, or had been already */
    ISO_DOOR_STOOD_OPEN,    /* the door was open, and the lock was not touched */
    ISO_DOOR_DID_NOT_UNLOCK,
};

/* "", "unlocked", "open", "not-unlocked". */
const char *iso_door_answer_name(enum iso_door_answer answer);

struct iso_door_timing {
    int64_t poll_ns;                /* how often the inputs are read */
    int64_t retry_ns, retry_max_ns; /* first and longest wait before lost lines are opened anew */
};

struct iso_door_control {
    struct iso_door door;
    struct iso_door_timing timing;
    struct iso_door_io *io;
    struct iso_door_inputs inputs;   /* as read last */
    struct iso_door_outputs outputs; /* as switched last */
    bool known;                      /* outputs are certain */
    bool broken;                     /* the lines do not work */
    bool relay_failed;               /* the relay was not switched as it should have been */
    bool asked_fault;                /* somebody else wants the door at fault */
    int64_t read_ns;                 /* when the inputs are to be read next */
    int64_t open_ns;                 /* when lost lines are to be opened anew */
    int64_t wait_ns;                 /* until then from the next failure on */
    /* Called after each event that changed the state or is about the housing. */
    void (*changed)(void *context, enum iso_door_event cause);
    void *context;
    struct iso_fault fault; /* the last one of the lines; "" if there was none */
};

/* A stopped door. io (which may be lost), and what `context` points to, must outlive it. */
void iso_door_control_init(struct iso_door_control *control, const struct iso_door_options *options,
                           const struct iso_door_timing *timing, struct iso_door_io *io,
                           void (*changed)(void *context, enum iso_door_event cause),
                           void *context);

/* Reads the inputs and starts the machine; with lost lines, it starts at fault. */
void iso_door_control_start(struct iso_door_control *control, int64_t now_ns);

/* Switches every output off. */
void iso_door_control_stop(struct iso_door_control *control, int64_t now_ns);

/* Lets somebody in. A grant whose relay could not be switched is withdrawn at once: the door does
 * not unlock later, when its lines work again. `changed` is called after the switching. */
enum iso_door_answer iso_door_control_grant(struct iso_door_control *control, int64_t now_ns);

/* Takes a grant back that has just unlocked the door: the lock goes to rest. */
void iso_door_control_withdraw(struct iso_door_control *control, int64_t now_ns);

/* Shows a refusal. */
void iso_door_control_refuse(struct iso_door_control *control, int64_t now_ns);

/* Switches the relay for a moment. 0: its line was switched. -EBUSY the door is not locked,
 * -ENODEV its lines do not work, each with a fault; then nothing was switched, except perhaps the
 * line at fault. */
int iso_door_control_test(struct iso_door_control *control, int64_t now_ns, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Whether a test can be made: its errors, and nothing is switched. */
int iso_door_control_may_test(const struct iso_door_control *control, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* A fault that is not the door's own begins or ends. */
void iso_door_control_set_fault(struct iso_door_control *control, bool fault, int64_t now_ns);

/* Opens lost lines if it is time to; reads the inputs if it is time to, or if `now` says so; lets
 * time pass; switches outputs. */
void iso_door_control_step(struct iso_door_control *control, bool now, int64_t now_ns);

/* When to step next. */
int64_t iso_door_control_due_ns(const struct iso_door_control *control);

#endif
