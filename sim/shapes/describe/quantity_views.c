/* The quantity "views" (quantity.h). */
#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "isotherm/signature.h"
#include "sim/shapes/describe/quantity.h"

/* Two views are at least 40 degrees apart, so that each shows another side. */
static const double apart_rad = 40.0 * M_PI / 180.0;

static int add_views(const struct iso_shape_view *view, int n, struct sim_arrays *arrays)
{
    double *direction = malloc(3 * (size_t)n * sizeof *direction);
    double *entropy = malloc((size_t)n * sizeof *entropy);
    double *divergence = malloc((size_t)n * sizeof *divergence);
    if (!direction || !entropy || !divergence) {
        free(direction);
        free(entropy);
        free(divergence);
        return -ENOMEM;
    }
    for (int i = 0; i < n; i++) {
        direction[3 * i] = view[i].direction.x;
        direction[3 * i + 1] = view[i].direction.y;
        direction[3 * i + 2] = view[i].direction.z;
        entropy[i] = view[i].entropy;
        divergence[i] = view[i].divergence;
    }
    const int error[3] = {sim_quantity_add(arrays, "view",
                                           "directions to the viewer, the best one first",
                                           direction, n, 3),
                          sim_quantity_add(arrays, "view_entropy",
                                           "viewpoint entropy of each, in bits", entropy, n, 0),
                          sim_quantity_add(arrays, "view_divergence",
                                           "viewpoint Kullback-Leibler divergence of each, in bits",
                                           divergence, n, 0)};
    return error[0] ? error[0] : error[1] ? error[1] : error[2];
}

int sim_quantity_views(const struct iso_shape *shape, const struct sim_quantity_options *options,
                       struct sim_arrays *arrays)
{
    struct iso_shape_view view[SIM_QUANTITY_VIEWS_MAX];
    const int wanted = options->views ? options->views : SIM_QUANTITY_VIEWS;
    int n = 0;
    if (shape->is_cloud) {
        return -ENOTSUP;
    }
    if (wanted < 1 || wanted > SIM_QUANTITY_VIEWS_MAX) {
        return -ERANGE;
    }
    const int error = iso_shape_views(shape->mesh, options->view_score, apart_rad, wanted, view,
                                      &n);
    return error ? error : add_views(view, n, arrays);
}
