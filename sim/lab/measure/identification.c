#include "sim/lab/measure/identification.h"

#include <math.h>
#include <stdlib.h>

size_t sim_rank(const double *scores, size_t n, size_t mate)
{
    size_t rank = 1;
    for (size_t i = 0; i < n; i++) {
        rank += i != mate && scores[i] >= scores[mate];
    }
    return rank;
}

struct sim_rate sim_rank_rate(const struct sim_mated_search *searches, size_t n, size_t rank)
{
    struct sim_rate rate = {0, n};
    for (size_t i = 0; i < n; i++) {
        rate.events += searches[i].rank > 0 && searches[i].rank <= rank;
    }
    return rate;
}

static int by_falling_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x < y) - (x > y);
}

struct sim_open_set_point sim_open_set_at_fpir(const struct sim_mated_search *searches, size_t n,
                                               double *top_score, size_t n_top, double fpir)
{
    qsort(top_score, n_top, sizeof *top_score, by_falling_value);
    const size_t allowed = (size_t)floor(fpir * (double)n_top + 1e-9);
    /* Just above the best score that must not pass. */
    const double threshold = allowed < n_top ? nextafter(top_score[allowed], INFINITY) : -INFINITY;
    struct sim_open_set_point point = {threshold, {0, n_top}, {0, n}};
    while (point.fpir.events < n_top && top_score[point.fpir.events] >= threshold) {
        point.fpir.events++;
    }
    for (size_t i = 0; i < n; i++) {
        point.fnir.events += searches[i].rank != 1 || searches[i].mate_score < threshold;
    }
    return point;
}
