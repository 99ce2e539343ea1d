/* How much the people of a site vary from capture to capture, and in which directions.
 *
 * The directions are the eigenvectors of the pooled covariance of the people. The variance along a
 * direction is a mean over the people, without those who vary most along it: a tenth of the people,
 * but at least one. An attacker may enrol captures that vary along the difference of two other
 * people, so that these look alike. If nobody else varies along this direction, the mean leaves
 * these captures out. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/lapack.h"
#include "core/base/wipe.h"
#include "core/match/site_state.h"

/* The largest variance that a direction may have, as a multiple of the variance of rendered people.
 * Real people before a Kinect v2 exceed this limit in five of 152 directions. To limit the variance
 * of these five did not make recognition worse. */
static const double variance_limit = 6.0;

/* With this sum of weights, half of a direction's excess over the mean variance counts. */
enum { KNOWN_HALF = 50 };

int iso_site_find_directions(struct iso_site *site)
{
    const size_t n = (size_t)site->n;
    double value[ISO_METRIC_DIMENSIONS_MAX];
    int error = site->has_directions ? -EINVAL : iso__site_find_offset(site);
    if (error) {
        return error;
    }
    free(site->variance); /* from an earlier call that failed; nothing was written to it */
    site->variance = calloc(site->taught * n + 1, sizeof *site->variance);
    if (!site->variance) {
        return -ENOMEM;
    }
    for (size_t i = 0; i < n * n; i++) {
        site->directions[i] = (double)site->scatter[i];
    }
    if (site->taught > 0) {
        error = iso_lapack_error(
            LAPACKE_dsyev(LAPACK_ROW_MAJOR, 'V', 'L', site->n, site->directions, site->n, value));
        explicit_bzero(value, sizeof value);
    }
    site->has_directions = error == 0;
    return error;
}

/* Adds the squares of a capture's coordinates along all directions. */
static void add_squares(const struct iso_site *site, const double *residual, double weight,
                        float *variance)
{
    const size_t n = (size_t)site->n;
    double along[ISO_METRIC_DIMENSIONS_MAX] = {0};
    for (size_t d = 0; d < n; d++) {
        for (size_t k = 0; k < n; k++) {
            along[k] += residual[d] * site->directions[d * n + k];
        }
    }
    for (size_t k = 0; k < n; k++) {
        variance[k] += (float)(weight * along[k] * along[k]);
    }
    explicit_bzero(along, sizeof along);
}

/* The mean of n sorted values without the largest ones. A single value, of one person, is left out
 * as well: the result is then 1, the variance of rendered people. */
static double mean_of_most(const float *value, size_t n)
{
    const size_t most = n - (n / 10 > 1 ? n / 10 : 1);
    double sum = 0.0;
    for (size_t i = 0; i < most; i++) {
        sum += (double)value[i];
    }
    return most > 0 ? sum / (double)most : 1.0;
}

/* The variance of the people, averaged over all directions. `value` is working memory for one
 * number of each person. */
static double mean_variance(const struct iso_site *site, float *value)
{
    const size_t n = (size_t)site->n;
    for (size_t p = 0; p < site->taught; p++) {
        value[p] = 0.0f;
        for (size_t k = 0; k < n; k++) {
            value[p] += site->variance[p * n + k] / (float)n;
        }
    }
    iso__site_sort(value, site->taught);
    return fmin(mean_of_most(value, site->taught), variance_limit);
}

/* Ends the second pass: computes the variance along each direction. A few captures show how much
 * people vary on the whole, but not how the variance is distributed over the directions. Therefore
 * the variances shrink towards their mean (Ledoit and Wolf 2004).
 *
 * A variance below the mean is replaced by the mean, for two reasons. If there are few captures,
 * the measured variance along most directions is nearly zero, although people do vary there. And
 * an attacker who can turn the directions could choose one with a variance of nearly zero. */
static int find_values(struct iso_site *site)
{
    const size_t n = (size_t)site->n;
    const double known = (double)site->weight / (double)(site->weight + KNOWN_HALF);
    float *value = calloc(site->taught, sizeof *value);
    if (!value) {
        return -ENOMEM;
    }
    const double mean = mean_variance(site, value);
    for (size_t k = 0; k < n; k++) {
        for (size_t p = 0; p < site->taught; p++) {
            value[p] = site->variance[p * n + k];
        }
        iso__site_sort(value, site->taught);
        const double along = fmin(mean_of_most(value, site->taught), variance_limit);
        site->value[k] = mean + known * fmax(along - mean, 0.0);
    }
    iso_wipe_free(value);
    iso_wipe_free(site->variance);
    site->variance = NULL;
    return 0;
}

static void add_person(struct iso_site *site, const struct iso_metric_vector *captures, int n,
                       const double *mean)
{
    const double weight = 1.0 / ((double)ISO_SITE_UNITS * ISO_SITE_UNITS * (n - 1));
    double residual[ISO_METRIC_DIMENSIONS_MAX];
    for (int i = 0; i < n; i++) {
        iso__site_residual(site, &captures[i], mean, residual);
        add_squares(site, residual, weight,
                    &site->variance[site->reviewed_taught * (size_t)site->n]);
    }
    site->reviewed_taught++;
    explicit_bzero(residual, sizeof residual);
}

int iso_site_review(struct iso_site *site, const struct iso_metric_vector *captures, int n)
{
    const int used = n < ISO_SITE_CAPTURES ? n : ISO_SITE_CAPTURES;
    double mean[ISO_METRIC_DIMENSIONS_MAX] = {0};
    if (n < 1 || !site->has_directions || site->reviewed == site->people ||
        (used > 1 && site->reviewed_taught == site->taught) ||
        iso__site_mean(site, captures, used, mean)) {
        return -EINVAL;
    }
    if (used > 1) {
        add_person(site, captures, used, mean);
    }
    explicit_bzero(mean, sizeof mean);
    if (site->reviewed + 1 == site->people && site->taught > 0) {
        const int error = find_values(site);
        if (error) {
            return error; /* the review stays incomplete, so that iso_site_adapt() refuses it */
        }
    }
    site->reviewed++;
    return 0;
}

void iso__site_within(const struct iso_site *site, double *within)
{
    const size_t n = (size_t)site->n;
    const double a = iso__site_share(site);
    for (size_t r = 0; r < n; r++) {
        for (size_t c = 0; c <= r; c++) {
            double sum = (r == c ? 1.0 - a : 0.0) + site->offset[r] * site->offset[c];
            for (size_t k = 0; site->taught > 0 && k < n; k++) {
                sum += a * site->value[k] * site->directions[r * n + k] *
                       site->directions[c * n + k];
            }
            within[r * n + c] = sum;
        }
    }
}
