/* The confidence interval of a proportion, such as an error rate. Pure. */
#ifndef ISO_CORE_BASE_PROPORTION_H
#define ISO_CORE_BASE_PROPORTION_H

struct iso_interval {
    double low, high;
};

/* The exact 95 % interval of a proportion (Clopper and Pearson, "The use of confidence or fiducial
 * limits illustrated in the case of the binomial", 1934). `rate` is 0..1. `trials` is the number of
 * independent trials, or the effective number of dependent ones: that of the independent trials
 * whose rate has the same variance. It need not be a whole number (Korn and Graubard, "Confidence
 * intervals for proportions with small expected number of positive counts estimated from survey
 * data", 1998). 0..1 if `trials` is 0. */
struct iso_interval iso_proportion_interval(double rate, double trials);

#endif
