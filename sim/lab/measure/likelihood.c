#include "sim/lab/measure/likelihood.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

double sim_log_likelihood_ratio(double score)
{
    const double u = score * log(10.0); /* p = exp(-u) */
    if (u <= 0.0) {
        return u - log(2.0);
    }
    if (u < 1e-3) { /* the formula below loses all digits here; this is its series */
        return log(0.5 + u / 6.0 + u * u / 24.0);
    }
    if (isinf(u)) {
        return u;
    }
    return u + log1p(-(1.0 + u) * exp(-u)) - 2.0 * log(u);
}

/* log2(1 + exp(x)), without overflow. */
static double softplus_bits(double x)
{
    return (fmax(x, 0.0) + log1p(exp(-fabs(x)))) / log(2.0);
}

double sim_cllr(const struct sim_scores *scores)
{
    double mated = 0.0, non_mated = 0.0;
    if (scores->n_mated == 0 || scores->n_non_mated == 0) {
        return NAN;
    }
    for (size_t i = 0; i < scores->n_mated; i++) {
        mated += softplus_bits(-sim_log_likelihood_ratio(scores->mated[i].score));
    }
    for (size_t i = 0; i < scores->n_non_mated; i++) {
        non_mated += softplus_bits(sim_log_likelihood_ratio(scores->non_mated[i].score));
    }
    return 0.5 * (mated / (double)scores->n_mated + non_mated / (double)scores->n_non_mated);
}

/* Neighbouring scores with one likelihood ratio. */
struct block {
    double mated, non_mated; /* counts */
};

/* Counts the comparisons with the lowest score that is left, and moves the places behind them. One
 * that is NaN counts with it, so that the place moves at every call. */
static struct block next_score(const struct sim_scores *s, size_t *i, size_t *j)
{
    const size_t first_i = *i, first_j = *j;
    const double score = fmin(*i < s->n_mated ? s->mated[*i].score : INFINITY,
                              *j < s->n_non_mated ? s->non_mated[*j].score : INFINITY);
    while (*i < s->n_mated && !(s->mated[*i].score > score)) {
        (*i)++;
    }
    while (*j < s->n_non_mated && !(s->non_mated[*j].score > score)) {
        (*j)++;
    }
    return (struct block){(double)(*i - first_i), (double)(*j - first_j)};
}

/* Whether the share of mated comparisons does not rise from one block to the next. */
static bool violates(struct block before, struct block after)
{
    return before.mated * after.non_mated >= after.mated * before.non_mated;
}

/* The cost of a block's comparisons. `odds` is the number of mated comparisons over that of
 * non-mated ones, in all blocks. */
static double cost_of(struct block b, double odds, double *non_mated)
{
    if (b.mated == 0.0 || b.non_mated == 0.0) {
        return 0.0;
    }
    const double ratio = b.mated / b.non_mated / odds;
    *non_mated += b.non_mated * log2(1.0 + ratio);
    return b.mated * log2(1.0 + 1.0 / ratio);
}

int sim_cllr_min(const struct sim_scores *scores, double *out)
{
    const double mated = (double)scores->n_mated, non_mated = (double)scores->n_non_mated;
    double mated_cost = 0.0, non_mated_cost = 0.0;
    *out = NAN;
    if (scores->n_mated == 0 || scores->n_non_mated == 0) {
        return 0;
    }
    struct block *blocks = calloc(scores->n_mated + scores->n_non_mated, sizeof *blocks);
    if (!blocks) {
        return -ENOMEM;
    }
    size_t n = 0, i = 0, j = 0;
    while (i < scores->n_mated || j < scores->n_non_mated) {
        blocks[n++] = next_score(scores, &i, &j);
        for (; n > 1 && violates(blocks[n - 2], blocks[n - 1]); n--) {
            blocks[n - 2].mated += blocks[n - 1].mated;
            blocks[n - 2].non_mated += blocks[n - 1].non_mated;
        }
    }
    for (size_t b = 0; b < n; b++) {
        mated_cost += cost_of(blocks[b], mated / non_mated, &non_mated_cost);
    }
    *out = 0.5 * (mated_cost / mated + non_mated_cost / non_mated);
    free(blocks);
    return 0;
}
