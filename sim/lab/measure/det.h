/* Verification: error rates of one-to-one comparisons over all thresholds.
 *
 * ISO/IEC 19795-1:2021. A comparison is accepted if its score is at least the threshold (a
 * higher score means greater similarity). FMR is the share of non-mated comparisons that are
 * accepted; FNMR is the share of mated comparisons that are not. Both leave out samples that
 * were not acquired. The caller computes the generalised rates, which include them (GFNMR counts
 * a lost sample as a failed mated comparison). */
#ifndef SIM_LAB_MEASURE_DET_H
#define SIM_LAB_MEASURE_DET_H

#include <stddef.h>
#include <stdint.h>

#include "sim/lab/measure/rate.h"

/* A comparison's score (not NaN, may be -INFINITY) and the number of the probe's person. */
struct sim_score {
    double score;
    uint32_t person;
};

struct sim_scores {
    struct sim_score *mated, *non_mated;
    size_t n_mated, n_non_mated;
};

/* Sorts both lists by rising score, as the functions below require. */
void sim_scores_sort(struct sim_scores *scores);

/* An operating point. */
struct sim_det_point {
    double threshold, fmr, fnmr;
};

/* Writes the operating point at every distinct score, by rising threshold (FMR falls, FNMR rises),
 * and at +INFINITY (0, 1) at the end. copies[person] is the weight of the person's comparisons
 * (NULL: 1). Writes at most n_mated + n_non_mated + 1 points and returns their number, which is 0
 * if the comparisons of one kind all have the weight 0. */
size_t sim_det_points(const struct sim_scores *scores, const uint32_t *copies,
                      struct sim_det_point *points);

/* Equal error rate: where FMR = FNMR on straight lines between neighbouring operating points (no
 * convex hull). NaN without points. */
double sim_det_eer(const struct sim_det_point *points, size_t n);

/* The operating point of the lowest threshold whose FMR is at most `fmr`. There is no
 * interpolation, so that the FNMR was observed at such an FMR. n >= 1. */
struct sim_det_point sim_det_at_fmr(const struct sim_det_point *points, size_t n, double fmr);

/* Computes 95% percentile intervals of the EER and of the FNMR at each of n_fmr FMRs. The people
 * of the probes are resampled, each with all comparisons of the person (subset bootstrap: Bolle,
 * Ratha and Pankanti 2004), because comparisons of one person are not independent. The people of
 * the gallery stay the same. Person numbers are below n_people. The same scores give the same
 * intervals. -EINVAL if a kind of score is missing or there are fewer than 2 people, -ENOMEM. */
int sim_det_bootstrap(const struct sim_scores *scores, uint32_t n_people, const double *fmr,
                      size_t n_fmr, struct sim_interval *eer, struct sim_interval *fnmr)
    __attribute__((warn_unused_result));

#endif
