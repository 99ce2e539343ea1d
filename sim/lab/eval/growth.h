/* How the error rates of identification grow with the number of people enrolled.
 *
 * For a gallery of N people, N people are drawn from the M that are really enrolled. The figures
 * are the exact expectation over all such draws (hypergeometric), for every search. With
 * a constant threshold, FPIR grows about as 1 - (1 - FMR)^N (ISO/IEC 19795-1:2021; Grother and
 * Phillips 2004); with a constant FPIR, FNIR grows. */
#ifndef SIM_LAB_EVAL_GROWTH_H
#define SIM_LAB_EVAL_GROWTH_H

#include "sim/lab/eval/analysis.h"

enum { SIM_GROWTH_MAX = 16 };

struct sim_growth_point {
    size_t n_people;
    double fpir, fnir;   /* at the threshold of the target FPIR with all people enrolled */
    double fnir_at_fpir; /* at the threshold that keeps the target FPIR for n people */
};

struct sim_growth {
    double target_fpir, threshold;
    size_t n; /* 0: no searches, no strangers, or nobody enrolled */
    /* 10, 20, 50, 100, ... people, and all people. */
    struct sim_growth_point points[SIM_GROWTH_MAX];
};

/* Computes the error rates for galleries of rising size. -ENOMEM. */
int sim_growth_of(const struct sim_gallery *gallery, const struct sim_matches *matches,
                  const struct sim_analysis *analysis, double target_fpir, struct sim_growth *out)
    __attribute__((warn_unused_result));

/* The probability that n draws without replacement from m contain none of k given elements. */
double sim_growth_missed(size_t m, size_t k, size_t n);

#endif
