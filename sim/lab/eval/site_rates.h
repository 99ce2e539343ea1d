/* The error rates of pooled comparisons of a site split, with intervals over people. */
#ifndef SIM_LAB_EVAL_SITE_RATES_H
#define SIM_LAB_EVAL_SITE_RATES_H

#include "sim/lab/eval/site_split.h"

/* Sorts the scores, whose person numbers are below n_people, and sets the rates of *out from them
 * and from its count of refused searches. -ENOMEM. */
int sim_site_rates(struct sim_scores *scores, uint32_t n_people, struct sim_site_split *out)
    __attribute__((warn_unused_result));

#endif
