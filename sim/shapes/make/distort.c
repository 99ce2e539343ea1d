#include "sim/shapes/make/distort.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sim/base/noise3.h"

static const struct {
    const char *name;
    double strength[SIM_DISTORTION_LEVELS];
} distortions[SIM_DISTORTIONS] = {
    {"white", {1e-4, 1e-3, 1e-2}},   {"shot", {1e-4, 1e-3, 1e-2}},  {"scale", {1.5, 2.0, 3.0}},
    {"missing", {0.05, 0.10, 0.20}}, {"stretch", {1.1, 1.25, 1.5}}, {"bulge", {0.02, 0.04, 0.06}},
};

/* Shot noise changes on average one in this number of vertices. */
enum { SHOT_ONE_IN = 100 };

const char *sim_distortion_name(enum sim_distortion_kind kind)
{
    return (unsigned)kind < SIM_DISTORTIONS ? distortions[kind].name : NULL;
}

double sim_distortion_strength(struct sim_distortion distortion)
{
    return distortions[distortion.kind].strength[distortion.level - 1];
}

int sim_distortion_parse(const char *text, void *field)
{
    const char *colon = strchr(text, ':');
    for (int k = 0; colon && k < SIM_DISTORTIONS; k++) {
        const size_t length = strlen(distortions[k].name);
        if ((size_t)(colon - text) == length && memcmp(text, distortions[k].name, length) == 0 &&
            colon[1] >= '1' && colon[1] <= '0' + SIM_DISTORTION_LEVELS && colon[2] == '\0') {
            *(struct sim_distortion *)field = (struct sim_distortion){(enum sim_distortion_kind)k,
                                                                      colon[1] - '0'};
            return 0;
        }
    }
    return -EINVAL;
}

/* ---- statistics of a mesh ----------------------------------------------------------- */

static struct iso_vec3 mean_place(const struct iso_mesh *mesh)
{
    struct iso_vec3 sum = {0, 0, 0};
    for (int32_t v = 0; v < mesh->n_vertices; v++) {
        sum = iso_add(sum, mesh->vertices_mm[v]);
    }
    return iso_scale(1.0 / mesh->n_vertices, sum);
}

/* Standard deviation of the coordinates, over all three axes. */
static double spread_of(const struct iso_mesh *mesh, struct iso_vec3 mean)
{
    double sum = 0.0;
    for (int32_t v = 0; v < mesh->n_vertices; v++) {
        struct iso_vec3 d = iso_sub(mesh->vertices_mm[v], mean);
        sum += iso_dot(d, d);
    }
    return sqrt(sum / (3.0 * mesh->n_vertices));
}

static struct iso_vec3 random_normal3(struct sim_random *random)
{
    const double x = sim_random_normal(random), y = sim_random_normal(random);
    return iso_vec3(x, y, sim_random_normal(random));
}

/* ---- the distortions ------------------------------------------------------------------ */

static void add_noise(struct iso_mesh *mesh, double deviation_mm, int one_in,
                      struct sim_random *random)
{
    for (int32_t v = 0; v < mesh->n_vertices; v++) {
        if (one_in == 1 || sim_random_below(random, (uint32_t)one_in) == 0) {
            struct iso_vec3 *p = &mesh->vertices_mm[v];
            *p = iso_madd(*p, deviation_mm, random_normal3(random));
        }
    }
}

static void scale_mesh(struct iso_mesh *mesh, double factor, struct sim_random *random)
{
    factor = sim_random_below(random, 2) ? factor : 1.0 / factor;
    for (int32_t v = 0; v < mesh->n_vertices; v++) {
        mesh->vertices_mm[v] = iso_scale(factor, mesh->vertices_mm[v]);
    }
}

static void stretch_mesh(struct iso_mesh *mesh, double factor, struct sim_random *random)
{
    struct iso_vec3 axis = iso_unit(random_normal3(random)), mean = mean_place(mesh);
    const double across = 1.0 / sqrt(factor);
    for (int32_t v = 0; v < mesh->n_vertices; v++) {
        struct iso_vec3 d = iso_sub(mesh->vertices_mm[v], mean);
        d = iso_madd(iso_scale(across, d), (factor - across) * iso_dot(d, axis), axis);
        mesh->vertices_mm[v] = iso_add(mean, d);
    }
}

static int vertex_normals(const struct iso_mesh *mesh, struct iso_vec3 **out)
{
    struct iso_vec3 *normal = calloc((size_t)mesh->n_vertices, sizeof *normal);
    if (!normal) {
        return -ENOMEM;
    }
    for (int32_t t = 0; t < mesh->n_triangles; t++) {
        const int32_t *c = mesh->triangles[t];
        struct iso_vec3 a = mesh->vertices_mm[c[0]];
        struct iso_vec3 n = iso_cross(iso_sub(mesh->vertices_mm[c[1]], a),
                                      iso_sub(mesh->vertices_mm[c[2]], a));
        for (int k = 0; k < 3; k++) {
            normal[c[k]] = iso_add(normal[c[k]], n);
        }
    }
    *out = normal;
    return 0;
}

/* Moves vertices along their normals by smooth noise, whose grid has half the spread of the shape
 * (spread_of) as its pitch. The mean square of the noise is about 0.1. */
static int bulge_mesh(struct iso_mesh *mesh, double share, struct sim_random *random)
{
    struct iso_vec3 *normal = NULL;
    const int error = vertex_normals(mesh, &normal);
    if (error) {
        return error;
    }
    const double size_mm = spread_of(mesh, mean_place(mesh));
    const uint64_t key = sim_random_u64(random);
    for (int32_t v = 0; v < mesh->n_vertices; v++) {
        struct iso_vec3 *p = &mesh->vertices_mm[v];
        const double height = sim_noise3(key, iso_scale(2.0 / size_mm, *p)) / sqrt(0.1);
        *p = iso_madd(*p, share * size_mm * height, iso_unit(normal[v]));
    }
    free(normal);
    return 0;
}

struct far_triangle {
    double distance2;
    int32_t triangle;
};

static int compare_far(const void *a, const void *b)
{
    const struct far_triangle *p = a, *q = b;
    if (p->distance2 != q->distance2) {
        return p->distance2 < q->distance2 ? -1 : 1;
    }
    return p->triangle - q->triangle;
}

/* Cuts away the triangles nearest to a vertex, up to a share of the area. Vertices without
 * triangles stay; the code that makes a shape from the mesh removes them. */
static int cut_mesh(struct iso_mesh *mesh, double share, struct sim_random *random)
{
    const size_t n = (size_t)mesh->n_triangles;
    struct far_triangle *order = calloc(n, sizeof *order);
    uint8_t *gone = calloc(n, 1);
    if (!order || !gone) {
        free(order);
        free(gone);
        return -ENOMEM;
    }
    struct iso_vec3 at = mesh->vertices_mm[sim_random_below(random, (uint32_t)mesh->n_vertices)];
    for (size_t t = 0; t < n; t++) {
        const int32_t *c = mesh->triangles[t];
        struct iso_vec3 sum = iso_add(iso_add(mesh->vertices_mm[c[0]], mesh->vertices_mm[c[1]]),
                                      mesh->vertices_mm[c[2]]);
        struct iso_vec3 d = iso_sub(iso_scale(1.0 / 3.0, sum), at);
        order[t] = (struct far_triangle){iso_dot(d, d), (int32_t)t};
    }
    qsort(order, n, sizeof *order, compare_far);
    double left = share * iso_mesh_area(mesh);
    for (size_t i = 0; i + 1 < n && left > 0.0; i++) {
        left -= iso_mesh_triangle_area(mesh, order[i].triangle);
        gone[order[i].triangle] = 1;
    }
    int32_t kept = 0;
    for (size_t t = 0; t < n; t++) {
        if (!gone[t]) {
            memmove(mesh->triangles[kept++], mesh->triangles[t], sizeof *mesh->triangles);
        }
    }
    mesh->n_triangles = kept;
    free(order);
    free(gone);
    return 0;
}

int sim_distort(struct sim_distortion distortion, struct sim_random *random,
                struct iso_coloured_mesh *coloured)
{
    struct iso_mesh *mesh = coloured->mesh;
    if ((unsigned)distortion.kind >= SIM_DISTORTIONS || distortion.level < 1 ||
        distortion.level > SIM_DISTORTION_LEVELS || mesh->n_vertices < 4) {
        return -EINVAL;
    }
    const double strength = sim_distortion_strength(distortion);
    const double signal_mm = spread_of(mesh, mean_place(mesh));
    switch (distortion.kind) {
    case SIM_DISTORTION_WHITE:
        add_noise(mesh, signal_mm * sqrt(strength), 1, random);
        return 0;
    case SIM_DISTORTION_SHOT:
        add_noise(mesh, signal_mm * sqrt(strength * SHOT_ONE_IN), SHOT_ONE_IN, random);
        return 0;
    case SIM_DISTORTION_SCALE:
        scale_mesh(mesh, strength, random);
        return 0;
    case SIM_DISTORTION_MISSING:
        return cut_mesh(mesh, strength, random);
    case SIM_DISTORTION_STRETCH:
        stretch_mesh(mesh, strength, random);
        return 0;
    default:
        return bulge_mesh(mesh, strength, random);
    }
}
