/* Verification: error rates of one-to-one comparisons over all thresholds.
 *
 * ISO/IEC 19795-1:2021. A comparison is accepted if its score is at least the threshold (higher is
 * more alike). FMR: share of the non-mated comparisons that are accepted. FNMR: share of the mated
 * ones that are not. Both leave out samples that could not be acquired; the generalised rates,
 * which do not, are the caller's (GFNMR counts a lost sample as a failed mated comparison). */
#ifndef SIM_LAB_MEASURE_DET_H
#define SIM_LAB_MEASURE_DET_H

#include <stddef.h>
#include <stdint.h>

#include "sim/lab/measure/rate.h"

/* A comparison's score (not NaN, may be -INFINITY) and the number of the person whose probe it was.
 */
struct sim_score {
    double score;
    uint32_t person;
};

struct sim_scores {
    struct sim_score *mated, *non_mated;
    size_t n_mated, n_non_mated;
};

/* By rising score, as the functions below want them. */
void sim_scores_sort(struct sim_scores *scores);

/* An operating point. */
struct sim_det_point {
    double threshold, fmr, fnmr;
};

/* The operating point at every distinct score, by rising threshold (FMR falls, FNMR rises), and at
 * +INFINITY (0, 1) at the end. `copies` says how often each person's comparisons count (NULL:
 * once). Writes at most n_mated + n_non_mated + 1 points and returns how many; 0 if either kind has
 * no comparison that counts. */
size_t sim_det_points(const struct sim_scores *scores, const uint32_t *copies,
                      struct sim_det_point *points);

/* Equal error rate: where FMR = FNMR on straight lines between neighbouring operating points (no
 * convex hull). NaN without points. */
double sim_det_eer(const struct sim_det_point *points, size_t n);

/* The operating point of the lowest threshold whose FMR is not above `fmr`: no interpolation, so
 * that the FNMR was really observed at such an FMR. n >= 1. */
struct sim_det_point sim_det_at_fmr(const struct sim_det_point *points, size_t n, double fmr);

/* 95% percentile intervals of the EER and of the FNMR at each of n_fmr FMRs, by resampling the
 * people whose probes they are, each with all of his or her comparisons (subset bootstrap: Bolle,
 * Ratha and Pankanti 2004), because comparisons of one person are not independent. Gallery people
 * are kept. Persons are numbered below n_people. Reproducible. -EINVAL if a kind of score is
 * missing or there are fewer than 2 people, -ENOMEM. */
int sim_det_bootstrap(const struct sim_scores *scores, uint32_t n_people, const double *fmr,
                      size_t n_fmr, struct sim_interval *eer, struct sim_interval *fnmr)
    __attribute__((warn_unused_result));

#endif
