/* The cost of wrong decisions at the thresholds of the security levels (NIST, detection cost
 * function).
 *
 * A level states how much worse a false match is than a false non-match: w = C_false (1 - P) /
 * (C_miss P), where P is the prior probability of a mated comparison. The cost, divided by that of
 * the cheaper of the two decisions that need no score, is (van Leeuwen and Bruemmer 2007)
 *
 *     DCF = FNMR + w FMR,    w >= 1,
 *
 * so that 1 is the cost of a door that never opens. The weights are those of NIST's speaker
 * recognition evaluations of 2008 (C_miss = 10, C_false = 1, P = 0.01), 2012 (1, 1, 0.01; the first
 * of its two costs) and 2010 (1, 1, 0.001). At each level, false matches at the promised rate cost
 * about as much as false non-matches of 10 %. */
#ifndef SIM_LAB_MEASURE_DETECTION_COST_H
#define SIM_LAB_MEASURE_DETECTION_COST_H

#include "sim/lab/measure/det.h"

enum { SIM_DETECTION_COSTS = 3 };

struct sim_detection_cost {
    const char *level;       /* "convenient", "balanced", "strict" */
    double threshold;        /* score that one comparison has to reach: 2, 3, 4 */
    double weight;           /* w: 9.9, 99, 999 */
    double actual;           /* DCF at this threshold */
    double minimum, best_at; /* the least DCF of all thresholds, and the lowest such threshold; it
                                is INFINITY if no score is worth a match */
};

/* Computes the costs from sorted scores (sim_scores_sort) of a metric. Both costs are NaN without
 * scores of one of the kinds. -ENOMEM. */
int sim_detection_costs_of(const struct sim_scores *scores,
                           struct sim_detection_cost out[SIM_DETECTION_COSTS])
    __attribute__((warn_unused_result));

#endif
