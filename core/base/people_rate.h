/* Error rates of people with several trials each. The intervals treat people as independent, not
 * trials. Pure.
 *
 * The trials of one person depend on each other: a person who has been refused once is likely to be
 * refused again. Ten trials of one person therefore say less about the rate than one trial of each
 * of ten people. The effective number of trials takes this into account. It is the number of
 * independent trials whose rate would have the same variance as this rate. The variance is
 * estimated from the differences between the people. The effective number is at most the number of
 * trials. If no trial is an error, or if all are, the variance cannot be estimated, and the number
 * of people serves as the effective number. The interval is the exact one for the effective number
 * (proportion.h). */
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

/* The 95 % interval; 0..1 for nobody. If every person has one trial, it is the exact interval of
 * that many independent trials. */
struct iso_interval iso_people_rate_interval(const struct iso_people_rate *rate);

/* The 95 % interval of trials that compare two people. The caller adds each trial twice: once for
 * each of the two people. The variance of the rate is then four times the variance that the counts
 * show (Lee, "U-Statistics", 1990, theorem 3 of section 1.3), and the effective number of trials is
 * a quarter. If the variance cannot be estimated, the effective number is that of the people, as
 * above. 0..1 for nobody. */
struct iso_interval iso_people_rate_pair_interval(const struct iso_people_rate *rate);

#endif
