#include "sim/lab/measure/detection_cost.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

static const struct {
    const char *level;
    double threshold, c_miss, c_false, p_mated;
} levels[SIM_DETECTION_COSTS] = {
    {"convenient", 2.0, 10.0, 1.0, 0.01},
    {"balanced", 3.0, 1.0, 1.0, 0.01},
    {"strict", 4.0, 1.0, 1.0, 0.001},
};

static double cost_at(const struct sim_det_point *point, double weight)
{
    return point->fnmr + weight * point->fmr;
}

/* Returns the point that decides in the same way as a threshold: the first one that is not below
 * it. n >= 1; the last point is at INFINITY. */
static const struct sim_det_point *point_at(const struct sim_det_point *points, size_t n,
                                            double threshold)
{
    size_t i = 0;
    while (i + 1 < n && points[i].threshold < threshold) {
        i++;
    }
    return &points[i];
}

static void weigh(const struct sim_det_point *points, size_t n, struct sim_detection_cost *out)
{
    out->actual = cost_at(point_at(points, n, out->threshold), out->weight);
    out->minimum = INFINITY;
    for (size_t i = 0; i < n; i++) {
        const double cost = cost_at(&points[i], out->weight);
        if (cost < out->minimum) {
            out->minimum = cost;
            out->best_at = points[i].threshold;
        }
    }
}

int sim_detection_costs_of(const struct sim_scores *scores,
                           struct sim_detection_cost out[SIM_DETECTION_COSTS])
{
    struct sim_det_point *points = calloc(scores->n_mated + scores->n_non_mated + 1,
                                          sizeof *points);
    if (!points) {
        return -ENOMEM;
    }
    const size_t n = sim_det_points(scores, NULL, points);
    for (int i = 0; i < SIM_DETECTION_COSTS; i++) {
        out[i] = (struct sim_detection_cost){
            .level = levels[i].level,
            .threshold = levels[i].threshold,
            .weight = levels[i].c_false * (1.0 - levels[i].p_mated) /
                      (levels[i].c_miss * levels[i].p_mated),
            .actual = NAN,
            .minimum = NAN,
            .best_at = NAN,
        };
        if (n > 0) {
            weigh(points, n, &out[i]);
        }
    }
    free(points);
    return 0;
}
