/* Accuracy of the landmarks, for recordings with ground truth (landmarks.csv). */
#ifndef SIM_LAB_EVAL_LANDMARK_ERROR_H
#define SIM_LAB_EVAL_LANDMARK_ERROR_H

#include "isotherm/extract.h"
#include "sim/base/spread.h"
#include "sim/lab/match/truth.h"

/* Deviations of the landmarks found in a frame from the true landmarks. */
struct sim_deviation {
    size_t row; /* of the manifest */
    bool known[ISO_LANDMARKS];
    struct iso_vec3 error_mm[ISO_LANDMARKS]; /* found minus true, face frame; 0 if not known */
};

/* The deviations of an extraction whose landmarks are set. */
struct sim_deviation sim_deviation_of(const struct iso_extraction *extraction,
                                      const struct sim_truth *truth, size_t row);

/* Computes the constant part of each landmark's error, which appears where two definitions of a
 * landmark mean different points. It is the median of the errors for each coordinate, so that
 * frames with large errors do not shift it. 0 for a landmark that is never known. -ENOMEM. */
int sim_landmark_offsets(const struct sim_deviation *deviations, size_t n,
                         struct iso_vec3 offset_mm[ISO_LANDMARKS])
    __attribute__((warn_unused_result));

struct sim_landmark_error {
    struct iso_vec3 offset_mm;          /* subtracted for the centred error */
    struct sim_spread error_mm;         /* length of the error, over frames */
    struct sim_spread centred_error_mm; /* length of the error without the offset */
    /* Between sessions: a frame's error minus the mean error of the person, which is the mean
     * over the person's sessions of the mean over a session's frames. People with one session
     * are left out. With S sessions, using the same data for the mean reduces the deviation by
     * the share 1 - sqrt(1 - 1/S). */
    struct sim_spread repeat_mm;
    /* Slip: difference between the errors of two frames of one person from different rows of the
     * manifest. This is the part of the error that harms recognition. At most 64 pairs for each
     * frame. */
    struct sim_spread slip_mm;
};

/* Computes the figures of each landmark; out[ISO_LANDMARKS] is over all landmarks of all frames
 * together (its offset is 0). Deviations are in the order of the manifest's rows. -ENOMEM. */
int sim_landmark_errors(const struct sim_corpus *corpus, const struct sim_deviation *deviations,
                        size_t n, const struct iso_vec3 offset_mm[ISO_LANDMARKS],
                        struct sim_landmark_error out[ISO_LANDMARKS + 1])
    __attribute__((warn_unused_result));

/* The name of a landmark, or "all" for ISO_LANDMARKS. */
const char *sim_landmark_error_name(int landmark);

#endif
