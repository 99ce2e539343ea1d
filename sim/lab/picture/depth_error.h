/* Where a depth frame is wrong, as a picture. */
#ifndef SIM_LAB_PICTURE_DEPTH_ERROR_H
#define SIM_LAB_PICTURE_DEPTH_ERROR_H

#include "core/base/fault.h"
#include "isotherm/frame.h"
#include "sim/world/view/view.h"

/* Draws measured - true: grey where they agree, red where the measured depth is farther, blue where
 * it is nearer, full colour at +-full_scale_mm; black where nothing was measured although something
 * is there, dark grey where there is nothing. One picture pixel a frame pixel. `view` is what the
 * frame was measured from. -ENOMEM, or errors of writing. */
int sim_picture_depth_error(const struct sim_view *view, const struct iso_frame *frame,
                            double full_scale_mm, const char *path, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
