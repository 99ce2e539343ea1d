/* Counted error rates and their confidence intervals. */
#ifndef SIM_LAB_MEASURE_RATE_H
#define SIM_LAB_MEASURE_RATE_H

#include <stddef.h>

/* A number of events in a number of trials. */
struct sim_rate {
    size_t events, trials;
};

struct sim_interval {
    double low, high;
};

/* events / trials; NaN without trials. */
double sim_rate_value(struct sim_rate rate);

/* The 95% score interval of a proportion (Wilson 1927; recommended by Brown, Cai and DasGupta
 * 2001 for small counts). It assumes independent trials. Several trials of one person are not
 * independent, so that the interval is then too narrow. 0..1 without trials. */
struct sim_interval sim_rate_interval(struct sim_rate rate);

/* The exact 95% interval of a proportion (Clopper and Pearson 1934), for rates that are reported
 * against a limit. Its coverage is never below 95%, whatever the count. It also assumes
 * independent trials. 0..1 without trials. */
struct sim_interval sim_rate_exact_interval(struct sim_rate rate);

/* The same interval for a rate (0..1) that has the variance of `trials` independent trials, which
 * need not be a whole number: the effective sample size of dependent trials (Korn and Graubard
 * 1998). 0..1 if it is 0. */
struct sim_interval sim_rate_effective_interval(double rate, double trials);

/* The smallest rate that a number of trials can support with 95% confidence if no event occurs:
 * the rule of 3, 3 / trials (ISO/IEC 19795-1:2021, annex B). 1 for fewer than 3 trials. */
double sim_rate_smallest(size_t trials);

#endif
