/* An inversion about the centre takes each circle through it to a line. A triangle of the centre
 * and two neighbours is Delaunay if no other neighbour is inside of its circle: if the images of
 * all others are on the centre's side of the line through both images. So the triangles are the
 * edges of the convex hull of the images that have the centre on their inner side. */
#include "core/heat/intrinsic/star.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "core/base/lapack.h"

/* The sine of the angle at the centre above which a triangle counts as one. */
static const double least_sine = 1e-9;

int iso_star_init(struct iso_star *star, int32_t neighbours)
{
    const size_t n = (size_t)neighbours;
    struct iso_star made = {.found = malloc(n * sizeof *made.found),
                            .spot = malloc(n * sizeof *made.spot),
                            .hull = malloc(2 * n * sizeof *made.hull),
                            .triangle = malloc(n * sizeof *made.triangle)};
    if (!made.found || !made.spot || !made.hull || !made.triangle) {
        iso_star_done(&made);
        return -ENOMEM;
    }
    *star = made;
    return 0;
}

void iso_star_done(struct iso_star *star)
{
    free(star->found);
    free(star->spot);
    free(star->hull);
    free(star->triangle);
    *star = (struct iso_star){0};
}

/* Two axes of the plane in which the centre and its neighbours vary most. */
static int tangent_plane(const struct iso_star *star, const struct iso_vec3 *point, int32_t centre,
                         struct iso_vec3 axis[2])
{
    struct iso_vec3 mean = {0.0, 0.0, 0.0};
    double matrix[3][3] = {{0.0}}, value[3];
    for (int i = 0; i < star->n_found; i++) {
        mean = iso_add(mean, iso_sub(point[star->found[i].point], point[centre]));
    }
    mean = iso_scale(1.0 / (star->n_found + 1), mean);
    for (int i = -1; i < star->n_found; i++) {
        const int32_t at = i < 0 ? centre : star->found[i].point;
        const struct iso_vec3 off = iso_sub(iso_sub(point[at], point[centre]), mean);
        const double d[3] = {off.x, off.y, off.z};
        for (int k = 0; k < 9; k++) {
            matrix[k / 3][k % 3] += d[k / 3] * d[k % 3];
        }
    }
    const int error = iso_lapack_error(
        LAPACKE_dsyev(LAPACK_ROW_MAJOR, 'V', 'U', 3, &matrix[0][0], 3, value));
    for (int a = 0; a < 2 && !error; a++) { /* eigenvalues rise; the first one is the normal's */
        axis[a] = iso_vec3(matrix[0][a + 1], matrix[1][a + 1], matrix[2][a + 1]);
    }
    return error;
}

static int compare_spots(const void *a, const void *b)
{
    const struct iso_spot *p = a, *q = b;
    if (p->x != q->x) {
        return p->x < q->x ? -1 : 1;
    }
    if (p->y != q->y) {
        return p->y < q->y ? -1 : 1;
    }
    return (p->point > q->point) - (p->point < q->point);
}

/* Projects the neighbours into the plane and inverts them about the centre. The weights are added
 * to the squares of their distances in the plane. A neighbour that is projected onto the centre is
 * left out. Sorts the others, and returns how many they are. */
static int invert(struct iso_star *star, const struct iso_vec3 *point, const double *weight,
                  int32_t centre, const struct iso_vec3 axis[2])
{
    int n = 0;
    for (int i = 0; i < star->n_found; i++) {
        const int32_t at = star->found[i].point;
        const struct iso_vec3 off = iso_sub(point[at], point[centre]);
        const double x = iso_dot(off, axis[0]), y = iso_dot(off, axis[1]);
        const double power = x * x + y * y + weight[at] - weight[centre];
        if (power > 0.0) {
            star->spot[n++] = (struct iso_spot){x / power, y / power, at};
        }
    }
    qsort(star->spot, (size_t)n, sizeof *star->spot, compare_spots);
    return n;
}

static double turn(const struct iso_spot *a, const struct iso_spot *b, const struct iso_spot *c)
{
    return (b->x - a->x) * (c->y - a->y) - (b->y - a->y) * (c->x - a->x);
}

/* Adds a spot to a chain that turns left, and removes corners that no longer do. */
static int add_corner(struct iso_spot *hull, int n, int first, const struct iso_spot *spot)
{
    while (n >= first + 2 && turn(&hull[n - 2], &hull[n - 1], spot) <= 0.0) {
        n--;
    }
    hull[n] = *spot;
    return n + 1;
}

/* The convex hull, counter-clockwise (Andrew 1979). */
static void find_hull(struct iso_star *star, int n)
{
    int corners = 0;
    for (int i = 0; i < n; i++) {
        corners = add_corner(star->hull, corners, 0, &star->spot[i]);
    }
    const int first = corners - 1;
    for (int i = n - 2; i >= 0; i--) {
        corners = add_corner(star->hull, corners, first, &star->spot[i]);
    }
    star->n_corners = n > 1 ? corners - 1 : n; /* the last corner is the first one again */
}

int iso_star_find(struct iso_star *star, const struct iso_vec3 *point, const double *weight,
                  int32_t centre)
{
    struct iso_vec3 axis[2];
    star->n_triangles = 0;
    const int error = tangent_plane(star, point, centre, axis);
    if (error) {
        return error;
    }
    find_hull(star, invert(star, point, weight, centre, axis));
    for (int i = 0; i < star->n_corners; i++) {
        const struct iso_spot *a = &star->hull[i], *b = &star->hull[(i + 1) % star->n_corners];
        const double area = a->x * b->y - a->y * b->x;
        if (area > least_sine * hypot(a->x, a->y) * hypot(b->x, b->y)) {
            int32_t *corner = star->triangle[star->n_triangles++];
            corner[0] = centre;
            corner[1] = a->point;
            corner[2] = b->point;
        }
    }
    return 0;
}
