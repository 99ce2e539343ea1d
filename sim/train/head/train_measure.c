#include "sim/train/head/train_measure.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "sim/train/head/head_exposure.h"
#include "sim/train/head/head_region.h"
#include "sim/world/face/person.h"

static double clamp01(double t)
{
    return fmin(fmax(t, 0.0), 1.0);
}

static double segment_distance(struct iso_vec3 p, struct iso_vec3 a, struct iso_vec3 b)
{
    struct iso_vec3 ab = iso_sub(b, a);
    const double squared = iso_dot(ab, ab);
    const double t = squared > 0.0 ? clamp01(iso_dot(iso_sub(p, a), ab) / squared) : 0.0;
    return iso_norm(iso_sub(p, iso_madd(a, t, ab)));
}

static double triangle_distance(struct iso_vec3 p, const struct iso_vec3 corner[3])
{
    struct iso_vec3 n = iso_cross(iso_sub(corner[1], corner[0]), iso_sub(corner[2], corner[0]));
    double nearest = INFINITY;
    int n_inside = 0;
    for (int k = 0; k < 3; k++) {
        struct iso_vec3 a = corner[k], b = corner[(k + 1) % 3];
        nearest = fmin(nearest, segment_distance(p, a, b));
        n_inside += iso_dot(iso_cross(iso_sub(b, a), iso_sub(p, a)), n) >= 0.0;
    }
    const double length = iso_norm(n);
    if (n_inside == 3 && length > 0.0) {
        nearest = fabs(iso_dot(iso_sub(p, corner[0]), n)) / length;
    }
    return nearest;
}

static double surface_distance(const struct sim_head_surface *surface, struct iso_vec3 p)
{
    double nearest = INFINITY;
    for (uint32_t t = 0; t < surface->n_triangles; t++) {
        struct iso_vec3 corner[3];
        for (int k = 0; k < 3; k++) {
            corner[k] = surface->mean_mm[surface->triangles[t][k]];
        }
        const double left = fmin(fmin(corner[0].x, corner[1].x), corner[2].x);
        const double right = fmax(fmax(corner[0].x, corner[1].x), corner[2].x);
        if (p.x > left - nearest && p.x < right + nearest) {
            nearest = fmin(nearest, triangle_distance(p, corner));
        }
    }
    return nearest;
}

static int compare_double(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

int sim_surface_distances(const struct sim_head_surface *fine, const double *exposure,
                          const struct sim_head_surface *coarse, struct sim_distances *out)
{
    double *distance_mm = calloc(fine->n_vertices, sizeof *distance_mm), sum = 0.0;
    if (!distance_mm) {
        return -ENOMEM;
    }
    uint32_t n = 0;
    for (uint32_t i = 0; i < fine->n_vertices; i++) {
        if (sim_head_in_face(fine, i) && sim_head_is_exposed(exposure[i])) {
            distance_mm[n] = surface_distance(coarse, fine->mean_mm[i]);
            sum += distance_mm[n++];
        }
    }
    qsort(distance_mm, n, sizeof *distance_mm, compare_double);
    *out = n == 0 ? (struct sim_distances){0.0, 0.0, 0.0}
                  : (struct sim_distances){sum / n, distance_mm[n * 95 / 100], distance_mm[n - 1]};
    free(distance_mm);
    return 0;
}

/* field += factor * other */
static void add_field(float *field, double factor, const float *other, size_t n_values)
{
    const float f = (float)factor;
    for (size_t i = 0; i < n_values; i++) {
        field[i] += f * other[i];
    }
}

static double weighted_product(const float *a, const float *b, const double *weight,
                               uint32_t n_vertices)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < n_vertices; i++, a += 3, b += 3) {
        sum += weight[i] * (double)(a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
    }
    return sum;
}

int sim_unseen_people(const float *fields_mm, uint32_t n_vertices, const double *weight,
                      const float *components_mm, const double *variance, uint32_t n_components,
                      uint64_t seed, struct sim_rms *out)
{
    enum { PEOPLE = 200 };
    const size_t n_values = 3 * (size_t)n_vertices;
    float *shape = malloc(n_values * sizeof *shape);
    if (!shape) {
        return -ENOMEM;
    }
    double before = 0.0, after = 0.0, total_weight = 0.0;
    for (uint32_t i = 0; i < n_vertices; i++) {
        total_weight += weight[i];
    }
    for (uint32_t person = 0; person < PEOPLE; person++) {
        struct sim_person p = sim_person_draw(SIM_POPULATION_TEST, seed, person, 1.0);
        for (size_t i = 0; i < n_values; i++) {
            shape[i] = 0.0f;
        }
        for (uint32_t m = 0; m < SIM_IDENTITY_MODES; m++) {
            add_field(shape, p.identity[m], fields_mm + m * n_values, n_values);
        }
        before += weighted_product(shape, shape, weight, n_vertices);
        for (uint32_t k = 0; k < n_components; k++) {
            const float *component = components_mm + k * n_values;
            const double amount = weighted_product(shape, component, weight, n_vertices) /
                                  variance[k];
            add_field(shape, -amount, component, n_values);
        }
        after += weighted_product(shape, shape, weight, n_vertices);
    }
    free(shape);
    *out = (struct sim_rms){sqrt(before / (PEOPLE * total_weight)),
                            sqrt(after / (PEOPLE * total_weight))};
    return 0;
}
