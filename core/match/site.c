#include "core/match/site.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/wipe.h"
#include "core/match/site_state.h"

/* The limit of a person's deviation from the median of the people, for each dimension, in standard
 * deviations between people. The offset is the median plus the mean of the limited deviations, so
 * that nobody can move it far (Huber 1964: one step towards his estimate of location). */
static const double deviation_limit = 2.0;

/* The limit of the squared difference between a capture and the mean of its person, averaged over
 * the dimensions. A capture that differs more is moved towards the mean. Rendered captures have 1
 * on average. A sensor with coarse depth gives up to 4. */
static const double residual_limit = 8.0;

/* The weight of a person is the number of captures less one, at most WEIGHT_MAX. When the sum of
 * the weights is WEIGHT_HALF, the share `a` is half of its limit. */
enum { WEIGHT_MAX = 4, WEIGHT_HALF = 16 };

int iso_site_new(const struct iso_metric *metric, struct iso_site **out)
{
    const size_t n = (size_t)metric->n_dimensions;
    struct iso_site *site = calloc(1, sizeof *site);
    if (!site) {
        return -ENOMEM;
    }
    site->n = metric->n_dimensions;
    memcpy(site->between, metric->between, n * sizeof *site->between);
    site->scatter = calloc(n * n, sizeof *site->scatter);
    site->directions = calloc(n * n, sizeof *site->directions);
    if (!site->scatter || !site->directions) {
        iso_site_free(site);
        return -ENOMEM;
    }
    *out = site;
    return 0;
}

void iso_site_free(struct iso_site *site)
{
    if (!site) {
        return;
    }
    iso_wipe_free(site->number);
    iso_wipe_free(site->mean);
    iso_wipe_free(site->scatter);
    iso_wipe_free(site->directions);
    iso_wipe_free(site->variance);
    iso_wipe_free(site);
}

/* ---- the first pass ---- */

int iso__site_weight(int n)
{
    return n - 1 < WEIGHT_MAX ? n - 1 : WEIGHT_MAX;
}

int iso__site_mean(const struct iso_site *site, const struct iso_metric_vector *captures, int n,
                   double *mean)
{
    for (int d = 0; d < site->n; d++) {
        mean[d] = 0.0;
        for (int i = 0; i < n; i++) {
            mean[d] += (double)captures[i].mean[d];
        }
        mean[d] /= n;
        if (!isfinite(mean[d])) {
            return -EINVAL;
        }
    }
    return 0;
}

void iso__site_residual(const struct iso_site *site, const struct iso_metric_vector *capture,
                        const double *mean, double *out)
{
    double length = 0.0;
    for (int d = 0; d < site->n; d++) {
        const double x = (double)capture->mean[d] - mean[d];
        length += x * x;
    }
    const double scale = fmin(1.0, sqrt(residual_limit * site->n / fmax(length, 1e-9)));
    for (int d = 0; d < site->n; d++) {
        out[d] = rint(ISO_SITE_UNITS * scale * ((double)capture->mean[d] - mean[d]));
    }
}

/* Adds a person's covariance, which is estimated from the residuals, times the weight of the
 * person. The products of residuals are below 2^36 and their sums below 2^42, so that numbers of
 * double precision hold them exactly. Processors multiply such numbers faster than integers of 64
 * bits. */
static int add_scatter(struct iso_site *site, const struct iso_metric_vector *captures, int n,
                       const double *mean)
{
    const int weight = iso__site_weight(n);
    double residual[ISO_METRIC_DIMENSIONS_MAX];
    double *own = calloc((size_t)site->n * (size_t)site->n, sizeof *own);
    if (!own) {
        return -ENOMEM;
    }
    for (int i = 0; i < n; i++) {
        iso__site_residual(site, &captures[i], mean, residual);
        for (int r = 0; r < site->n; r++) {
            for (int c = 0; c <= r; c++) {
                own[r * site->n + c] += residual[r] * residual[c];
            }
        }
    }
    for (int r = 0; r < site->n; r++) {
        for (int c = 0; c <= r; c++) {
            const int64_t product = (int64_t)own[r * site->n + c];
            /* A division takes long, and most people have few captures. */
            site->scatter[r * site->n + c] += weight == n - 1 ? product
                                                              : product * weight / (n - 1);
        }
    }
    explicit_bzero(residual, sizeof residual);
    iso_wipe_free(own);
    site->weight += weight;
    site->taught++;
    return 0;
}

static int reserve_person(struct iso_site *site)
{
    if (site->people < site->capacity) {
        return 0;
    }
    const size_t n = (size_t)site->n, capacity = site->capacity ? 2 * site->capacity : 16;
    int64_t *number = iso_wipe_grow(site->number, site->people, capacity, sizeof *number);
    if (!number) {
        return -ENOMEM;
    }
    site->number = number;
    float *mean = iso_wipe_grow(site->mean, site->people, capacity, n * sizeof *mean);
    if (!mean) {
        return -ENOMEM;
    }
    site->mean = mean;
    site->capacity = capacity;
    return 0;
}

int iso_site_add(struct iso_site *site, int64_t number, const struct iso_metric_vector *captures,
                 int n)
{
    double mean[ISO_METRIC_DIMENSIONS_MAX] = {0};
    const int used = n < ISO_SITE_CAPTURES ? n : ISO_SITE_CAPTURES;
    if (n < 1 || site->has_directions || iso__site_mean(site, captures, used, mean)) {
        return -EINVAL;
    }
    int error = reserve_person(site);
    if (!error && used > 1) {
        error = add_scatter(site, captures, used, mean);
    }
    if (!error) {
        for (int d = 0; d < site->n; d++) {
            site->mean[site->people * (size_t)site->n + (size_t)d] = (float)mean[d];
        }
        site->number[site->people++] = number;
    }
    explicit_bzero(mean, sizeof mean);
    return error;
}

/* ---- the offset ---- */

static int by_value(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

void iso__site_sort(float *value, size_t n)
{
    qsort(value, n, sizeof *value, by_value);
}

double iso__site_clipped(const struct iso_site *site, size_t person, int d)
{
    const double limit = deviation_limit * sqrt(1.0 + (double)site->between[d]);
    const double off = (double)site->mean[person * (size_t)site->n + (size_t)d] - site->median[d];
    return site->median[d] + fmax(-limit, fmin(limit, off));
}

/* Computes the offset in one dimension from the sorted means of the people. The offset of n people
 * is multiplied by n / (n + 1), because that of few people is uncertain. */
static void find_offset_at(struct iso_site *site, int d, const float *value)
{
    const size_t n = site->people;
    const double limit = deviation_limit * sqrt(1.0 + (double)site->between[d]);
    const double median = 0.5 * ((double)value[(n - 1) / 2] + (double)value[n / 2]);
    double sum = 0.0;
    for (size_t p = 0; p < n; p++) {
        sum += fmax(-limit, fmin(limit, (double)value[p] - median));
    }
    site->median[d] = median;
    site->offset[d] = ((double)n * median + sum) / (double)(n + 1);
}

int iso__site_find_offset(struct iso_site *site)
{
    float *value = calloc(site->people + 1, sizeof *value);
    if (!value) {
        return -ENOMEM;
    }
    for (int d = 0; site->people > 0 && d < site->n; d++) {
        for (size_t p = 0; p < site->people; p++) {
            value[p] = site->mean[p * (size_t)site->n + (size_t)d];
        }
        iso__site_sort(value, site->people);
        find_offset_at(site, d, value);
    }
    iso_wipe_free(value);
    return 0;
}

/* ---- the summary ---- */

double iso__site_share(const struct iso_site *site)
{
    return 0.5 * (double)site->weight / (double)(site->weight + WEIGHT_HALF);
}

struct iso_site_summary iso_site_summary(const struct iso_site *site)
{
    const double n = (double)site->people;
    struct iso_site_summary s = {.people = (int)site->people,
                                 .taught = (int)site->taught,
                                 .share = iso__site_share(site),
                                 .expected = sqrt(site->n * n) / (n + 1.0)};
    double square = 0.0;
    for (int d = 0; d < site->n; d++) {
        square += site->offset[d] * site->offset[d] / (1.0 + (double)site->between[d]);
        s.growth += site->value[d] / site->n;
    }
    s.offset = sqrt(square);
    return s;
}
