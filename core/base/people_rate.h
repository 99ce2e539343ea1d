/* Error rates of people with several trials each, with intervals that take people, not trials, as
 * independent. Pure.
 *
 * Somebody whom the appliance refuses once is refused again more often than others are. Several
 * trials of one person therefore say less than as many trials of different people. The interval is
 * the exact one for the effective number of trials (proportion.h): the number of independent trials
 * whose rate has the variance that is estimated from the people. It is at most the number of
 * trials. Without an error, or with nothing but errors, the variance is not known. The effective
 * number is then that of the people. */
#ifndef ISO_CORE_BASE_PEOPLE_RATE_H
#define ISO_CORE_BASE_PEOPLE_RATE_H

#include <stddef.h>

#include "core/base/proportion.h"

/* Counts that add up over people. All zero at first. */
struct iso_people_rate {
    size_t errors, trials, people;
    double errors_squared, errors_times_trials, trials_squared; /* sums over the people */
};

/* Adds one person with at least one trial. */
void iso_people_rate_add(struct iso_people_rate *rate, size_t errors, size_t trials);

/* The share of trials that are errors; NaN for nobody. */
double iso_people_rate_value(const struct iso_people_rate *rate);

/* The effective number of trials; 0 for nobody. */
double iso_people_rate_effective(const struct iso_people_rate *rate);

/* The 95 % interval; 0..1 for nobody. If every person has one trial, it is the exact interval. */
struct iso_interval iso_people_rate_interval(const struct iso_people_rate *rate);

/* The 95 % interval of trials that compare two people, each of which was added for both of them, so
 * that the counts are twice those of the trials. A trial then depends on two people, and a sum over
 * people contains every trial twice: the variance of the rate is four times the one that the counts
 * show (Lee, "U-Statistics", 1990, theorem 3 of section 1.3). The effective number is a quarter;
 * without an error it is that of the people, as above. 0..1 for nobody. */
struct iso_interval iso_people_rate_pair_interval(const struct iso_people_rate *rate);

#endif
