/* Draws the errors of a depth frame. */
#ifndef SIM_LAB_PICTURE_DEPTH_ERROR_H
#define SIM_LAB_PICTURE_DEPTH_ERROR_H

#include "core/base/fault.h"
#include "isotherm/frame.h"
#include "sim/world/view/view.h"

/* Draws measured - true: grey for no difference, red where the measured depth is farther, blue
 * where it is nearer, full colour at +-full_scale_mm. Black marks a missing measurement of a
 * surface, dark grey an empty place. Each frame pixel is one picture pixel. `view` is the view
 * that the frame was measured from. -ENOMEM, or errors of writing. */
int sim_picture_depth_error(const struct sim_view *view, const struct iso_frame *frame,
                            double full_scale_mm, const char *path, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
