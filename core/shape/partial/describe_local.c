#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/shape/describe/describe.h"
#include "core/shape/describe/heat_courses.h"
#include "core/shape/partial/local_heat.h"
#include "core/shape/partial/surface_points.h"
#include "isotherm/signature.h"

static const int32_t part_size[ISO_LOCAL_PARTS] = {ISO_LOCAL_COARSE, ISO_LOCAL_COARSE,
                                                   ISO_LOCAL_POINTS *ISO_LOCAL_TIMES};

bool iso_is_local_heat(const struct iso_feature_layout *layout)
{
    return layout->n_parts == ISO_LOCAL_PARTS &&
           memcmp(layout->part_size, part_size, sizeof part_size) == 0;
}

/* The vertex where most heat stays, which does not depend on the pose. */
static int hottest_vertex(const struct iso_shape *shape, double t, int32_t *out)
{
    double *heat = malloc((size_t)shape->mesh->n_vertices * sizeof *heat);
    const int error = heat ? iso_heat_signature(shape->pairs, 0, &t, 1, heat) : -ENOMEM;
    int32_t best = 0;
    for (int32_t v = 1; v < shape->mesh->n_vertices && !error; v++) {
        best = heat[v] > heat[best] ? v : best;
    }
    free(heat);
    *out = best;
    return error;
}

/* log(A K(x, x, t)) of some points. The kernel is at least 1 / A, for its first pair is 1 / A. */
static int log_heat(const struct iso_shape *shape, const double *t, const int32_t *vertex,
                    float *out)
{
    struct iso_heat_courses courses;
    double course[ISO_LOCAL_TIMES];
    const int error = iso_heat_courses_init(&courses, shape->pairs, ISO_HEAT_OWN, 0, t,
                                            ISO_LOCAL_TIMES);
    for (int32_t p = 0; p < ISO_LOCAL_POINTS && !error; p++) {
        iso_heat_courses_at(&courses, vertex[p], 1, course);
        for (int j = 0; j < ISO_LOCAL_TIMES; j++) {
            *out++ = (float)log(fmax(course[j] * shape->total_area, 1.0));
        }
    }
    iso_heat_courses_done(&courses);
    return error;
}

static int fill(const struct iso_shape *shape, int32_t *vertex, double *weight, double *boundary,
                float *out)
{
    double t[ISO_LOCAL_TIMES];
    int32_t first;
    for (int j = 0; j < ISO_LOCAL_TIMES; j++) {
        t[j] = shape->total_area * exp2(ISO_LOCAL_FIRST + j * ISO_LOCAL_STEP);
    }
    int error = hottest_vertex(shape, t[ISO_LOCAL_TIMES - 1], &first);
    if (!error) {
        error = iso_surface_points(shape, first, ISO_LOCAL_COARSE, vertex, weight);
    }
    if (!error) {
        error = iso_boundary_distance(shape, boundary);
    }
    for (int32_t p = 0; p < ISO_LOCAL_COARSE && !error; p++) {
        const double d = boundary[vertex[p]];
        out[p] = (float)weight[p];
        out[ISO_LOCAL_COARSE + p] = (float)fmin(d * d / shape->total_area, ISO_LOCAL_FAR);
    }
    if (!error) { /* the first ones are the same again */
        error = iso_surface_points(shape, first, ISO_LOCAL_POINTS, vertex, weight);
    }
    return error ? error : log_heat(shape, t, vertex, &out[2 * ISO_LOCAL_COARSE]);
}

int iso_describe_local_heat(const struct iso_shape *shape, const struct iso_describe_times *times,
                            struct iso_shape_description *out)
{
    (void)times; /* they have to be short, or a cut changes the heat */
    int32_t *vertex = calloc(ISO_LOCAL_POINTS, sizeof *vertex);
    double *weight = calloc(ISO_LOCAL_POINTS, sizeof *weight);
    double *boundary = calloc((size_t)shape->mesh->n_vertices, sizeof *boundary);
    int error = vertex && weight && boundary ? iso_describe_parts(out, ISO_LOCAL_PARTS, part_size)
                                             : -ENOMEM;
    if (!error) {
        error = fill(shape, vertex, weight, boundary, out->whole);
    }
    free(vertex);
    free(weight);
    free(boundary);
    return error;
}
