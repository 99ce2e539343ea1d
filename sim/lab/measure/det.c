#include "sim/lab/measure/det.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "sim/base/random.h"

static int by_score(const void *a, const void *b)
{
    const double x = ((const struct sim_score *)a)->score, y = ((const struct sim_score *)b)->score;
    return (x > y) - (x < y);
}

void sim_scores_sort(struct sim_scores *scores)
{
    qsort(scores->mated, scores->n_mated, sizeof *scores->mated, by_score);
    qsort(scores->non_mated, scores->n_non_mated, sizeof *scores->non_mated, by_score);
}

static uint64_t copies_of(const struct sim_score *score, const uint32_t *copies)
{
    return copies ? copies[score->person] : 1;
}

static uint64_t total(const struct sim_score *scores, size_t n, const uint32_t *copies)
{
    uint64_t sum = 0;
    for (size_t i = 0; i < n; i++) {
        sum += copies_of(&scores[i], copies);
    }
    return sum;
}

/* Sums the weights of the scores equal to `score` from *i on, and moves *i behind them. One that is
 * NaN counts with them, so that the caller comes to an end. */
static uint64_t take(const struct sim_score *scores, size_t n, size_t *i, double score,
                     const uint32_t *copies)
{
    uint64_t sum = 0;
    for (; *i < n && !(scores[*i].score > score); (*i)++) {
        sum += copies_of(&scores[*i], copies);
    }
    return sum;
}

size_t sim_det_points(const struct sim_scores *s, const uint32_t *copies,
                      struct sim_det_point *points)
{
    const uint64_t mated = total(s->mated, s->n_mated, copies);
    const uint64_t non_mated = total(s->non_mated, s->n_non_mated, copies);
    if (mated == 0 || non_mated == 0) {
        return 0;
    }
    uint64_t mated_below = 0, non_mated_below = 0;
    size_t n = 0, i = 0, j = 0;
    while (i < s->n_mated || j < s->n_non_mated) {
        const double threshold = fmin(i < s->n_mated ? s->mated[i].score : INFINITY,
                                      j < s->n_non_mated ? s->non_mated[j].score : INFINITY);
        points[n++] = (struct sim_det_point){
            .threshold = threshold,
            .fmr = (double)(non_mated - non_mated_below) / (double)non_mated,
            .fnmr = (double)mated_below / (double)mated,
        };
        mated_below += take(s->mated, s->n_mated, &i, threshold, copies);
        non_mated_below += take(s->non_mated, s->n_non_mated, &j, threshold, copies);
    }
    points[n++] = (struct sim_det_point){.threshold = INFINITY, .fmr = 0.0, .fnmr = 1.0};
    return n;
}

double sim_det_eer(const struct sim_det_point *points, size_t n)
{
    for (size_t i = 1; i < n; i++) {
        /* FNMR - FMR rises from -1 at the first point to 1 at the last. */
        const double before = points[i - 1].fnmr - points[i - 1].fmr;
        const double after = points[i].fnmr - points[i].fmr;
        if (after >= 0.0) {
            const double share = before < after ? -before / (after - before) : 0.0;
            return points[i - 1].fmr + share * (points[i].fmr - points[i - 1].fmr);
        }
    }
    return NAN;
}

struct sim_det_point sim_det_at_fmr(const struct sim_det_point *points, size_t n, double fmr)
{
    /* FMR falls with the index. Bisection finds the first point with a sufficiently low FMR. */
    size_t low = 0, high = n - 1;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        if (points[middle].fmr <= fmr * (1.0 + 1e-12)) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    return points[low];
}

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static struct sim_interval percentiles(double *values, size_t n)
{
    qsort(values, n, sizeof *values, by_value);
    const double last = (double)(n - 1);
    return (struct sim_interval){values[(size_t)floor(0.025 * last)],
                                 values[(size_t)ceil(0.975 * last)]};
}

int sim_det_bootstrap(const struct sim_scores *scores, uint32_t n_people, const double *fmr,
                      size_t n_fmr, struct sim_interval *eer, struct sim_interval *fnmr)
{
    enum { RESAMPLES = 400 };
    if (scores->n_mated == 0 || scores->n_non_mated == 0 || n_people < 2) {
        return -EINVAL;
    }
    /* Row 0 of `drawn` is the EER, row 1 + k the FNMR at fmr[k]. */
    double *drawn = calloc((1 + n_fmr) * RESAMPLES, sizeof *drawn);
    uint32_t *copies = calloc(n_people, sizeof *copies);
    struct sim_det_point *points = calloc(scores->n_mated + scores->n_non_mated + 1,
                                          sizeof *points);
    const int error = drawn && copies && points ? 0 : -ENOMEM;
    struct sim_random random = sim_random_seeded(1, sim_random_hash("bootstrap"), 0);
    for (size_t i = 0; !error && i < RESAMPLES;) {
        for (uint32_t p = 0; p < n_people; p++) {
            copies[p] = 0;
        }
        for (uint32_t p = 0; p < n_people; p++) {
            copies[sim_random_below(&random, n_people)]++;
        }
        const size_t n = sim_det_points(scores, copies, points);
        if (n == 0) {
            continue; /* no drawn person has comparisons of one of the kinds, so draw again */
        }
        drawn[i] = sim_det_eer(points, n);
        for (size_t k = 0; k < n_fmr; k++) {
            drawn[(1 + k) * RESAMPLES + i] = sim_det_at_fmr(points, n, fmr[k]).fnmr;
        }
        i++;
    }
    if (!error) {
        *eer = percentiles(drawn, RESAMPLES);
        for (size_t k = 0; k < n_fmr; k++) {
            fnmr[k] = percentiles(drawn + (1 + k) * RESAMPLES, RESAMPLES);
        }
    }
    free(drawn);
    free(copies);
    free(points);
    return error;
}
