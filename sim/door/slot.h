/* The slot: the symbolic link that the sensor `replay` reads. The sensor plays the recording to
 * which the link points. */
#ifndef SIM_DOOR_SLOT_H
#define SIM_DOOR_SLOT_H

#include "core/base/fault.h"

/* Points the link to CORPUS/RECORDING in one step: a reader sees either the old or the new target.
 * A relative corpus is made absolute first. -EINVAL if `slot` exists and is not a link,
 * -ENAMETOOLONG, or the errno of lstat(), realpath(), symlink() or rename(). */
int sim_slot_point(const char *slot, const char *corpus, const char *recording,
                   struct iso_fault *fault) __attribute__((warn_unused_result));

/* Removes the link, so that the sensor plays nothing. A missing link is no error.
 * -EINVAL if the path is not a link; it is then left unchanged. */
int sim_slot_clear(const char *slot, struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
