/* From measured frames to the figures of the benchmark: how good landmarks are, what the gates let
 * through, what they refuse.
 *
 * A frame fails if its landmarks lie more than SIM_FAILURE_MM off; three rules say what of it: the
 * mean over its known landmarks, the same less the constant offset of each landmark (for ground
 * truth that means other spots by the same names), the worst of the latter. "Before the gates" are
 * all frames to which a head was fitted, "after" those with outcome ok. */
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
    struct sim_rate before, after; /* of frames with ground truth */
    struct sim_rate good_refused;  /* of the fitted frames that do not fail: those not accepted */
};

/* The genuine frames of one condition, or all. */
struct sim_condition_figures {
    const char *column, *value; /* "angle", "<= 25"; "expression", "smile" */
    struct sim_rate refused;    /* of genuine frames, with ground truth or without */
    struct sim_spread error_mm, centred_error_mm; /* of all landmarks of accepted frames together */
    struct sim_failures failures[SIM_FAILURE_RULES];
};

/* Rows of one note among those whose subject is `none`. */
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
    size_t n_true;              /* of these: with at least one landmark known and a head fitted */
    size_t reason[SIM_REASONS]; /* of genuine frames */
    /* Landmark by landmark, and of all: of accepted frames, of all fitted ones. */
    struct sim_landmark_error after[ISO_LANDMARKS + 1], before[ISO_LANDMARKS + 1];
    struct sim_condition_figures all;
    size_t n_conditions;
    struct sim_condition_figures *conditions; /* bands of angle, then expressions */
    size_t n_kinds;
    struct sim_kind_figures *kinds; /* in the manifest's order */
    /* Rows with a subject, by answer: BPCER is that of SIM_RESPONSE_ATTACK, BPNRR of _NONE. */
    struct sim_rate bona_fide[SIM_RESPONSES];
    struct sim_latency stage[ISO_STAGES],
        whole; /* of frames that reached the stage; readable ones */
};

/* `corpus` must outlive the result. -ENOMEM. */
int sim_landmark_analyse(const struct sim_corpus *corpus, const struct sim_measurement *measurement,
                         struct sim_landmark_analysis **out) __attribute__((warn_unused_result));
void sim_landmark_analysis_free(struct sim_landmark_analysis *analysis);

#endif
