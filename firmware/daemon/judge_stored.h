/* Judges stored frames: a check that recognition works on this machine, with its data files,
 * libraries and processor, without a camera and without the stores. */
#ifndef ISO_FIRMWARE_DAEMON_JUDGE_STORED_H
#define ISO_FIRMWARE_DAEMON_JUDGE_STORED_H

#include <stdio.h>

#include "core/base/fault.h"
#include "drivers/base/times.h"
#include "firmware/config/config.h"

/* Judges the recordings (drivers/recording/recording.h) of a directory: `enrolled` and `other` show
 * two people, and `visitor` shows the first of them on another day. The first usable frame of each
 * goes the way of a frame of the camera, from depths to a template and to the best of the two
 * people (iso_pipeline); the visitor has to be the enrolled person, at the level `balanced`, and
 * the other person has to stay below it. Prints one line with the scores.
 *
 * The configuration gives the sections [model] and [match] alone. All else is as without a file, so
 * that a setting of the door, such as its range, cannot fail the check. Stored depths have no
 * image: the image check is left out. A method that is not calibrated has to rank the two people,
 * because it has no level.
 *
 * -EBADMSG if the visitor is not recognised as the enrolled person, if the other person reaches the
 * level, or if a recording is damaged or has no usable frame; -ENOENT if a recording is missing;
 * the errors of iso_pipeline_open; -ENOMEM; each with a fault. */
int iso_judge_stored(const struct iso_config *config, const struct iso_times *times,
                     const char *directory, FILE *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
