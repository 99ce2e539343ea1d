#include "sim/shapes/match/truth.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "isotherm/correspondence.h"
#include "sim/world/face/npy.h"

enum { POINTS = 250 };

static const double radii[3] = {0.05, 0.1, 0.25};

int sim_rest_read(const char *mesh, int32_t n_vertices, float **rest, struct iso_fault *fault)
{
    char path[PATH_MAX];
    const char *slash = strrchr(mesh, '/'), *base = slash ? slash + 1 : mesh;
    const char *dot = strrchr(base, '.');
    const int n = snprintf(path, sizeof path, "%.*srest/%.*s.npy", (int)(base - mesh), mesh,
                           (int)(dot ? dot - base : (long)strlen(base)), base);
    struct sim_npy_shape shape = {0};
    struct stat status;
    float *values = NULL;
    *rest = NULL;
    if (n < 0 || n >= (int)sizeof path || stat(path, &status) != 0) {
        return 0;
    }
    const int error = sim_npy_read_floats(path, &shape, &values, fault);
    if (error) {
        return error;
    }
    if (shape.n_dimensions != 2 || shape.size[0] != (uint32_t)n_vertices || shape.size[1] != 3) {
        free(values);
        return 0;
    }
    *rest = values;
    return 0;
}

static int32_t nearest(const float *rest, int32_t n, const double at[3])
{
    int32_t best = 0;
    double least = INFINITY;
    for (int32_t v = 0; v < n; v++) {
        double square = 0.0;
        for (int k = 0; k < 3; k++) {
            const double d = (double)rest[3 * v + k] - at[k];
            square += d * d;
        }
        if (square < least) {
            least = square;
            best = v;
        }
    }
    return best;
}

int sim_rest_measure(const struct iso_shape *from, const float *from_rest,
                     const struct iso_shape *to, const float *to_rest, const int32_t *point,
                     bool mirrored, struct sim_match_error *out)
{
    const int32_t n_from = from->mesh->n_vertices, n_to = to->mesh->n_vertices;
    const int32_t wanted = n_to < POINTS ? n_to : POINTS;
    const double unit = sqrt(from->total_area);
    struct sim_match_error sum = {.n = wanted};
    struct iso_geodesic *geodesic = NULL;
    double *distance = calloc((size_t)n_from, sizeof *distance);
    int error = distance ? iso_geodesic_new(from, &geodesic) : -ENOMEM;
    for (int32_t i = 0; i < wanted && !error; i++) {
        const int32_t v = (int32_t)((int64_t)i * n_to / wanted);
        const double x = (double)to_rest[3 * v];
        const double at[3] = {mirrored ? -x : x, (double)to_rest[3 * v + 1],
                              (double)to_rest[3 * v + 2]};
        error = iso_geodesic_distance(geodesic, nearest(from_rest, n_from, at), distance);
        const double off = distance[point[v]] / unit;
        sum.mean += off / wanted;
        for (int r = 0; r < 3; r++) {
            sum.within[r] += (off <= radii[r] ? 1.0 : 0.0) / wanted;
        }
    }
    iso_geodesic_free(geodesic);
    free(distance);
    if (!error) {
        *out = sum;
    }
    return error;
}
