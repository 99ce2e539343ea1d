#include "core/landmark/spread.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

/* Chooses the next vertex. distance[i] is the distance of vertex i from the nearest vertex chosen
 * so far; it is negative for vertices that may not be chosen. */
static uint32_t choose_farthest(const struct iso_head_model *model, double *distance)
{
    uint32_t best = 0;
    for (uint32_t i = 1; i < model->n_vertices; i++) {
        best = distance[i] > distance[best] ? i : best;
    }
    for (uint32_t i = 0; i < model->n_vertices; i++) {
        const double d = iso_norm(iso_sub(model->mean_mm[i], model->mean_mm[best]));
        distance[i] = fmin(distance[i], d);
    }
    distance[best] = -1.0;
    return best;
}

int iso_head_spread(const struct iso_head_model *model, int most, uint32_t *order, int *n)
{
    double *distance = calloc(model->n_vertices, sizeof *distance);
    if (!distance) {
        return -ENOMEM;
    }
    int available = 0;
    for (uint32_t i = 0; i < model->n_vertices; i++) {
        const bool face = (model->region[i] & ISO_HEAD_FACE) != 0;
        distance[i] = face ? INFINITY : -1.0;
        available += face;
    }
    *n = most < available ? most : available;
    for (int i = 0; i < *n; i++) {
        order[i] = choose_farthest(model, distance);
    }
    free(distance);
    return 0;
}
