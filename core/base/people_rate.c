#include "core/base/people_rate.h"

#include <math.h>
#include <stdbool.h>

void iso_people_rate_add(struct iso_people_rate *rate, size_t errors, size_t trials)
{
    const double own_errors = (double)errors, own_trials = (double)trials;
    rate->errors += errors;
    rate->trials += trials;
    rate->people++;
    rate->errors_squared += own_errors * own_errors;
    rate->errors_times_trials += own_errors * own_trials;
    rate->trials_squared += own_trials * own_trials;
}

double iso_people_rate_value(const struct iso_people_rate *rate)
{
    return rate->trials > 0 ? (double)rate->errors / (double)rate->trials : (double)NAN;
}

/* Whether there are errors and other trials, and at least two people, so that the variance can be
 * estimated. */
static bool has_variance(const struct iso_people_rate *rate)
{
    return rate->errors > 0 && rate->errors < rate->trials && rate->people >= 2;
}

double iso_people_rate_effective(const struct iso_people_rate *rate)
{
    const double people = (double)rate->people, trials = (double)rate->trials;
    if (rate->trials == rate->people) {
        return trials; /* one trial each */
    }
    if (!has_variance(rate)) {
        return people;
    }
    const double p = iso_people_rate_value(rate);
    const double residuals = rate->errors_squared - 2.0 * p * rate->errors_times_trials +
                             p * p * rate->trials_squared;
    const double variance = people / (people - 1.0) * residuals / (trials * trials);
    return variance > 0.0 ? fmin(trials, p * (1.0 - p) / variance) : trials;
}

struct iso_interval iso_people_rate_interval(const struct iso_people_rate *rate)
{
    if (rate->people == 0) {
        return (struct iso_interval){0.0, 1.0};
    }
    return iso_proportion_interval(iso_people_rate_value(rate), iso_people_rate_effective(rate));
}

struct iso_interval iso_people_rate_pair_interval(const struct iso_people_rate *rate)
{
    if (rate->people == 0) {
        return (struct iso_interval){0.0, 1.0};
    }
    const double effective = iso_people_rate_effective(rate);
    return iso_proportion_interval(iso_people_rate_value(rate),
                                   has_variance(rate) ? effective / 4.0 : effective);
}
