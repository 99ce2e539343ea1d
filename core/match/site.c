#include "core/match/site.h"

#include <errno.h>
#include <lapacke.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/wipe.h"

/* Sums are of numbers that are rounded to 2^-12 of the rendered standard deviation within a person.
 */
static const double unit = 4096.0;

/* The limit of the squared difference between a capture and the mean of its person, for each
 * dimension. Rendered captures have 1 on average. A sensor with coarse depth gives up to 4. */
static const double residual_limit = 8.0;

/* The weight of a person is the number of captures less one, at most this. The share `a` reaches
 * half of its limit with this sum of weights. */
enum { WEIGHT_MAX = 16, WEIGHT_HALF = 16 };

struct iso_site {
    int n;                                    /* dimensions */
    float between[ISO_METRIC_DIMENSIONS_MAX]; /* of the metric, [n] */
    int64_t people, taught;
    int64_t weight;   /* sum over people who taught */
    int64_t *sum;     /* [n]: the means of the people, in units */
    int64_t *scatter; /* [n][n], lower triangle: weighted products of residuals, in units squared */
};

int iso_site_new(const struct iso_metric *metric, struct iso_site **out)
{
    const size_t n = (size_t)metric->n_dimensions;
    struct iso_site *site = calloc(1, sizeof *site);
    if (!site) {
        return -ENOMEM;
    }
    site->n = metric->n_dimensions;
    memcpy(site->between, metric->between, n * sizeof *site->between);
    site->sum = calloc(n, sizeof *site->sum);
    site->scatter = calloc(n * n, sizeof *site->scatter);
    if (!site->sum || !site->scatter) {
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
    iso_wipe_free(site->sum);
    iso_wipe_free(site->scatter);
    iso_wipe_free(site);
}

/* Computes the mean of n captures, [site->n]. -EINVAL if a number of it is not finite. */
static int mean_of(const struct iso_site *site, const struct iso_metric_vector *captures, int n,
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

/* Adds the mean of a person, shortened to its limit. */
static void add_mean(struct iso_site *site, const double *mean, int sign)
{
    double length = 0.0;
    for (int d = 0; d < site->n; d++) {
        length += mean[d] * mean[d] / (1.0 + (double)site->between[d]);
    }
    const double scale = fmin(1.0, sqrt(ISO_SITE_LENGTH_LIMIT * site->n / fmax(length, 1e-9)));
    for (int d = 0; d < site->n; d++) {
        site->sum[d] += sign * (int64_t)llrint(unit * scale * mean[d]);
    }
}

/* What is left of a capture when its person's mean is subtracted, shortened to its limit: whole
 * numbers. */
static void residual_of(const struct iso_site *site, const struct iso_metric_vector *capture,
                        const double *mean, double *out)
{
    double length = 0.0;
    for (int d = 0; d < site->n; d++) {
        const double x = (double)capture->mean[d] - mean[d];
        length += x * x;
    }
    const double scale = fmin(1.0, sqrt(residual_limit * site->n / fmax(length, 1e-9)));
    for (int d = 0; d < site->n; d++) {
        out[d] = rint(unit * scale * ((double)capture->mean[d] - mean[d]));
    }
}

/* Adds the products of the residuals of a person, as an estimate of the covariance times the weight
 * of the person. The products are below 2^36 and their sums below 2^42, so that numbers of double
 * precision hold them exactly; processors multiply these faster than integers of 64 bits. */
static int add_scatter(struct iso_site *site, const struct iso_metric_vector *captures, int n,
                       const double *mean, int sign)
{
    const int weight = n - 1 < WEIGHT_MAX ? n - 1 : WEIGHT_MAX;
    double residual[ISO_METRIC_DIMENSIONS_MAX];
    double *own = calloc((size_t)site->n * (size_t)site->n, sizeof *own);
    if (!own) {
        return -ENOMEM;
    }
    for (int i = 0; i < n; i++) {
        residual_of(site, &captures[i], mean, residual);
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
            const int64_t weighed = weight == n - 1 ? product : product * weight / (n - 1);
            site->scatter[r * site->n + c] += sign * weighed;
        }
    }
    explicit_bzero(residual, sizeof residual);
    iso_wipe_free(own);
    site->weight += sign * weight;
    site->taught += sign;
    return 0;
}

static int change_people(struct iso_site *site, const struct iso_metric_vector *captures, int n,
                         int sign)
{
    double mean[ISO_METRIC_DIMENSIONS_MAX];
    const int used = n < ISO_SITE_CAPTURES ? n : ISO_SITE_CAPTURES;
    if (n < 1 || mean_of(site, captures, used, mean)) {
        return -EINVAL;
    }
    const int error = used > 1 ? add_scatter(site, captures, used, mean, sign) : 0;
    if (!error) {
        add_mean(site, mean, sign);
        site->people += sign;
    }
    explicit_bzero(mean, sizeof mean);
    return error;
}

int iso_site_add(struct iso_site *site, const struct iso_metric_vector *captures, int n)
{
    return change_people(site, captures, n, 1);
}

int iso_site_remove(struct iso_site *site, const struct iso_metric_vector *captures, int n)
{
    return site->people > 0 ? change_people(site, captures, n, -1) : -EINVAL;
}

/* The offset shrinks to zero for few people: the mean of n people is taken n / (n + 1) times. */
static double offset_at(const struct iso_site *site, int d)
{
    return (double)site->sum[d] / unit / (double)(site->people + 1);
}

static double share_of(const struct iso_site *site)
{
    return 0.5 * (double)site->weight / (double)(site->weight + WEIGHT_HALF);
}

struct iso_site_summary iso_site_summary(const struct iso_site *site)
{
    struct iso_site_summary s = {
        .people = (int)site->people, .taught = (int)site->taught, .share = share_of(site)};
    double square = 0.0, trace = 0.0;
    for (int d = 0; d < site->n; d++) {
        const double x = offset_at(site, d);
        square += x * x / (1.0 + (double)site->between[d]);
        trace += (double)site->scatter[d * site->n + d];
    }
    s.offset = sqrt(square);
    s.expected = sqrt(site->n * (double)site->people) / (double)(site->people + 1);
    s.growth = site->weight > 0 ? trace / unit / unit / (double)site->weight / site->n : 0.0;
    return s;
}

/* The covariance within a person, [n][n], lower triangle. */
static void within_of(const struct iso_site *site, double *within)
{
    const double a = share_of(site);
    const double scale = site->weight > 0 ? a / unit / unit / (double)site->weight : 0.0;
    for (int r = 0; r < site->n; r++) {
        for (int c = 0; c <= r; c++) {
            within[r * site->n + c] = (r == c ? 1.0 - a : 0.0) +
                                      scale * (double)site->scatter[r * site->n + c] +
                                      offset_at(site, r) * offset_at(site, c);
        }
    }
}

/* Column k of the result is the direction of the k-th largest variance between people, of variance
 * 1 within a person; value[k] is that variance. The sign of a direction makes its largest number
 * positive, so that it does not depend on the library. */
static int directions_of(const struct iso_site *site, double *directions, double *value)
{
    const size_t n = (size_t)site->n;
    double *within = calloc(n * n, sizeof *within);
    if (!within) {
        return -ENOMEM;
    }
    within_of(site, within);
    memset(directions, 0, n * n * sizeof *directions);
    for (size_t d = 0; d < n; d++) {
        directions[d * n + d] = (double)site->between[d];
    }
    const lapack_int failed = LAPACKE_dsygv(LAPACK_ROW_MAJOR, 1, 'V', 'L', site->n, directions,
                                            site->n, within, site->n, value);
    iso_wipe_free(within);
    if (failed == LAPACK_WORK_MEMORY_ERROR || failed == LAPACK_TRANSPOSE_MEMORY_ERROR) {
        return -ENOMEM;
    }
    return failed ? -EDOM : 0;
}

static double sign_of(const double *directions, int n, int k)
{
    double largest = 0.0;
    for (int d = 0; d < n; d++) {
        const double x = directions[d * n + k];
        largest = fabs(x) > fabs(largest) ? x : largest;
    }
    return largest < 0.0 ? -1.0 : 1.0;
}

/* Column k of `turn` is direction k: column n - 1 - k of `directions`, because LAPACK sorts by
 * rising value. */
static void fill_turn(const double *directions, int n, float *turn)
{
    for (int k = 0; k < n; k++) {
        const double sign = sign_of(directions, n, n - 1 - k);
        for (int d = 0; d < n; d++) {
            turn[d * n + k] = (float)(sign * directions[d * n + n - 1 - k]);
        }
    }
}

static void turn_row(const float *turn, int n, const float *row, float *out)
{
    memset(out, 0, (size_t)n * sizeof *out);
    for (int d = 0; d < n; d++) {
        for (int k = 0; k < n; k++) {
            out[k] += row[d] * turn[d * n + k];
        }
    }
}

static void fill_metric(const struct iso_metric *metric, const double *value, const float *turn,
                        struct iso_metric *out)
{
    const int n = metric->n_dimensions;
    for (int k = 0; k < n; k++) {
        out->between[k] = (float)fmax(value[n - 1 - k], 0.0);
    }
    memcpy(out->curve_mm, metric->curve_mm, (size_t)metric->n_values * sizeof(float));
    turn_row(turn, n, metric->centre, out->centre);
    for (size_t v = 0; v < (size_t)metric->n_values; v++) {
        turn_row(turn, n, &metric->axis[v * (size_t)n], &out->axis[v * (size_t)n]);
    }
}

int iso_site_adapt(const struct iso_site *site, const struct iso_metric *metric,
                   struct iso_site_metric *out)
{
    const size_t n = (size_t)site->n;
    double value[ISO_METRIC_DIMENSIONS_MAX];
    float offset[ISO_METRIC_DIMENSIONS_MAX];
    *out = (struct iso_site_metric){.n = site->n, .people = (int)site->people};
    if (metric->n_dimensions != site->n ||
        memcmp(metric->between, site->between, n * sizeof *site->between) != 0) {
        return -EINVAL;
    }
    double *directions = calloc(n * n, sizeof *directions);
    out->turn = calloc(n * n, sizeof *out->turn);
    out->offset = calloc(n, sizeof *out->offset);
    out->steps = calloc(1, sizeof *out->steps);
    int error = directions && out->turn && out->offset && out->steps
                    ? iso_metric_new(metric, &out->metric)
                    : -ENOMEM;
    if (!error) {
        error = directions_of(site, directions, value);
    }
    if (!error) {
        fill_turn(directions, site->n, out->turn);
        fill_metric(metric, value, out->turn, out->metric);
        iso_metric_steps_fill(out->metric, out->steps);
        for (int d = 0; d < site->n; d++) {
            offset[d] = (float)offset_at(site, d);
        }
        turn_row(out->turn, site->n, offset, out->offset);
    } else {
        iso_site_metric_free(out);
    }
    iso_wipe_free(directions);
    return error;
}

void iso_site_metric_free(struct iso_site_metric *adapted)
{
    iso_metric_free(adapted->metric);
    iso_wipe_free(adapted->turn);
    iso_wipe_free(adapted->offset);
    free(adapted->steps);
    *adapted = (struct iso_site_metric){.n = 0};
}

void iso_site_turn(const struct iso_site_metric *adapted, const struct iso_metric_vector *one,
                   struct iso_metric_vector *out)
{
    *out = (struct iso_metric_vector){.n = 1};
    turn_row(adapted->turn, adapted->n, one->mean, out->mean);
    iso_metric_vector_judge(adapted->metric, adapted->steps, out);
}
