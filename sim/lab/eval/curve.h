/* How recognition depends on the conditions of a search: error rates over bins of a quantity
 * that was measured for each probe. */
#ifndef SIM_LAB_EVAL_CURVE_H
#define SIM_LAB_EVAL_CURVE_H

#include "sim/lab/eval/analysis.h"

enum sim_factor {
    SIM_FACTOR_LANDMARK_ERROR, /* mean distance from the known true landmarks, without constant
                                  offsets, mm */
    SIM_FACTOR_NOISE,          /* residual of the fitted head, mm */
    SIM_FACTOR_DISTANCE,       /* nose tip from the sensor, mm */
    SIM_FACTOR_POSE,           /* angle between face and camera, degrees */
    SIM_FACTOR_EXPRESSION,     /* norm of the fitted expression, standard deviations */
    SIM_FACTOR_FUSED,          /* frames in the sample's template */
    SIM_FACTOR_AGE, /* sessions since enrolment: the number at the end of the session's name, minus
                       that of the person's first gallery row */
    SIM_FACTORS
};

/* The name of a factor ("landmark-error", ...), and its label with the unit, for axes. */
const char *sim_factor_name(enum sim_factor factor);
const char *sim_factor_label(enum sim_factor factor);

enum { SIM_CURVE_BINS = 5 };

struct sim_curve_bin {
    double low, mean, high;                /* of the factor */
    struct sim_rate not_rank_1, non_match; /* of mated searches that were not missed */
};

/* Each bin holds about the same number of searches. Equal values are always in one bin. */
struct sim_curve {
    size_t n_bins; /* fewer than 2: the factor is unknown or has the same value for all probes */
    struct sim_curve_bin bins[SIM_CURVE_BINS];
};

/* Measures the factors of each probe, [n_probes][SIM_FACTORS], NaN where unknown. They come from
 * the probe's first capture; if this capture is not usable, all are unknown. The landmark error is
 * `landmark_error_mm` ([n_captures]) of this capture. */
void sim_factors_measure(const struct sim_corpus *corpus, const struct sim_acquisition *acquisition,
                         const struct sim_matches *matches, const double *landmark_error_mm,
                         double (*factor)[SIM_FACTORS]);

/* Computes one curve for each factor. A search whose mate scores below the threshold is a
 * non-match. -ENOMEM. */
int sim_curves_of(const struct sim_analysis *analysis, const struct sim_matches *matches,
                  const double (*factor)[SIM_FACTORS], double threshold,
                  struct sim_curve out[SIM_FACTORS]) __attribute__((warn_unused_result));

#endif
