/* The choice of lambda by leave-one-out (collaborative.h). */
#include <errno.h>
#include <stdbool.h>
#include <stdlib.h>

#include "core/shape/classify/collaborative.h"

/* Penalties that are tried, for features of length 1. The first one is used if no class has two
 * shapes. */
static const double lambdas[] = {2.0, 8.0, 0.5, 0.1};
enum { LAMBDAS = sizeof lambdas / sizeof *lambdas };

/* The working memory. */
struct trial {
    int32_t sample[ISO_COLLABORATIVE_SAMPLE_MAX], n_sample; /* shapes that are left out in turn */
    double *score;                                          /* [n_classes] */
    double *distance;                                       /* [n] */
    struct iso_code_work work;
    struct iso_code code;
};

/* How many shapes of a class are taken, and how many of its shapes were met. */
struct quota {
    int32_t shapes, taken, met, found;
};

/* Takes one shape of every class in turn that has two shapes or more, until the sample is full or
 * no shape is left. */
static void divide_sample(struct quota *quota, int32_t n_classes)
{
    int32_t all = 0;
    for (bool more = true; more;) {
        more = false;
        for (int32_t c = 0; c < n_classes && all < ISO_COLLABORATIVE_SAMPLE_MAX; c++) {
            if (quota[c].shapes > 1 && quota[c].taken < quota[c].shapes) {
                quota[c].taken++;
                all++;
                more = true;
            }
        }
    }
}

/* Which shape of its class comes next: the middle one of each of `taken` equal stretches. */
static int64_t next_place(const struct quota *quota)
{
    return (int64_t)(2 * quota->found + 1) * quota->shapes / (2 * (int64_t)quota->taken);
}

int iso_collaborative_sample(const struct iso_training_set *gallery,
                             int32_t sample[ISO_COLLABORATIVE_SAMPLE_MAX], int32_t *n)
{
    struct quota *quota = calloc((size_t)gallery->n_classes, sizeof *quota);
    if (!quota) {
        return -ENOMEM;
    }
    int32_t found = 0;
    for (int32_t i = 0; i < gallery->n; i++) {
        quota[gallery->label[i]].shapes++;
    }
    divide_sample(quota, gallery->n_classes);
    for (int32_t i = 0; i < gallery->n; i++) {
        struct quota *own = &quota[gallery->label[i]];
        if (own->found < own->taken && own->met == next_place(own)) {
            sample[found++] = i;
            own->found++;
        }
        own->met++;
    }
    free(quota);
    *n = found;
    return 0;
}

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
    double sum = 0.0;
    for (int32_t s = 0; s < trial->n_sample; s++) {
        const int32_t left = trial->sample[s];
        sum += leave_out(m, left, company_of(&m->gallery, left), trial);
    }
    return trial->n_sample > 0 ? sum / trial->n_sample : 0.0;
}

int iso_collaborative_choose(struct iso_collaborative *m, double *quality)
{
    struct trial trial = {.score = calloc((size_t)m->gallery.n_classes, sizeof(double)),
                          .distance = calloc((size_t)m->gallery.n, sizeof(double))};
    int error = trial.score && trial.distance ? 0 : -ENOMEM;
    if (!error) {
        error = iso_collaborative_sample(&m->gallery, trial.sample, &trial.n_sample);
    }
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
