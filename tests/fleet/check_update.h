/* The updates of a door of the check: the code of the link (firmware/fleet/update/update.h) with an
 * image that lies in the folder "image" of the door. fleet_update.sh plays the image; a door
 * without one takes no updates. */
#ifndef TESTS_FLEET_CHECK_UPDATE_H
#define TESTS_FLEET_CHECK_UPDATE_H

#include "firmware/fleet/link/link.h"

struct link_update;

/* Begins the updates of a door that has joined, and lets its link hand over orders to them: sets
 * the members update_context, ordered and answered of `link`, whose other members are set. The
 * caller frees *out behind the link. Errors of link_update_new(). */
int check_update_start(const char *folder, struct link_setup *link, struct link_update **out,
                       struct iso_fault *fault) __attribute__((warn_unused_result));

/* Writes the state that the daemon was told last, the version that runs, and the fault. */
void check_update_describe(const struct link_update *update, char *answer, size_t size);

#endif
