/* The tufted cover of a mesh (intrinsic.h). */
#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "core/heat/intrinsic/intrinsic.h"

/* Two edges of a triangle together are longer than the third edge by at least this share of the
 * mean length of all edges (Sharp and Crane 2020). */
static const double margin = 1e-5;

void iso_intrinsic_done(struct iso_intrinsic *surface)
{
    free(surface->corner);
    free(surface->length);
    free(surface->across);
    *surface = (struct iso_intrinsic){0};
}

/* ---- the two sides of a triangle ---- */

/* Triangle t of the mesh becomes 2 t, seen from its front, and 2 t + 1, seen from its back with its
 * corners in the order 0, 2, 1. These are the sides of edge k of t. */
static int32_t front_side(int32_t t, int k)
{
    return 3 * (2 * t) + k;
}

static int32_t back_side(int32_t t, int k)
{
    return 3 * (2 * t + 1) + 2 - k;
}

/* Sets corners and lengths. Returns the mean length of an edge. */
static double measure(const struct iso_mesh *mesh, struct iso_intrinsic *s)
{
    double sum = 0.0;
    for (int32_t t = 0; t < mesh->n_triangles; t++) {
        const int32_t *v = mesh->triangles[t];
        for (int k = 0; k < 3; k++) {
            const int32_t from = v[k], to = v[(k + 1) % 3];
            const double length = iso_norm(iso_sub(mesh->vertices_mm[to], mesh->vertices_mm[from]));
            s->corner[front_side(t, k)] = from;
            s->corner[back_side(t, k)] = to;
            s->length[front_side(t, k)] = s->length[back_side(t, k)] = length;
            sum += length;
        }
    }
    return sum / (3.0 * mesh->n_triangles);
}

/* Makes all edges longer by the least length with which every triangle keeps the margin. */
static void mollify(struct iso_intrinsic *s, double mean)
{
    double longer = 0.0;
    for (int32_t a = 0; a < s->n_sides; a++) {
        const int32_t b = iso_side_next(a), c = iso_side_next(b);
        const double lacks = margin * mean - (s->length[a] + s->length[b] - s->length[c]);
        /* Not fmax(): gcc 12.2 for arm64 fails on it here at -O3. */
        longer = lacks > longer ? lacks : longer;
    }
    for (int32_t a = 0; a < s->n_sides; a++) {
        s->length[a] += longer;
    }
}

/* ---- the triangles around an edge ---- */

/* An edge as one of its triangles has it. */
struct fin {
    int32_t low, high; /* its vertices, low < high */
    int32_t triangle;
    int k;         /* which edge of the triangle it is */
    int32_t third; /* its other vertex */
    double angle;  /* of the triangle about the edge, counter-clockwise seen from high to low */
};

/* By edge, then around it. Copies of a triangle follow each other. */
static int compare_fins(const void *a, const void *b)
{
    const struct fin *x = a, *y = b;
    if (x->low != y->low) {
        return x->low < y->low ? -1 : 1;
    }
    if (x->high != y->high) {
        return x->high < y->high ? -1 : 1;
    }
    if (x->angle != y->angle) {
        return x->angle < y->angle ? -1 : 1;
    }
    if (x->third != y->third) {
        return x->third < y->third ? -1 : 1;
    }
    return (x->triangle > y->triangle) - (x->triangle < y->triangle);
}

/* A vector at right angles to another one: its vector product with the axis of the smallest
 * coordinate. */
static struct iso_vec3 right_angle_to(struct iso_vec3 a)
{
    const double x = fabs(a.x), y = fabs(a.y), z = fabs(a.z);
    const struct iso_vec3 axis = x <= y && x <= z ? iso_vec3(1, 0, 0)
                                 : y <= z         ? iso_vec3(0, 1, 0)
                                                  : iso_vec3(0, 0, 1);
    return iso_cross(a, axis);
}

/* Finds the angles of `n` triangles about their common edge. About an edge of length 0 all are 0:
 * any order makes a cover. */
static void find_angles(const struct iso_mesh *mesh, struct fin *fin, int32_t n)
{
    const struct iso_vec3 from = mesh->vertices_mm[fin->low];
    const struct iso_vec3 along = iso_sub(mesh->vertices_mm[fin->high], from);
    const double length = iso_norm(along);
    if (length > 0.0) {
        const struct iso_vec3 unit = iso_scale(1.0 / length, along);
        const struct iso_vec3 e1 = right_angle_to(unit), e2 = iso_cross(unit, e1);
        for (int32_t i = 0; i < n; i++) {
            const struct iso_vec3 out = iso_sub(mesh->vertices_mm[fin[i].third], from);
            fin[i].angle = atan2(iso_dot(out, e2), iso_dot(out, e1));
        }
    }
    qsort(fin, (size_t)n, sizeof *fin, compare_fins);
}

/* The side that runs from the low to the high vertex faces the next triangle of the angle's order,
 * the other side faces the one before. */
static int32_t side_ahead(const struct iso_mesh *mesh, const struct fin *fin)
{
    const bool forward = mesh->triangles[fin->triangle][fin->k] == fin->low;
    return forward ? front_side(fin->triangle, fin->k) : back_side(fin->triangle, fin->k);
}

static int32_t side_behind(const struct iso_mesh *mesh, const struct fin *fin)
{
    const bool forward = mesh->triangles[fin->triangle][fin->k] == fin->low;
    return forward ? back_side(fin->triangle, fin->k) : front_side(fin->triangle, fin->k);
}

/* The largest number of copies of one triangle among `n` triangles about an edge. */
static int32_t most_copies(const struct fin *fin, int32_t n)
{
    int32_t most = 1, copies = 1;
    for (int32_t i = 1; i < n; i++) {
        copies = fin[i].third == fin[i - 1].third ? copies + 1 : 1;
        most = copies > most ? copies : most;
    }
    return most;
}

/* Joins the sides of `n` triangles about an edge. If there are copies of triangles, as in a cloud
 * of points, the triangles are dealt to as many sheets, so that copies are in different sheets, and
 * each sheet is joined alone. Two copies that were joined to each other would be a pocket with no
 * way out of it but its corners. Flips within such pockets make the eigenvalues of a cloud 5 % too
 * small. */
static void join_edge(const struct iso_mesh *mesh, const struct fin *fin, int32_t n,
                      struct iso_intrinsic *s)
{
    const int32_t sheets = most_copies(fin, n);
    for (int32_t i = 0; i < n; i++) {
        const int32_t next = i + sheets < n ? i + sheets : i % sheets;
        const int32_t ahead = side_ahead(mesh, &fin[i]), behind = side_behind(mesh, &fin[next]);
        s->across[ahead] = behind;
        s->across[behind] = ahead;
    }
}

/* Joins the sides of every edge. fin [3 n_triangles] is working memory. */
static void join(const struct iso_mesh *mesh, struct fin *fin, struct iso_intrinsic *s)
{
    const int32_t n = 3 * mesh->n_triangles;
    for (int32_t i = 0; i < n; i++) {
        const int32_t *v = mesh->triangles[i / 3], p = v[i % 3], q = v[(i + 1) % 3];
        fin[i] = (struct fin){p < q ? p : q, p < q ? q : p, i / 3, i % 3, v[(i + 2) % 3], 0.0};
    }
    qsort(fin, (size_t)n, sizeof *fin, compare_fins);
    for (int32_t first = 0, end = 0; first < n; first = end) {
        while (end < n && fin[end].low == fin[first].low && fin[end].high == fin[first].high) {
            end++;
        }
        if (end - first > 2) { /* of one or two triangles there is only one order around an edge */
            find_angles(mesh, &fin[first], end - first);
        }
        join_edge(mesh, &fin[first], end - first, s);
    }
}

int iso_intrinsic_cover(const struct iso_mesh *mesh, struct iso_intrinsic *out)
{
    if (mesh->n_triangles < 1 || mesh->n_triangles > INT32_MAX / 12) {
        return -EINVAL;
    }
    struct iso_intrinsic s = {.n_triangles = 2 * mesh->n_triangles,
                              .n_sides = 6 * mesh->n_triangles};
    const size_t n = (size_t)s.n_sides;
    s.corner = malloc(n * sizeof *s.corner);
    s.length = malloc(n * sizeof *s.length);
    s.across = malloc(n * sizeof *s.across);
    struct fin *fin = malloc(n / 2 * sizeof *fin);
    int error = s.corner && s.length && s.across && fin ? 0 : -ENOMEM;
    if (!error) {
        const double mean = measure(mesh, &s);
        if (mean > 0.0) {
            mollify(&s, mean);
            join(mesh, fin, &s);
        } else {
            error = -EINVAL;
        }
    }
    free(fin);
    if (error) {
        iso_intrinsic_done(&s);
        return error;
    }
    *out = s;
    return 0;
}
