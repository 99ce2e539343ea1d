/* Pictures of an extractor's result for a frame. */
#ifndef SIM_LAB_LANDMARKS_FIT_PICTURE_H
#define SIM_LAB_LANDMARKS_FIT_PICTURE_H

#include "isotherm/extract.h"
#include "sim/lab/match/truth.h"

struct sim_fit_subject {
    const struct iso_head_model *model;
    const struct iso_extractor *extractor; /* its last run must have been on this frame */
    const struct iso_extraction *extraction;
    const struct iso_frame *frame;
    const struct sim_truth *truth; /* or NULL */
    const char *title;             /* first line of the caption */
};

/* Draws sim_picture_fit with a caption of outcome, residual, coverage, pose and errors.
 * -ENOMEM, -EIO. */
int sim_fit_picture(const struct sim_fit_subject *subject, const char *path,
                    struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
