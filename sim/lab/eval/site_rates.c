#include "sim/lab/eval/site_rates.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "sim/base/random.h"

enum { RESAMPLES = 1000 };

/* A person's comparisons of one kind, and how many of them were decided wrongly. */
struct tally {
    size_t wrong, n;
};

/* A wrong decision: a non-mated comparison that reaches the score, or a mated one that does not. */
static void count_wrong(const struct sim_score *scores, size_t n, double at, bool mated,
                        struct tally *tally)
{
    for (size_t i = 0; i < n; i++) {
        tally[scores[i].person].n++;
        tally[scores[i].person].wrong += mated ? scores[i].score < at : scores[i].score >= at;
    }
}

static double rate_of(const struct tally *tally, const uint32_t *copies, uint32_t n_people)
{
    double wrong = 0.0, n = 0.0;
    for (uint32_t p = 0; p < n_people; p++) {
        wrong += (double)copies[p] * (double)tally[p].wrong;
        n += (double)copies[p] * (double)tally[p].n;
    }
    return n > 0.0 ? wrong / n : NAN;
}

static int compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Percentiles over resampled people. The interval is at least as wide as that of the counts of
 * `distinct` comparisons, because resampling takes an event that did not occur for impossible. */
static struct sim_interval interval_of(const struct tally *tally, uint32_t n_people, double rate,
                                       double distinct, uint32_t *copies, double *rates)
{
    struct sim_random random = sim_random_seeded(1, sim_random_hash("site rates"), 0);
    size_t n = 0;
    for (int r = 0; r < RESAMPLES; r++) {
        for (uint32_t p = 0; p < n_people; p++) {
            copies[p] = 0;
        }
        for (uint32_t p = 0; p < n_people; p++) {
            copies[sim_random_below(&random, n_people)]++;
        }
        const double one = rate_of(tally, copies, n_people);
        if (!isnan(one)) {
            rates[n++] = one;
        }
    }
    if (n == 0 || isnan(rate)) {
        return (struct sim_interval){0.0, 1.0};
    }
    qsort(rates, n, sizeof *rates, compare_doubles);
    const struct sim_interval counts = sim_rate_interval(
        (struct sim_rate){(size_t)lround(rate * distinct), (size_t)lround(distinct)});
    return (struct sim_interval){fmin(rates[n * 25 / 1000], counts.low),
                                 fmax(rates[n * 975 / 1000], counts.high)};
}

/* The equal error rate if `lost` more mated comparisons had failed at any threshold. */
static double eer_with(struct sim_det_point *points, size_t n, double mated, double lost)
{
    for (size_t i = 0; i < n; i++) {
        points[i].fnmr = (points[i].fnmr * mated + lost) / (mated + lost);
    }
    return sim_det_eer(points, n);
}

static int equal_error_rates(const struct sim_scores *scores, struct sim_site_split *out)
{
    struct sim_det_point *points = calloc(scores->n_mated + scores->n_non_mated + 1,
                                          sizeof *points);
    if (!points) {
        return -ENOMEM;
    }
    const size_t n = sim_det_points(scores, NULL, points);
    const double refused = sim_rate_value(out->refused), mated = (double)scores->n_mated;
    out->eer = sim_det_eer(points, n);
    out->eer_with_refused = eer_with(points, n, mated, mated * refused / (1.0 - refused));
    free(points);
    return 0;
}

int sim_site_rates(struct sim_scores *scores, uint32_t n_people, struct sim_site_split *out)
{
    uint32_t *copies = calloc(n_people, sizeof *copies);
    double *rates = calloc(RESAMPLES, sizeof *rates);
    const double searches = (double)(out->refused.trials - out->refused.events);
    int error = copies && rates ? 0 : -ENOMEM;
    for (int i = 0; i < SIM_SITE_SCORES && !error; i++) {
        struct sim_site_rate *at = &out->at[i];
        struct tally *mated = calloc(n_people, sizeof *mated);
        struct tally *non_mated = calloc(n_people, sizeof *non_mated);
        error = mated && non_mated ? 0 : -ENOMEM;
        if (!error) {
            at->score = 2.0 + i;
            count_wrong(scores->mated, scores->n_mated, at->score, true, mated);
            count_wrong(scores->non_mated, scores->n_non_mated, at->score, false, non_mated);
            for (uint32_t p = 0; p < n_people; p++) {
                copies[p] = 1;
            }
            at->fnmr = rate_of(mated, copies, n_people);
            at->fmr = rate_of(non_mated, copies, n_people);
            at->fnmr_interval = interval_of(mated, n_people, at->fnmr, searches, copies, rates);
            at->fmr_interval = interval_of(non_mated, n_people, at->fmr, searches * (n_people - 1),
                                           copies, rates);
        }
        free(mated);
        free(non_mated);
    }
    free(copies);
    free(rates);
    if (!error) {
        sim_scores_sort(scores);
        error = equal_error_rates(scores, out);
    }
    return error;
}
