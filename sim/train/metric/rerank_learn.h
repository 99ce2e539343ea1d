/* The weights of a fused score (core/match/rerank.h). */
#ifndef SIM_TRAIN_METRIC_RERANK_LEARN_H
#define SIM_TRAIN_METRIC_RERANK_LEARN_H

#include <stddef.h>

#include "isotherm/metric.h"

/* Comparisons of strangers: the metric's calibrated score, and -ln(rms / 1 mm) of the upper
 * faces' misfit (NaN if they could not be registered; such comparisons do not count). */
struct sim_rerank_pairs {
    size_t n;
    const double *score, *fit;
};

/* Finds the weights. The misfit is calibrated like the metric's score (sim_metric_calibrate). Both
 * are added (the sum rule: Kittler, Hatef, Duin and Matas 1998), and the sum is calibrated again.
 * So each score states its rarity among strangers, and mated comparisons are not used. The
 * alternative, weights that best separate the people held out (logistic regression), would nearly
 * ignore the surfaces: the metric was trained with similar people and hardly makes errors on them.
 * Surfaces are needed for other faces and sensors. Errors of sim_metric_calibrate, -ENOMEM. */
int sim_rerank_learn(const struct sim_rerank_pairs *strangers, struct iso_rerank_weights *out)
    __attribute__((warn_unused_result));

#endif
