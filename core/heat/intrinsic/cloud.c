/* The triangles of a cloud of points, and their matrices (isotherm/stiffness_mass.h). */
#include "core/heat/intrinsic/cloud.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "core/heat/intrinsic/star.h"
#include "core/surface/corners.h"
#include "isotherm/stiffness_mass.h"

/* A triangle is in the stars of its three corners, if these agree. */
static const double stars_of_triangle = 3.0;

/* The largest weight of a point, in squares of the distance to its nearest neighbour: large beside
 * rounding, small beside what the triangles are for. */
static const double most_weight = 1e-6;

/* ---- the points ---- */

struct place {
    struct iso_vec3 at;
    int32_t point;
};

static int compare_places(const void *a, const void *b)
{
    const struct place *p = a, *q = b;
    const double x[3] = {p->at.x, p->at.y, p->at.z}, y[3] = {q->at.x, q->at.y, q->at.z};
    for (int k = 0; k < 3; k++) {
        if (x[k] != y[k]) {
            return x[k] < y[k] ? -1 : 1;
        }
    }
    return (p->point > q->point) - (p->point < q->point);
}

/* The first point at every place. number [n] receives them; returns how many there are, or
 * -ENOMEM. */
static int32_t find_places(const struct iso_vec3 *point, int32_t n, int32_t *number)
{
    struct place *place = malloc((size_t)n * sizeof *place);
    int32_t found = 0;
    if (!place) {
        return -ENOMEM;
    }
    for (int32_t i = 0; i < n; i++) {
        place[i] = (struct place){point[i], i};
    }
    qsort(place, (size_t)n, sizeof *place, compare_places);
    for (int32_t i = 0; i < n; i++) {
        const struct iso_vec3 a = place[i].at, b = place[i > 0 ? i - 1 : 0].at;
        if (i == 0 || a.x != b.x || a.y != b.y || a.z != b.z) {
            number[found++] = place[i].point;
        }
    }
    free(place);
    return found;
}

/* A number of 0..1 for every point that looks random (the last steps of MurmurHash3). */
static double scatter(uint32_t h)
{
    h ^= h >> 16;
    h *= 0x85ebca6bU;
    h ^= h >> 13;
    h *= 0xc2b2ae35U;
    h ^= h >> 16;
    return h / (double)UINT32_MAX;
}

/* ---- the triangles ---- */

struct stars {
    const struct iso_vec3 *point;
    const int32_t *number; /* [n_places] */
    int32_t n_places, neighbours;
    double *weight; /* [n]: see iso_star_find() */
    struct iso_nearest tree;
    struct iso_star star;
};

static void weigh(struct stars *stars)
{
    for (int32_t i = 0; i < stars->n_places; i++) {
        const int32_t p = stars->number[i];
        struct iso_neighbour next = {0.0, 0};
        if (iso_nearest_find(&stars->tree, p, 1, &next) > 0) {
            stars->weight[p] = most_weight * next.square * scatter((uint32_t)p);
        }
    }
}

static int add_star(struct stars *stars, int32_t centre, struct iso_mesh *mesh)
{
    struct iso_star *star = &stars->star;
    star->n_found = iso_nearest_find(&stars->tree, centre, stars->neighbours, star->found);
    int error = iso_star_find(star, stars->point, stars->weight, centre);
    if (!error && mesh->n_triangles > INT32_MAX / 12 - star->n_triangles) {
        error = -EFBIG;
    }
    if (!error) {
        error = iso_mesh_reserve(mesh, 0, mesh->n_triangles + star->n_triangles);
    }
    if (!error && star->n_triangles > 0) {
        memcpy(mesh->triangles[mesh->n_triangles], star->triangle,
               (size_t)star->n_triangles * sizeof *star->triangle);
        mesh->n_triangles += star->n_triangles;
    }
    return error;
}

static int add_stars(struct stars *stars, int32_t n, struct iso_mesh *mesh)
{
    stars->weight = calloc((size_t)n, sizeof *stars->weight);
    int error = stars->weight ? 0 : -ENOMEM;
    if (!error) {
        error = iso_nearest_init(&stars->tree, stars->point, stars->number, stars->n_places);
    }
    if (!error) {
        error = iso_star_init(&stars->star, stars->neighbours);
    }
    if (!error) {
        weigh(stars);
    }
    for (int32_t i = 0; i < stars->n_places && !error; i++) {
        error = add_star(stars, stars->number[i], mesh);
    }
    iso_star_done(&stars->star);
    iso_nearest_done(&stars->tree);
    free(stars->weight);
    return error;
}

static bool are_finite(const struct iso_vec3 *point, int32_t n)
{
    for (int32_t i = 0; i < n; i++) {
        if (!isfinite(point[i].x) || !isfinite(point[i].y) || !isfinite(point[i].z)) {
            return false;
        }
    }
    return true;
}

int iso_cloud_triangulate(const struct iso_vec3 *point, int32_t n, int32_t neighbours,
                          struct iso_mesh **out)
{
    struct iso_mesh *mesh = NULL;
    const int32_t wanted = neighbours ? neighbours : ISO_CLOUD_NEIGHBOURS;
    if (n < 1 || wanted < ISO_CLOUD_NEIGHBOURS_MIN || wanted > ISO_CLOUD_NEIGHBOURS_MAX ||
        !are_finite(point, n)) {
        return -EINVAL;
    }
    int32_t *number = malloc((size_t)n * sizeof *number);
    const int32_t found = number ? find_places(point, n, number) : -ENOMEM;
    int error = found < 0 ? found : iso_mesh_new(n, 1, &mesh);
    if (!error) {
        struct stars stars = {
            .point = point, .number = number, .n_places = found, .neighbours = wanted};
        memcpy(mesh->vertices_mm, point, (size_t)n * sizeof *point);
        mesh->n_vertices = n;
        error = add_stars(&stars, n, mesh);
    }
    free(number);
    if (error) {
        iso_mesh_free(mesh);
        return error;
    }
    *out = mesh;
    return 0;
}

void iso_cloud_boundary(const struct iso_mesh *cloud, uint8_t *open)
{
    memset(open, 1, (size_t)cloud->n_vertices);
    for (int32_t t = 0, end = 0; t < cloud->n_triangles; t = end) {
        const int32_t centre = cloud->triangles[t][0];
        bool closed = true;
        while (end < cloud->n_triangles && cloud->triangles[end][0] == centre) {
            closed = closed &&
                     (end == t || cloud->triangles[end][1] == cloud->triangles[end - 1][2]);
            end++;
        }
        open[centre] = !closed || cloud->triangles[end - 1][2] != cloud->triangles[t][1];
    }
}

int iso_cloud_merge(struct iso_mesh *cloud)
{
    struct iso_corners *order = malloc(((size_t)cloud->n_triangles + 1) * sizeof *order);
    uint8_t *keep = calloc((size_t)cloud->n_triangles + 1, 1);
    const bool room = order && keep;
    int32_t n = 0;
    for (int32_t t = 0; t < cloud->n_triangles && room; t++) {
        order[t] = iso_corners_of(cloud->triangles[t], t);
    }
    if (room) {
        qsort(order, (size_t)cloud->n_triangles, sizeof *order, iso_corners_compare);
    }
    for (int32_t i = 0; i < cloud->n_triangles && room; i++) {
        keep[order[i].triangle] = i == 0 || !iso_corners_are_same(&order[i], &order[i - 1]);
    }
    for (int32_t t = 0; t < cloud->n_triangles && room; t++) {
        if (keep[t]) {
            memcpy(cloud->triangles[n++], cloud->triangles[t], sizeof *cloud->triangles);
        }
    }
    cloud->n_triangles = room ? n : cloud->n_triangles;
    free(order);
    free(keep);
    return room ? 0 : -ENOMEM;
}

int iso_stiffness_mass_cloud(const struct iso_mesh *cloud, enum iso_mass kind,
                             const double *density, struct iso_symmetric *stiffness,
                             struct iso_symmetric *mass)
{
    const int error = iso_stiffness_mass_robust(cloud, kind, density, stiffness, mass);
    if (error) {
        return error;
    }
    for (int32_t i = 0; i < stiffness->nnz; i++) {
        stiffness->value[i] /= stars_of_triangle;
    }
    for (int32_t i = 0; i < mass->nnz; i++) {
        mass->value[i] /= stars_of_triangle;
    }
    return 0;
}
