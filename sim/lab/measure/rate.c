#include "sim/lab/measure/rate.h"

#include <math.h>

#include "core/base/proportion.h"

double sim_rate_value(struct sim_rate rate)
{
    return rate.trials > 0 ? (double)rate.events / (double)rate.trials : NAN;
}

struct sim_interval sim_rate_interval(struct sim_rate rate)
{
    if (rate.trials == 0) {
        return (struct sim_interval){0.0, 1.0};
    }
    const double z = 1.959963984540054; /* 97.5% quantile of the normal distribution */
    const double n = (double)rate.trials, p = sim_rate_value(rate);
    const double middle = (p + z * z / (2.0 * n)) / (1.0 + z * z / n);
    const double half = z / (1.0 + z * z / n) * sqrt(p * (1.0 - p) / n + z * z / (4.0 * n * n));
    /* At the ends the formula gives 0 and 1 except for rounding errors. */
    return (struct sim_interval){rate.events == 0 ? 0.0 : middle - half,
                                 rate.events == rate.trials ? 1.0 : middle + half};
}

struct sim_interval sim_rate_exact_interval(struct sim_rate rate)
{
    return sim_rate_effective_interval(sim_rate_value(rate), (double)rate.trials);
}

struct sim_interval sim_rate_effective_interval(double rate, double trials)
{
    const struct iso_interval interval = iso_proportion_interval(rate, trials);
    return (struct sim_interval){interval.low, interval.high};
}

double sim_rate_smallest(size_t trials)
{
    return trials > 3 ? 3.0 / (double)trials : 1.0;
}
