/* From measured frames to the figures of the benchmark: the accuracy of the landmarks, the frames
 * that the gates let through, and the frames that they refuse.
 *
 * A frame fails if its landmark error exceeds SIM_FAILURE_MM. Three rules define the error: the
 * mean over the frame's known landmarks; the same mean after subtracting the constant offset of
 * each landmark (the ground truth may use the same names for other points); the largest error
 * after this subtraction. "Before the gates" are all frames to which a head was fitted, "after"
 * those with outcome ok. */
#ifndef SIM_LAB_LANDMARKS_ANALYSIS_H
#define SIM_LAB_LANDMARKS_ANALYSIS_H

#include "sim/lab/landmarks/presentation.h"
#include "sim/lab/match/latency.h"
#include "sim/lab/measure/rate.h"

#define SIM_FAILURE_MM 10.0

enum sim_failure_rule {
    SIM_FAILURE_MEAN,
    SIM_FAILURE_CENTRED_MEAN,
    SIM_FAILURE_CENTRED_MAX,
    SIM_FAILURE_RULES
};

/* "mean", "mean, less offset", "worst, less offset". */
const char *sim_failure_rule_name(enum sim_failure_rule rule);

/* Whether a frame with known landmarks fails. */
bool sim_frame_fails(const struct sim_measured_frame *frame, enum sim_failure_rule rule);

struct sim_failures {
    struct sim_rate before, after; /* of fitted frames with ground truth */
    struct sim_rate good_refused;  /* refused frames among those of `before` that do not fail */
};

/* The genuine frames of one condition, or of all. */
struct sim_condition_figures {
    const char *column, *value; /* "angle", "<= 25"; "expression", "smile" */
    struct sim_rate refused;    /* of genuine frames, with ground truth or without */
    struct sim_spread error_mm, centred_error_mm; /* of all landmarks of accepted frames together */
    struct sim_failures failures[SIM_FAILURE_RULES];
};

/* Rows with subject `none` and the same note. */
struct sim_kind_figures {
    const char *note;
    enum sim_row_kind kind;
    struct sim_rate accepted_frames;
    /* Rows by answer. For attacks, ISO/IEC 30107-3: APCER is `response[SIM_RESPONSE_BONA_FIDE]`,
     * APNRR `response[SIM_RESPONSE_NONE]`. */
    struct sim_rate response[SIM_RESPONSES];
    size_t reason[SIM_REASONS]; /* of frames */
};

struct sim_landmark_analysis {
    size_t n_bona_fide;         /* frames of rows with a subject */
    size_t n_true;              /* those with at least one known landmark and a fitted head */
    size_t reason[SIM_REASONS]; /* of genuine frames */
    /* For each landmark and for all together: over accepted frames, over all fitted frames. */
    struct sim_landmark_error after[ISO_LANDMARKS + 1], before[ISO_LANDMARKS + 1];
    struct sim_condition_figures all;
    size_t n_conditions;
    struct sim_condition_figures *conditions; /* bands of angle, then expressions */
    size_t n_kinds;
    struct sim_kind_figures *kinds; /* in the manifest's order */
    /* Rows with a subject, by answer: BPCER counts SIM_RESPONSE_ATTACK, BPNRR counts _NONE. */
    struct sim_rate bona_fide[SIM_RESPONSES];
    struct sim_latency stage[ISO_STAGES],
        whole; /* over frames that reached the stage; `whole` over readable frames */
};

/* Computes all figures. `corpus` must outlive the result. -ENOMEM. */
int sim_landmark_analyse(const struct sim_corpus *corpus, const struct sim_measurement *measurement,
                         struct sim_landmark_analysis **out) __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void sim_landmark_analysis_free(struct sim_landmark_analysis *analysis);

#endif
