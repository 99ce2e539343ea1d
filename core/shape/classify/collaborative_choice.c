/* The choice of lambda by leave-one-out (collaborative.h). */
#include <errno.h>
#include <stdlib.h>

#include "core/shape/classify/collaborative.h"

/* Penalties that are tried, for features of length 1. The first one is used if no class has two
 * shapes. */
static const double lambdas[] = {2.0, 8.0, 0.5, 0.1};
enum { LAMBDAS = sizeof lambdas / sizeof *lambdas };

/* At most so many shapes are left out in turn, which bounds the time: every k-th of the training
 * set. */
enum { LEFT_OUT_MAX = 60 };

/* The working memory. */
struct trial {
    double *score;    /* [n_classes] */
    double *distance; /* [n] */
    struct iso_code_work work;
    struct iso_code code;
};

/* Shapes of the class of shape i besides it. */
static int32_t company_of(const struct iso_training_set *gallery, int32_t i)
{
    int32_t n = 0;
    for (int32_t j = 0; j < gallery->n; j++) {
        n += j != i && gallery->label[j] == gallery->label[i];
    }
    return n;
}

/* The share of a class of `company` other shapes among the first `company` of the ranking. Of equal
 * distances the first shape comes first. */
static double first_tier(const struct iso_training_set *gallery, int32_t left, int32_t company,
                         const double *distance)
{
    int32_t found = 0;
    for (int32_t i = 0; i < gallery->n; i++) {
        int32_t before = 0;
        if (i == left || gallery->label[i] != gallery->label[left]) {
            continue;
        }
        for (int32_t j = 0; j < gallery->n; j++) {
            const bool first = distance[j] < distance[i] || (distance[j] == distance[i] && j < i);
            before += j != left && first;
        }
        found += before < company;
    }
    return (double)found / company;
}

/* Leaves one shape out: 1 if the others tell its class, plus its first tier. */
static double leave_out(const struct iso_collaborative *m, int32_t left, int32_t company,
                        struct trial *trial)
{
    const struct iso_training_set *g = &m->gallery;
    int32_t told = 0;
    iso_code_find(m, &g->feature[(size_t)left * (size_t)g->layout.size], left, &trial->work,
                  &trial->code);
    iso_code_scores(m, &trial->code, trial->score);
    iso_code_distances(m, &trial->code, trial->distance);
    for (int32_t c = 1; c < g->n_classes; c++) {
        told = trial->score[c] > trial->score[told] ? c : told;
    }
    return (told == g->label[left]) + first_tier(g, left, company, trial->distance);
}

static double try_lambda(const struct iso_collaborative *m, struct trial *trial)
{
    const struct iso_training_set *g = &m->gallery;
    const int32_t step = (g->n + LEFT_OUT_MAX - 1) / LEFT_OUT_MAX;
    double sum = 0.0;
    int32_t n = 0;
    for (int32_t i = 0; i < g->n; i += step) {
        const int32_t company = company_of(g, i);
        if (company > 0) {
            sum += leave_out(m, i, company, trial);
            n++;
        }
    }
    return n > 0 ? sum / n : 0.0;
}

int iso_collaborative_choose(struct iso_collaborative *m, double *quality)
{
    struct trial trial = {.score = calloc((size_t)m->gallery.n_classes, sizeof(double)),
                          .distance = calloc((size_t)m->gallery.n, sizeof(double))};
    int error = trial.score && trial.distance ? 0 : -ENOMEM;
    if (!error) {
        error = iso_code_init(m, &trial.work, &trial.code);
    }
    double best = lambdas[0], most = 0.0;
    m->choosing = true;
    for (int l = 0; l < LAMBDAS && !error; l++) {
        m->lambda = lambdas[l];
        const double found = try_lambda(m, &trial);
        if (found > most + ISO_COLLABORATIVE_GAIN) {
            most = found;
            best = lambdas[l];
        }
    }
    m->choosing = false;
    if (!error) {
        m->lambda = best;
        *quality = most;
        iso_code_done(&trial.work);
    }
    free(trial.score);
    free(trial.distance);
    return error;
}
