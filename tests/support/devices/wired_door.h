/* A door for tests with threads: its lines are set and looked at by the test while another thread
 * has the door, and the test can wait for a line. One door at a time. */
#ifndef TESTS_SUPPORT_DEVICES_WIRED_DOOR_H
#define TESTS_SUPPORT_DEVICES_WIRED_DOOR_H

#include "drivers/door/door_io.h"

extern const struct iso_door_io_ops wired_door_ops;

/* Opens it with everything without power. */
struct iso_door_io *wired_door_open(void);

/* Sets an input. If the exit button or the tamper contact was active for a moment only, the next
 * reading of the inputs still shows it as active. */
void wired_door_set(enum iso_door_input input, bool active);

/* Presses the exit button and lets go of it. */
void wired_door_press(void);

/* Waits until a line has been switched so often (since it was opened); fails the test after a
 * minute. Every switching on or off is one. */
void wired_door_await(enum iso_door_output output, unsigned switchings);

/* How often a line has been switched, and its level. */
unsigned wired_door_switchings(enum iso_door_output output);
bool wired_door_level(enum iso_door_output output);

#endif
