/* Mean and quantiles of a set of numbers. */
#ifndef SIM_BASE_SPREAD_H
#define SIM_BASE_SPREAD_H

#include <stddef.h>

struct sim_spread {
    size_t n; /* 0: the other fields are 0 */
    double mean, median, p95, max;
};

/* Index of a quantile of n >= 1 sorted values: the smallest value that `percent` (1..100) of the
 * values do not exceed. */
static inline size_t sim_quantile_index(size_t n, size_t percent)
{
    return (n * percent + 99) / 100 - 1;
}

/* Sorts n >= 1 values in rising order. */
void sim_sort(double *values, size_t n);

/* Sorts the values in place. Quantiles are those of sim_quantile_index. */
struct sim_spread sim_spread_of(double *values, size_t n);

#endif
