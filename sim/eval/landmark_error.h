/* How well the landmarks lie, where recordings have ground truth (landmarks.csv). */
#ifndef SIM_EVAL_LANDMARK_ERROR_H
#define SIM_EVAL_LANDMARK_ERROR_H

#include "sim/eval/acquire.h"

struct sim_landmark_error {
    size_t n; /* usable frames with a true position; 0: nothing below is set */
    double mean_mm, p95_mm;
    struct iso_vec3
        offset_mm; /* mean error in the face frame: where the truth means another spot */
    double centred_mean_mm, centred_p95_mm; /* of what is left without the offset */
    /* Slip: difference of the errors, in the face frame, of two frames of one person from different
     * rows of the manifest. The part of the error that harms recognition. */
    size_t n_pairs;
    double slip_median_mm, slip_p95_mm;
};

/* Compares what was found with landmarks of the same name. Recordings without ground truth are
 * passed over. A damaged landmarks.csv is -EBADMSG; -ENOMEM. */
int sim_landmark_errors(const char *directory, const struct sim_corpus *corpus,
                        const struct sim_acquisition *acquisition,
                        struct sim_landmark_error out[ISO_LANDMARKS], struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
