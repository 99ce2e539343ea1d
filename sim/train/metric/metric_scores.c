#include "sim/train/metric/metric_scores.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/match/rerank.h"
#include "sim/lab/match/parallel.h"
#include "sim/train/metric/metric_learn.h"
#include "sim/train/metric/rerank_learn.h"

enum {
    OTHERS_FITTED = 60000
}; /* greatest number of comparisons of strangers for which a misfit is computed */

/* A comparison of two templates of people held out. */
struct pair {
    const struct iso_template *enrolled, *probe;
    double score; /* by the metric: the log likelihood ratio, later calibrated */
    double fit;   /* -ln(rms / 1 mm) of the upper faces' misfit; NaN: unknown */
};

struct pairs {
    size_t n, capacity;
    struct pair *list;
};

/* Comparisons of the people held out: the first template of each person with the later templates
 * of all people. */
struct held_out {
    struct pairs mated, other;
};

static void free_held_out(struct held_out *held)
{
    free(held->mated.list);
    free(held->other.list);
}

static int new_pairs(struct pairs *pairs, size_t capacity)
{
    pairs->capacity = capacity;
    pairs->list = calloc(capacity + 1, sizeof *pairs->list);
    return pairs->list ? 0 : -ENOMEM;
}

static void add_pair(struct pairs *pairs, struct pair pair)
{
    if (pairs->n < pairs->capacity) {
        pairs->list[pairs->n++] = pair;
    }
}

/* The metric's vector of a template of a person held out. */
struct seen {
    struct iso_metric_vector vector;
    const struct iso_template *tmpl;
    size_t person;
};

static void compare_seen(const struct iso_metric *metric, const struct seen *seen, size_t n,
                         struct held_out *out)
{
    for (size_t g = 0; g < n; g++) {
        if (g > 0 && seen[g - 1].person == seen[g].person) {
            continue; /* not the person's first template */
        }
        for (size_t p = 1; p < n; p++) {
            if (seen[p - 1].person != seen[p].person) {
                continue; /* the first template of its own person */
            }
            const bool mated = seen[g].person == seen[p].person;
            add_pair(mated ? &out->mated : &out->other,
                     (struct pair){
                         .enrolled = seen[g].tmpl,
                         .probe = seen[p].tmpl,
                         .score = iso_metric_score(metric, &seen[g].vector, &seen[p].vector),
                         .fit = NAN,
                     });
        }
    }
}

static int compare_held_out(const struct sim_metric_templates *t, const struct iso_metric *metric,
                            struct held_out *out)
{
    size_t n = 0;
    struct seen *seen = calloc(t->n + 1, sizeof *seen);
    if (!seen) {
        return -ENOMEM;
    }
    for (size_t s = 0; s < t->n; s++) {
        if (sim_metric_is_held_out(t->person[s]) &&
            iso_metric_project(metric, &t->tmpl[s], &seen[n].vector) == 0) {
            seen[n].tmpl = &t->tmpl[s];
            seen[n++].person = t->person[s];
        }
    }
    int error = new_pairs(&out->mated, n);
    if (!error) {
        error = new_pairs(&out->other, n * (n / 2));
    }
    if (!error) {
        compare_seen(metric, seen, n, out);
    }
    explicit_bzero(seen, (t->n + 1) * sizeof *seen);
    free(seen);
    return error;
}

static int calibrate_scores(struct held_out *held, struct iso_metric *metric)
{
    const struct pairs *other = &held->other;
    double *ratio = calloc(other->n + 1, sizeof *ratio);
    float gain = 0.0f, bias = 0.0f;
    int error = ratio ? 0 : -ENOMEM;
    for (size_t i = 0; !error && i < other->n; i++) {
        ratio[i] = other->list[i].score;
    }
    if (!error) {
        error = sim_metric_calibrate(ratio, other->n, &gain, &bias);
    }
    free(ratio);
    if (error) {
        return error;
    }
    metric->gain = gain;
    metric->bias = bias;
    struct pairs *const both[] = {&held->mated, &held->other};
    for (int k = 0; k < 2; k++) {
        for (size_t i = 0; i < both[k]->n; i++) {
            both[k]->list[i].score = (double)gain * both[k]->list[i].score + (double)bias;
        }
    }
    return 0;
}

/* Pairs whose upper faces are fitted, and the working memory of each thread. */
struct fitting {
    struct pair *list;
    struct iso_rerank_workspace *work;
};

static int fit_upper_faces(void *context, int worker, size_t number)
{
    const struct fitting *fitting = context;
    struct pair *pair = &fitting->list[number];
    const struct iso_upper_face *enrolled = &pair->enrolled->upper;
    double rms_mm;
    if (iso_rerank_misfit(&fitting->work[worker], &pair->probe->upper, &enrolled, 1, 0, &rms_mm) ==
        0) {
        pair->fit = -log(rms_mm);
    }
    return 0;
}

/* Computes the misfits of the pairs of the same person and of the pairs of different people. */
static int fit_pairs(int threads, const struct pairs *mated, const struct pairs *other)
{
    struct iso_rerank_workspace *work = calloc((size_t)threads, sizeof *work);
    if (!work) {
        return -ENOMEM;
    }
    struct fitting own = {mated->list, work}, others = {other->list, work};
    int error = sim_parallel(threads, "fitting faces of one person", mated->n, fit_upper_faces,
                             &own);
    if (!error) {
        error = sim_parallel(threads, "fitting faces of two people", other->n, fit_upper_faces,
                             &others);
    }
    free(work);
    return error;
}

/* Keeps an even selection of the comparisons, because a misfit takes a thousand times longer than a
 * score. */
static void thin_pairs(struct pairs *pairs, size_t one_in)
{
    size_t n = 0;
    for (size_t i = 0; i < pairs->n; i += one_in) {
        pairs->list[n++] = pairs->list[i];
    }
    pairs->n = n;
}

static int learn_rerank(int threads, struct held_out *held, struct iso_metric *metric)
{
    struct pairs *other = &held->other;
    thin_pairs(other, other->n / OTHERS_FITTED + 1);
    int error = fit_pairs(threads, &held->mated, other);
    double *score = calloc(other->n + 1, sizeof *score), *fit = calloc(other->n + 1, sizeof *fit);
    error = score && fit ? error : -ENOMEM;
    for (size_t i = 0; !error && i < other->n; i++) {
        score[i] = other->list[i].score;
        fit[i] = other->list[i].fit;
    }
    const struct sim_rerank_pairs strangers = {other->n, score, fit};
    if (!error) {
        error = sim_rerank_learn(&strangers, &metric->rerank);
    }
    free(score);
    free(fit);
    return error;
}

/* The people held out are drawn from the whole population and are similar only by chance, but
 * relatives may come to one door. All scores are lowered by this value, log10 of ten. A score
 * then promises its rate for the most similar tenth of all strangers. Without this step it would
 * promise that rate only for the mean over all strangers. */
static const float caution = 1.0f;

static void be_cautious(struct iso_metric *metric)
{
    metric->bias -= caution;
    metric->rerank.bias += caution * (metric->rerank.metric -
                                      1.0f); /* the metric's score in the sum is lowered, too */
}

/* The share of comparisons that reach the threshold. With `weights` (or NULL) the score of a pair
 * with a known misfit is the fused one; otherwise it is the metric's. */
static double share_at_least(const struct pairs *pairs, const struct iso_rerank_weights *weights,
                             double threshold)
{
    size_t above = 0;
    for (size_t i = 0; i < pairs->n; i++) {
        const struct pair *p = &pairs->list[i];
        const bool fused = weights && !isnan(p->fit);
        above += (fused ? iso_rerank_fuse(weights, p->score, exp(-p->fit)) : p->score) >= threshold;
    }
    return (double)above / fmax((double)pairs->n, 1.0);
}

static void report_rates(const struct held_out *held, const struct iso_rerank_weights *weights,
                         struct sim_train_scores *out)
{
    out->n_mated = held->mated.n;
    out->n_others = held->other.n;
    for (int i = 0; i < 3; i++) {
        const double score = 2.0 + i + (double)caution; /* be_cautious() lowers it to 2 + i */
        out->fmr_at[i] = share_at_least(&held->other, weights, score);
        out->false_non_match_at[i] = 1.0 - share_at_least(&held->mated, weights, score);
    }
}

int sim_metric_learn_scores(const struct sim_metric_templates *t, int threads,
                            struct iso_metric *metric, struct sim_train_metric_report *report)
{
    struct held_out held = {{0}, {0}};
    metric->gain = 1.0f;
    metric->bias = 0.0f;
    int error = compare_held_out(t, metric, &held);
    if (!error) {
        error = calibrate_scores(&held, metric);
    }
    if (!error) {
        report_rates(&held, NULL, &report->metric);
        error = learn_rerank(threads, &held, metric);
    }
    if (!error) {
        report_rates(&held, &metric->rerank, &report->fused);
        be_cautious(metric);
    }
    free_held_out(&held);
    return error;
}
