/* What is left of an update of a fleet at a door. */
#ifndef TESTS_FIRMWARE_FLEET_PROGRAM_LINK_LEFTOVER_H
#define TESTS_FIRMWARE_FLEET_PROGRAM_LINK_LEFTOVER_H

#include <stdbool.h>

/* Writes half a bundle and a record into the folder, which is that of the link and of the updates;
 * whether one of both is there. */
void link_leftover_make(const char *folder);
bool link_leftover_is_there(const char *folder);

#endif
