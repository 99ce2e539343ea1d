/* Counted error rates and what the counts can support. */
#ifndef SIM_LAB_MEASURE_RATE_H
#define SIM_LAB_MEASURE_RATE_H

#include <stddef.h>

/* So many events in so many trials. */
struct sim_rate {
    size_t events, trials;
};

struct sim_interval {
    double low, high;
};

/* events / trials; NaN without trials. */
double sim_rate_value(struct sim_rate rate);

/* The 95% score interval of a proportion (Wilson 1927; recommended by Brown, Cai and DasGupta 2001
 * for small counts). It takes the trials to be independent: several trials of one person are not,
 * so that it is then too narrow. 0..1 without trials. */
struct sim_interval sim_rate_interval(struct sim_rate rate);

/* The exact 95% interval of a proportion (Clopper and Pearson 1934): never covers less than it
 * says, whatever the count; for rates that are reported against a limit. The same trials are taken
 * to be independent. 0..1 without trials. */
struct sim_interval sim_rate_exact_interval(struct sim_rate rate);

/* The smallest rate that so many trials can support with 95% confidence if no event is seen: the
 * rule of 3, 3 / trials (ISO/IEC 19795-1:2021, annex B). 1 for fewer than 3 trials. */
double sim_rate_smallest(size_t trials);

#endif
