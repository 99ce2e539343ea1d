/* Draws a depth frame. */
#ifndef SIM_LAB_PICTURE_DEPTH_H
#define SIM_LAB_PICTURE_DEPTH_H

#include "core/base/fault.h"
#include "isotherm/frame.h"

/* Draws depth in colours, with a colour bar in mm. The colours reach from the nearest (bright) to
 * the farthest (dark) of the middle 98% of the measured pixels; pixels without a measurement are
 * black. Small frames are enlarged by a whole factor. -ENOMEM, -EIO, with a fault. */
int sim_picture_depth(const struct iso_frame *frame, const char *path, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
