/* Draws a depth frame. */
#ifndef SIM_LAB_PICTURE_DEPTH_H
#define SIM_LAB_PICTURE_DEPTH_H

#include "core/base/fault.h"
#include "isotherm/frame.h"

/* Draws depth in colours from the nearest (bright) to the farthest (dark) of the middle 98% of
 * the measured pixels, black where there is no measurement, with a colour bar in mm. Small
 * frames are enlarged by a whole factor. A frame without measurements is all black. -ENOMEM,
 * -EIO. */
int sim_picture_depth(const struct iso_frame *frame, const char *path, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
