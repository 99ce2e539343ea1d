/* The slot: the symbolic link that the sensor `replay` looks at. The recording that it
 * names stands in front of the camera. */
#ifndef SIM_DOOR_SLOT_H
#define SIM_DOOR_SLOT_H

#include "core/base/fault.h"

/* Points the link to CORPUS/RECORDING in one step: a reader sees either the old or the new target.
 * A relative corpus is made absolute first. Errors of realpath(), symlink() and rename(). */
int sim_slot_point(const char *slot, const char *corpus, const char *recording,
                   struct iso_fault *fault) __attribute__((warn_unused_result));

/* Removes the link: nobody is there. It is no error if there is no link. -EINVAL if it is something
 * other than a link, which is left alone. */
int sim_slot_clear(const char *slot, struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
