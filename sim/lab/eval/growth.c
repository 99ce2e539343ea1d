#include "sim/lab/eval/growth.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sim/base/spread.h"

struct growing {
    size_t n_enrolled; /* people with a template */
    size_t n_strangers, n_mated;
    double *stranger;   /* [n_strangers][n_enrolled] scores, each row rising */
    double *candidates; /* all of these scores together, rising */
    double *mate_score; /* [n_mated]; -INFINITY: lost */
    size_t *n_before;   /* [n_mated] number of other people with at least the mate's score */
};

double sim_growth_missed(size_t m, size_t k, size_t n)
{
    double chance = 1.0;
    for (size_t i = 0; i < k && chance > 0.0; i++) {
        chance *= n + i < m ? (double)(m - n - i) / (double)(m - i) : 0.0;
    }
    return chance;
}

/* The number of n rising scores that are at least the threshold. */
static size_t count_from(const double *score, size_t n, double threshold)
{
    size_t low = 0, high = n;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        if (score[middle] >= threshold) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    return n - low;
}

static double fpir_of(const struct growing *g, size_t n_people, double threshold)
{
    double sum = 0.0;
    for (size_t s = 0; s < g->n_strangers; s++) {
        const size_t k = count_from(&g->stranger[s * g->n_enrolled], g->n_enrolled, threshold);
        sum += 1.0 - sim_growth_missed(g->n_enrolled, k, n_people);
    }
    return sum / (double)g->n_strangers;
}

static double fnir_of(const struct growing *g, size_t n_people, double threshold)
{
    double found = 0.0;
    for (size_t i = 0; i < g->n_mated; i++) {
        if (g->mate_score[i] >= threshold && isfinite(g->mate_score[i])) {
            found += sim_growth_missed(g->n_enrolled - 1, g->n_before[i], n_people - 1);
        }
    }
    return 1.0 - found / (double)g->n_mated;
}

/* The lowest threshold, just above a stranger's score, whose FPIR is at most the target. */
static double threshold_for(const struct growing *g, size_t n_people, double target)
{
    size_t low = 0, high = g->n_strangers * g->n_enrolled - 1;
    while (low < high) {
        const size_t middle = (low + high) / 2;
        const double threshold = nextafter(g->candidates[middle], INFINITY);
        if (fpir_of(g, n_people, threshold) <= target + 1e-12) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    return nextafter(g->candidates[low], INFINITY);
}

static void growing_done(struct growing *g)
{
    free(g->stranger);
    free(g->candidates);
    free(g->mate_score);
    free(g->n_before);
}

static void collect(const struct sim_gallery *gallery, const struct sim_matches *m,
                    const struct sim_analysis *a, struct growing *g)
{
    size_t strangers = 0;
    for (size_t i = 0; i < m->n_probes; i++) {
        const double *score = m->score + i * m->n_people;
        if (a->kind[i] == SIM_PROBE_STRANGER) {
            double *row = &g->stranger[strangers++ * g->n_enrolled];
            for (size_t p = 0, n = 0; p < m->n_people; p++) {
                if (gallery->n_templates_of[p] > 0) {
                    row[n++] = score[p];
                }
            }
            sim_sort(row, g->n_enrolled);
        } else if (a->kind[i] == SIM_PROBE_MATED) {
            const struct sim_mated_search *search = &a->identification.searches[g->n_mated];
            g->mate_score[g->n_mated] = search->rank > 0 ? search->mate_score : -INFINITY;
            g->n_before[g->n_mated++] = search->rank > 0 ? search->rank - 1 : 0;
        }
    }
    const size_t n = g->n_strangers * g->n_enrolled;
    memcpy(g->candidates, g->stranger, n * sizeof *g->candidates);
    sim_sort(g->candidates, n);
}

static void add_point(const struct growing *g, size_t n_people, struct sim_growth *growth)
{
    const double own = threshold_for(g, n_people, growth->target_fpir);
    growth->points[growth->n++] = (struct sim_growth_point){
        .n_people = n_people,
        .fpir = fpir_of(g, n_people, growth->threshold),
        .fnir = fnir_of(g, n_people, growth->threshold),
        .fnir_at_fpir = fnir_of(g, n_people, own),
    };
}

static void grow(const struct growing *g, struct sim_growth *growth)
{
    static const size_t steps[] = {1, 2, 5};
    growth->threshold = threshold_for(g, g->n_enrolled, growth->target_fpir);
    for (size_t decade = 10; decade < g->n_enrolled; decade *= 10) {
        for (size_t k = 0; k < 3; k++) {
            const size_t n = steps[k] * decade;
            if (n < g->n_enrolled && growth->n + 1 < SIM_GROWTH_MAX) {
                add_point(g, n, growth);
            }
        }
    }
    add_point(g, g->n_enrolled, growth);
}

int sim_growth_of(const struct sim_gallery *gallery, const struct sim_matches *matches,
                  const struct sim_analysis *analysis, double target_fpir, struct sim_growth *out)
{
    const struct sim_identification *id = &analysis->identification;
    struct growing g = {.n_strangers = id->n_strangers};
    struct sim_growth growth = {.target_fpir = target_fpir};
    for (size_t p = 0; p < gallery->n_people; p++) {
        g.n_enrolled += gallery->n_templates_of[p] > 0;
    }
    if (g.n_enrolled == 0 || g.n_strangers == 0 || id->n_searches == 0) {
        *out = growth;
        return 0;
    }
    const size_t n = g.n_strangers * g.n_enrolled;
    g.stranger = calloc(n, sizeof *g.stranger);
    g.candidates = calloc(n, sizeof *g.candidates);
    g.mate_score = calloc(id->n_searches, sizeof *g.mate_score);
    g.n_before = calloc(id->n_searches, sizeof *g.n_before);
    const int error = g.stranger && g.candidates && g.mate_score && g.n_before ? 0 : -ENOMEM;
    if (!error) {
        collect(gallery, matches, analysis, &g);
        grow(&g, &growth);
        *out = growth;
    }
    growing_done(&g);
    return error;
}
