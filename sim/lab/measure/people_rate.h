/* Rates of visits, with intervals that take people, not visits, as independent.
 *
 * Somebody whom the appliance refuses once is refused again more often than others are. Several
 * visits of one person therefore say less than as many visits of different people. The interval is
 * the exact one of Clopper and Pearson for the effective number of visits (Korn and Graubard,
 * "Confidence intervals for proportions with small expected number of positive counts estimated
 * from survey data", 1998): the number of independent visits whose rate has the variance that is
 * estimated from the people. It is at most the number of visits. Without an error, or with nothing
 * but errors, the variance is not known. The effective number is then that of the people. */
#ifndef SIM_LAB_MEASURE_PEOPLE_RATE_H
#define SIM_LAB_MEASURE_PEOPLE_RATE_H

#include "sim/lab/measure/rate.h"

/* Counts that add up over people. All zero at first. */
struct sim_people_rate {
    struct sim_rate visits; /* errors, and visits */
    size_t people;
    double errors_squared, errors_times_visits, visits_squared; /* sums over the people */
};

/* Adds one person with at least one visit. */
void sim_people_rate_add(struct sim_people_rate *rate, struct sim_rate person);

/* The effective number of visits; 0 for nobody. */
double sim_people_rate_effective(const struct sim_people_rate *rate);

/* The 95 % interval; 0..1 for nobody. If every person has one visit, it is
 * sim_rate_exact_interval(). */
struct sim_interval sim_people_rate_interval(const struct sim_people_rate *rate);

#endif
