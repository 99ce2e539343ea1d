/* The state of site statistics. Internal to site*.c. */
#ifndef ISO_CORE_MATCH_SITE_STATE_H
#define ISO_CORE_MATCH_SITE_STATE_H

#include <stdbool.h>

#include "core/match/site.h"

/* Residuals are whole multiples of 1/4096 of the rendered standard deviation within a person. Their
 * products are whole numbers, too, so that sums of these are exact and do not depend on the order
 * of people. */
enum { ISO_SITE_UNITS = 4096 };

struct iso_site {
    int n;                                    /* dimensions */
    float between[ISO_METRIC_DIMENSIONS_MAX]; /* of the metric, [n] */
    size_t people, capacity, taught;
    int64_t *number;  /* [people]: the caller's numbers */
    float *mean;      /* [people][n]: the mean of each person's captures */
    int64_t weight;   /* sum over people who taught */
    int64_t *scatter; /* [n][n], lower triangle: weighted products of residuals */

    /* After the first pass. */
    bool has_directions;
    double median[ISO_METRIC_DIMENSIONS_MAX]; /* of the means of the people */
    double offset[ISO_METRIC_DIMENSIONS_MAX]; /* o */
    double *directions; /* [n][n]: column k is the k-th direction in which people vary */
    size_t reviewed, reviewed_taught;
    float *variance; /* [taught][n]: of each person along each direction; NULL after both passes */
    double value[ISO_METRIC_DIMENSIONS_MAX]; /* after both passes: the variance along a direction */
};

/* The weight of a person with n captures. */
int iso__site_weight(int n);

/* Computes the mean of n captures, [site->n]. -EINVAL if a number of it is not finite. */
int iso__site_mean(const struct iso_site *site, const struct iso_metric_vector *captures, int n,
                   double *mean) __attribute__((warn_unused_result));

/* Computes the difference between a capture and the mean of its person, shortened to the limit of
 * its length, as multiples of 1 / ISO_SITE_UNITS: [site->n] whole numbers. */
void iso__site_residual(const struct iso_site *site, const struct iso_metric_vector *capture,
                        const double *mean, double *out);

/* Sorts n values, rising. */
void iso__site_sort(float *value, size_t n);

/* A person's mean in dimension d, with the limited deviation that counts in the offset. */
double iso__site_clipped(const struct iso_site *site, size_t person, int d);

/* Computes median and offset. -ENOMEM. */
int iso__site_find_offset(struct iso_site *site) __attribute__((warn_unused_result));

/* Computes the covariance within a person, [n][n], lower triangle: W' of site.h. */
void iso__site_within(const struct iso_site *site, double *within);

/* a of site.h. */
double iso__site_share(const struct iso_site *site);

#endif
