/* What `isotherm-link status --metrics` has to print. Failures fail the running cmocka test. */
#ifndef TESTS_FIRMWARE_FLEET_PROGRAM_LINK_FIGURES_H
#define TESTS_FIRMWARE_FLEET_PROGRAM_LINK_FIGURES_H

#include <stdbool.h>

/* Whether the door is connected, in a text of the right form. */
bool link_figures_say_connected(const char *text);

/* A door that is level with its hub. */
void link_figures_are_online(const char *text);

/* A door whose service does not run: it is not connected, and its counts are not told. */
void link_figures_are_alone(const char *text);

#endif
