/* The result of a comparison of methods for one method on one corpus. */
#ifndef SIM_LAB_EVAL_VERDICT_H
#define SIM_LAB_EVAL_VERDICT_H

#include "sim/lab/eval/eval.h"
#include "sim/lab/measure/paired.h"

enum {
    SIM_VERDICT_FMR = 2,        /* index of the FMR of the table: 1e-3 */
    SIM_VERDICT_COARSE_FMR = 1, /* 1e-2: more informative when there are few searches */
};

struct sim_verdict {
    const struct sim_method *method;
    int64_t wall_ns;                      /* duration, including learning */
    struct sim_rate rank_1, rank_4, lost; /* lost: mated searches without a comparison */
    double eer;                           /* NaN: too few comparisons */
    struct sim_interval eer_interval;
    /* The FMR of `at`: 1e-3, or the next higher target that the comparisons support, at most 0.1 */
    double fmr;
    struct sim_operating_point at, at_coarse;
    /* Compared with the first method: errors at rank 1, and non-matches at that FMR. */
    struct sim_paired at_rank_1, at_fmr;
};

/* The verdict on method number `index`, which was not skipped, compared with the first method
 * that was not. -ENOMEM. */
int sim_verdict_of(const struct sim_eval *eval, size_t index, struct sim_verdict *out)
    __attribute__((warn_unused_result));

#endif
