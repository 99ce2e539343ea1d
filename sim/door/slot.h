/* The slot: the symbolic link that the sensor `replay` reads. The recording that it names stands
 * in front of the camera. */
#ifndef SIM_DOOR_SLOT_H
#define SIM_DOOR_SLOT_H

#include "core/base/fault.h"

/* Points the link to CORPUS/RECORDING in one step: a reader sees either the old or the new target.
 * A relative corpus is made absolute first. Errors of realpath(), symlink() and rename(). */
int sim_slot_point(const char *slot, const char *corpus, const char *recording,
                   struct iso_fault *fault) __attribute__((warn_unused_result));

/* Removes the link, so that no one stands in front of the camera. A missing link is no error.
 * -EINVAL if the path is not a link; it is then left unchanged. */
int sim_slot_clear(const char *slot, struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
