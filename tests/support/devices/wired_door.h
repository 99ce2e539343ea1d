/* A door for tests with threads: the test sets and reads its lines while another thread uses the
 * door, and it can wait for a line. Only one door can be open at a time. */
#ifndef TESTS_SUPPORT_DEVICES_WIRED_DOOR_H
#define TESTS_SUPPORT_DEVICES_WIRED_DOOR_H

#include "drivers/door/door_io.h"

extern const struct iso_door_io_ops wired_door_ops;

/* Opens the door with all lines inactive. */
struct iso_door_io *wired_door_open(void);

/* Sets an input. If the exit button or the tamper contact was active for a moment only, the next
 * reading of the inputs still shows it as active. */
void wired_door_set(enum iso_door_input input, bool active);

/* Presses and releases the exit button. */
void wired_door_press(void);

/* Waits until a line has been switched this number of times since the door was opened; fails the
 * test after a minute. Switching on and switching off count separately. */
void wired_door_await(enum iso_door_output output, unsigned switchings);

/* How often a line has been switched, and its level. */
unsigned wired_door_switchings(enum iso_door_output output);
bool wired_door_level(enum iso_door_output output);

#endif
