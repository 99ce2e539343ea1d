/* Flips the edges of an intrinsic triangulation until it is Delaunay. Such a triangulation exists,
 * and the flips reach it in every order (Bobenko and Springborn, "A discrete Laplace-Beltrami
 * operator for simplicial surfaces", Discrete and Computational Geometry 38, 2007). */
#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "core/heat/intrinsic/intrinsic.h"

/* Rounding may bring a sum of two cotangents below 0. An edge counts as Delaunay as long as the sum
 * is above -rounding (1 + the magnitudes of both). */
static const double rounding = 1e-9;

static const int64_t flips_for_each_side = 100;

double iso_intrinsic_area(const struct iso_intrinsic *s, int32_t triangle)
{
    const double *l = &s->length[3 * (size_t)triangle];
    const double a = fmax(l[0], fmax(l[1], l[2])), c = fmin(l[0], fmin(l[1], l[2]));
    const double b = fmax(fmin(l[0], l[1]), fmin(fmax(l[0], l[1]), l[2])); /* the middle one */
    const double product = (a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c));
    return 0.25 * sqrt(fmax(0.0, product));
}

double iso_intrinsic_cotangent(const struct iso_intrinsic *s, int32_t side)
{
    const double area = iso_intrinsic_area(s, side / 3), a = s->length[side];
    const double b = s->length[iso_side_next(side)];
    const double c = s->length[iso_side_next(iso_side_next(side))];
    return area > 0.0 ? (b * b + c * c - a * a) / (4.0 * area) : 0.0;
}

static bool is_delaunay(const struct iso_intrinsic *s, int32_t side)
{
    const double a = iso_intrinsic_cotangent(s, side);
    const double b = iso_intrinsic_cotangent(s, s->across[side]);
    return a + b >= -rounding * (1.0 + fabs(a) + fabs(b));
}

/* Where the corner opposite to a side is, along the side and across it. */
static void opposite_corner(const struct iso_intrinsic *s, int32_t side, double *along,
                            double *across)
{
    const double edge = s->length[side], to = s->length[iso_side_next(side)];
    const double from = s->length[iso_side_next(iso_side_next(side))];
    *along = (edge * edge + from * from - to * to) / (2.0 * edge);
    *across = 2.0 * iso_intrinsic_area(s, side / 3) / edge;
}

/* The length of the other diagonal of the two triangles of an edge, laid out in a plane. */
static double other_diagonal(const struct iso_intrinsic *s, int32_t side)
{
    double x, y, x_back, y_back;
    opposite_corner(s, side, &x, &y);
    opposite_corner(s, s->across[side], &x_back, &y_back);
    return hypot(s->length[side] - x_back - x, y + y_back);
}

static void set_side(struct iso_intrinsic *s, int32_t side, int32_t corner, double length,
                     int32_t across)
{
    s->corner[side] = corner;
    s->length[side] = length;
    s->across[side] = across;
    s->across[across] = side;
}

/* The edge from i to j, with the triangles (i, j, k) and (j, i, m), becomes the edge from m to k,
 * with the triangles (i, m, k) and (j, k, m). outer [4] receives the other sides of these. */
static void flip(struct iso_intrinsic *s, int32_t side, int32_t outer[4])
{
    const int32_t back = s->across[side], t = side / 3 * 3, u = back / 3 * 3;
    const int32_t jk = iso_side_next(side), ki = iso_side_next(jk);
    const int32_t im = iso_side_next(back), mj = iso_side_next(im);
    const int32_t k = s->corner[ki], m = s->corner[mj];
    const double diagonal = other_diagonal(s, side);
    const int32_t old[4] = {im, ki, jk, mj}, now[4] = {t, t + 2, u, u + 2};
    int32_t corner[4], across[4];
    double length[4];
    for (int q = 0; q < 4; q++) {
        corner[q] = s->corner[old[q]];
        length[q] = s->length[old[q]];
        across[q] = s->across[old[q]];
        for (int r = 0; r < 4; r++) { /* two of the four may be the same edge */
            if (s->across[old[q]] == old[r]) {
                across[q] = now[r];
            }
        }
    }
    for (int q = 0; q < 4; q++) {
        set_side(s, now[q], corner[q], length[q], across[q]);
        outer[q] = now[q];
    }
    set_side(s, t + 1, m, diagonal, u + 1);
    set_side(s, u + 1, k, diagonal, t + 1);
}

/* Sides that have yet to be looked at, each once at most. */
struct waiting {
    int32_t *side;   /* [n_sides] */
    uint8_t *listed; /* [n_sides] */
    int32_t n;
};

static void add_side(struct waiting *waiting, int32_t side)
{
    if (!waiting->listed[side]) {
        waiting->listed[side] = 1;
        waiting->side[waiting->n++] = side;
    }
}

static int flip_all(struct iso_intrinsic *s, struct waiting *waiting, int64_t *n_flips)
{
    const int64_t most = flips_for_each_side * s->n_sides;
    int64_t n = 0;
    for (int32_t side = 0; side < s->n_sides; side++) {
        if (side < s->across[side]) {
            add_side(waiting, side);
        }
    }
    while (waiting->n > 0 && n <= most) {
        const int32_t side = waiting->side[--waiting->n];
        waiting->listed[side] = 0;
        /* If both sides of an edge belong to one triangle, this triangle is isosceles. The two
         * angles opposite to the edge are its base angles, so the edge is Delaunay. */
        if (side / 3 != s->across[side] / 3 && !is_delaunay(s, side)) {
            int32_t outer[4];
            flip(s, side, outer);
            n++;
            for (int q = 0; q < 4; q++) {
                add_side(waiting, outer[q]);
            }
        }
    }
    *n_flips = n;
    return n <= most ? 0 : -ENOTRECOVERABLE;
}

int iso_intrinsic_delaunay(struct iso_intrinsic *surface, int64_t *n_flips)
{
    const size_t n = (size_t)surface->n_sides;
    struct waiting waiting = {.side = malloc(n * sizeof(int32_t)), .listed = calloc(n, 1)};
    const int error = waiting.side && waiting.listed ? flip_all(surface, &waiting, n_flips)
                                                     : -ENOMEM;
    free(waiting.side);
    free(waiting.listed);
    return error;
}
