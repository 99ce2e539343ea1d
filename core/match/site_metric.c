/* The metric that is adapted to a site (site.h). */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/lapack.h"
#include "core/base/wipe.h"
#include "core/match/site_state.h"

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
    iso__site_within(site, within);
    memset(directions, 0, n * n * sizeof *directions);
    for (size_t d = 0; d < n; d++) {
        directions[d * n + d] = (double)site->between[d];
    }
    const lapack_int result = LAPACKE_dsygv(LAPACK_ROW_MAJOR, 1, 'V', 'L', site->n, directions,
                                            site->n, within, site->n, value);
    iso_wipe_free(within);
    return iso_lapack_error(result);
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

static int by_number(const void *a, const void *b)
{
    const int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;
    return (x > y) - (x < y);
}

/* The person of this number; there is one. */
static size_t person_of(const struct iso_site *site, int64_t number)
{
    size_t p = 0;
    while (site->number[p] != number) {
        p++;
    }
    return p;
}

/* Fills in what each person has in the offset. */
static int fill_own(const struct iso_site *site, struct iso_site_metric *out)
{
    const size_t n = (size_t)site->n, people = site->people;
    float own[ISO_METRIC_DIMENSIONS_MAX];
    if (people > ISO_SITE_OWN_MAX) {
        return 0;
    }
    out->number = calloc(people + 1, sizeof *out->number);
    out->own = calloc(people * n + 1, sizeof *out->own);
    if (!out->number || !out->own) {
        return -ENOMEM;
    }
    if (people > 0) {
        memcpy(out->number, site->number, people * sizeof *out->number);
        qsort(out->number, people, sizeof *out->number, by_number);
    }
    for (size_t p = 0; p < people; p++) {
        const size_t person = person_of(site, out->number[p]);
        for (int d = 0; d < site->n; d++) {
            own[d] = (float)iso__site_clipped(site, person, d);
        }
        turn_row(out->turn, site->n, own, &out->own[p * n]);
    }
    out->n_own = (int)people;
    explicit_bzero(own, sizeof own);
    return 0;
}

static int fill_adapted(const struct iso_site *site, const struct iso_metric *metric,
                        const double *directions, const double *value, struct iso_site_metric *out)
{
    float offset[ISO_METRIC_DIMENSIONS_MAX];
    fill_turn(directions, site->n, out->turn);
    fill_metric(metric, value, out->turn, out->metric);
    iso_metric_steps_fill(out->metric, out->steps);
    for (int d = 0; d < site->n; d++) {
        offset[d] = (float)site->offset[d];
    }
    turn_row(out->turn, site->n, offset, out->offset);
    explicit_bzero(offset, sizeof offset);
    return fill_own(site, out);
}

int iso_site_adapt(const struct iso_site *site, const struct iso_metric *metric,
                   struct iso_site_metric *out)
{
    const size_t n = (size_t)site->n;
    double value[ISO_METRIC_DIMENSIONS_MAX];
    *out = (struct iso_site_metric){.n = site->n, .people = (int)site->people};
    if (!site->has_directions || site->reviewed != site->people ||
        metric->n_dimensions != site->n ||
        memcmp(metric->between, site->between, n * sizeof *site->between) != 0) {
        *out = (struct iso_site_metric){.n = 0};
        return -EINVAL;
    }
    double *directions = calloc(n * n, sizeof *directions);
    out->turn = calloc(n * n, sizeof *out->turn);
    out->offset = calloc(n, sizeof *out->offset);
    out->steps = calloc(1, sizeof *out->steps);
    const bool room = directions && out->turn && out->offset && out->steps;
    int error = room ? iso_metric_new(metric, &out->metric) : -ENOMEM;
    if (!error) {
        error = directions_of(site, directions, value);
    }
    if (!error) {
        error = fill_adapted(site, metric, directions, value, out);
    }
    if (error) {
        iso_site_metric_free(out);
    }
    iso_wipe_free(directions);
    explicit_bzero(value, sizeof value);
    return error;
}

void iso_site_metric_free(struct iso_site_metric *adapted)
{
    iso_metric_free(adapted->metric);
    iso_wipe_free(adapted->turn);
    iso_wipe_free(adapted->offset);
    free(adapted->steps);
    iso_wipe_free(adapted->number);
    iso_wipe_free(adapted->own);
    *adapted = (struct iso_site_metric){.n = 0};
}

void iso_site_metric_forget(struct iso_site_metric *adapted, int64_t number)
{
    const size_t n = (size_t)adapted->n;
    int place = 0;
    while (place < adapted->n_own && adapted->number[place] != number) {
        place++;
    }
    if (place == adapted->n_own) {
        return;
    }
    const size_t behind = (size_t)(adapted->n_own - place - 1);
    float *own = &adapted->own[(size_t)place * n];
    memmove(own, own + n, behind * n * sizeof *own);
    memmove(&adapted->number[place], &adapted->number[place + 1], behind * sizeof *adapted->number);
    explicit_bzero(own + behind * n, n * sizeof *own);
    explicit_bzero(&adapted->number[place + (int)behind], sizeof *adapted->number);
    adapted->n_own--;
}

void iso_site_turn(const struct iso_site_metric *adapted, const struct iso_metric_vector *one,
                   struct iso_metric_vector *out)
{
    *out = (struct iso_metric_vector){.n = 1};
    turn_row(adapted->turn, adapted->n, one->mean, out->mean);
    iso_metric_vector_judge(adapted->metric, adapted->steps, out);
}
