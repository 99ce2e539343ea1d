#include "sim/base/spread.h"

#include <stdlib.h>

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

void sim_sort(double *values, size_t n)
{
    qsort(values, n, sizeof *values, by_value);
}

struct sim_spread sim_spread_of(double *values, size_t n)
{
    if (n == 0) {
        return (struct sim_spread){0, 0.0, 0.0, 0.0, 0.0};
    }
    double sum = 0.0;
    sim_sort(values, n);
    for (size_t i = 0; i < n; i++) {
        sum += values[i];
    }
    return (struct sim_spread){
        .n = n,
        .mean = sum / (double)n,
        .median = values[sim_quantile_index(n, 50)],
        .p95 = values[sim_quantile_index(n, 95)],
        .max = values[n - 1],
    };
}
