/* The state machine of a door on its lines. It runs on the null back end, or on a weak back end:
 * the null back end behind operations that fail on request. */
#ifndef TESTS_FIRMWARE_DOOR_DOOR_RIG_H
#define TESTS_FIRMWARE_DOOR_DOOR_RIG_H

#include "drivers/base/times.h"
#include "firmware/door/door_control.h"

#define MS ISO_NS_PER_MS

extern int64_t door_rig_now_ns;
extern struct iso_door_io *door_rig_io;
extern struct iso_door_control door_rig_control;
extern struct iso_door_outputs
    door_rig_opened_with;          /* the outputs with which the weak back end was opened */
extern bool door_rig_weak_contact; /* state of the contact input on the weak back end */
extern int door_rig_weak_fd;       /* descriptor of the weak lines; 0: they have none */
extern int door_rig_failing; /* the error of every operation on the weak lines; 0: they work */
extern const struct iso_door_outputs door_rig_unpowered;
extern const struct iso_door_options door_rig_options;
extern const struct iso_door_timing door_rig_timing;

/* cmocka set-up and tear-down, for both back ends. */
int door_rig_setup(void **state);
int door_rig_setup_weak(void **state);
int door_rig_teardown(void **state);

/* The reports so far, and the function that adds to them: a `changed` of iso_door_control_init. */
extern char door_rig_told[512];
void door_rig_on_changed(void *context, enum iso_door_event cause);

/* Returns the reports since the last call: "unlocked(grant) ...". */
const char *door_rig_news(void);

void door_rig_set_input(enum iso_door_input input, bool active);
bool door_rig_output(enum iso_door_output which);

/* Sets the clock to this time and steps the state machine, without a change of an input. */
void door_rig_step_at(int64_t t_ms);

#endif
