#include "core/heat/grid/grid_stencil.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/lanes.h"

/* BLOCK: the number of rows that share one row of the plane `bound`. */
enum { PLANES = 7, BLOCK = 8 };

int iso_grid_stencil_new(const struct iso_grid *grid, struct iso_grid_stencil **out)
{
    struct iso_grid_stencil *s = calloc(1, sizeof *s);
    if (!s) {
        return -ENOMEM;
    }
    s->stride = grid->stride;
    s->plane_size = iso_grid_plane_size(grid);
    s->memory = iso_grid_planes_new(grid, PLANES);
    if (!s->memory) {
        free(s);
        return -ENOMEM;
    }
    float **const planes[PLANES] = {&s->centre,     &s->east, &s->south, &s->south_east,
                                    &s->south_west, &s->root, &s->bound};
    for (size_t i = 0; i < PLANES; i++) {
        *planes[i] = s->memory + i * s->plane_size + iso_grid_plane_origin(grid);
    }
    *out = s;
    return 0;
}

void iso_grid_stencil_free(struct iso_grid_stencil *stencil)
{
    if (stencil) {
        iso_grid_planes_free(stencil->memory, stencil->plane_size, PLANES);
        free(stencil);
    }
}

/* What eight cells in a row contribute to the entries of L. */
struct cells {
    iso_lanes top, bottom, left, right, falling, rising; /* edges of the cell, its diagonals */
    iso_lanes bound;
};

/* The absolute value. It replaces comparisons, which compilers do lane by lane. */
#define ABSOLUTE(a) ((iso_lanes)((iso_lane_bits)(a)&INT32_MAX))

/* Adds the triangles that leave out corner k; z are the heights of the cells' corners. */
static inline void add_triangles(struct cells *c, const iso_lanes z[4], int k,
                                 const float *area_mm2, float p)
{
    const int middle = 3 - k;
    const iso_lanes area = ISO_LANES_LOAD(area_mm2);
    const iso_lanes a = z[middle ^ 1] - z[middle], b = z[middle ^ 2] - z[middle];
    const iso_lanes scale = 0.5f * area / (area * area + 1e-20f); /* 0 where there is none */
    const iso_lanes at_middle = scale * a * b;
    const iso_lanes at_along = scale * (p * p + a * a) - at_middle;
    const iso_lanes at_down = scale * (p * p + b * b) - at_middle;
    /* Each edge gets half the cotangent of the corner opposite to it. */
    *(middle < 2 ? &c->top : &c->bottom) -= 0.5f * at_down;
    *(middle % 2 ? &c->right : &c->left) -= 0.5f * at_along;
    *(middle == 0 || middle == 3 ? &c->rising : &c->falling) -= 0.5f * at_middle;
    /* s + sqrt(s^2 - 3) without the root, from above by the series of sqrt(1 - x). (s^2 >= 3.) */
    const iso_lanes sum = at_middle + at_along + at_down;
    const iso_lanes x = 3.0f / (3.0f + ABSOLUTE(sum * sum - 3.0f));
    const iso_lanes root = 1.0f - x * (0.5f + x * (0.125f + x * 0.0625f));
    const iso_lanes bound = 3.0f * scale * (sum + sum * root);
    c->bound = 0.5f * (c->bound + bound + ABSOLUTE(c->bound - bound)); /* the larger */
}

#define ADD(plane, value) ISO_LANES_STORE(plane, ISO_LANES_LOAD(plane) + (value))

/* Adds the entries of L for the edges of a part of a row of cells, in whole groups of lanes.
 * `below`: the row of pixels below the cells belongs to the window too. */
static inline void add_row(struct iso_grid_stencil *s, const struct iso_grid *grid, int row,
                           ptrdiff_t left, ptrdiff_t end, bool below)
{
    const ptrdiff_t w = s->stride, from = row * w + left, to = row * w + end;
    float *bound = s->bound - row % BLOCK * w;
    for (ptrdiff_t i = from; i < to; i += ISO_LANES) {
        const iso_lanes z[4] = {ISO_LANES_LOAD(&grid->z_mm[i]), ISO_LANES_LOAD(&grid->z_mm[i + 1]),
                                ISO_LANES_LOAD(&grid->z_mm[i + w]),
                                ISO_LANES_LOAD(&grid->z_mm[i + w + 1])};
        struct cells c = {.bound = ISO_LANES_LOAD(&bound[i])};
        add_triangles(&c, z, 0, &grid->cell_mm2[0][i], (float)grid->pitch_mm);
        add_triangles(&c, z, 1, &grid->cell_mm2[1][i], (float)grid->pitch_mm);
        add_triangles(&c, z, 2, &grid->cell_mm2[2][i], (float)grid->pitch_mm);
        add_triangles(&c, z, 3, &grid->cell_mm2[3][i], (float)grid->pitch_mm);
        ADD(&s->east[i], c.top);
        ADD(&s->south[i], c.left);
        ADD(&s->south[i + 1], c.right);
        ISO_LANES_STORE(&s->south_east[i], c.falling);
        ISO_LANES_STORE(&s->south_west[i], c.rising);
        ISO_LANES_STORE(&bound[i], c.bound);
        if (below) {
            ADD(&s->east[i + w], c.bottom);
        }
    }
}

/* The diagonal of L: minus the sum of a row's other entries. */
static void sum_row(struct iso_grid_stencil *s, ptrdiff_t from, ptrdiff_t to)
{
    const ptrdiff_t w = s->stride;
    for (ptrdiff_t i = from; i < to; i += ISO_LANES) {
        iso_lanes sum = ISO_LANES_LOAD(&s->east[i]) + ISO_LANES_LOAD(&s->east[i - 1]);
        sum += ISO_LANES_LOAD(&s->south[i]) + ISO_LANES_LOAD(&s->south[i - w]);
        sum += ISO_LANES_LOAD(&s->south_east[i]) + ISO_LANES_LOAD(&s->south_east[i - w - 1]);
        sum += ISO_LANES_LOAD(&s->south_west[i - 1]) + ISO_LANES_LOAD(&s->south_west[i - w]);
        ISO_LANES_STORE(&s->centre[i], -sum);
    }
}

/* Fills in D^-1/2; 0 where there is no vertex. */
static void root_row(struct iso_grid_stencil *s, const struct iso_grid *grid, ptrdiff_t from,
                     ptrdiff_t to)
{
    for (ptrdiff_t i = from; i < to; i++) {
        const float share = grid->share_mm2[i];
        s->root[i] = 1.0f / sqrtf(share > 0.0f ? share : INFINITY);
    }
}

/* L becomes D^-1/2 L D^-1/2. */
static void scale_row(struct iso_grid_stencil *s, ptrdiff_t from, ptrdiff_t to)
{
    const ptrdiff_t w = s->stride;
    for (ptrdiff_t i = from; i < to; i += ISO_LANES) {
        const float *root = &s->root[i];
#define SCALE(plane, one, other)                                                              \
    ISO_LANES_STORE(&s->plane[i], ISO_LANES_LOAD(&s->plane[i]) * ISO_LANES_LOAD(&root[one]) * \
                                      ISO_LANES_LOAD(&root[other]))
        SCALE(centre, 0, 0);
        SCALE(east, 0, 1);
        SCALE(south, 0, w);
        SCALE(south_east, 0, w + 1);
        SCALE(south_west, 1, w);
#undef SCALE
    }
}

void iso_grid_stencil_build(struct iso_grid_stencil *s, const struct iso_grid *grid,
                            struct iso_grid_window window)
{
    const ptrdiff_t w = s->stride, end = window.column + window.width;
    const ptrdiff_t left = window.column > 0 ? window.column - ISO_LANES : 0;
    /* The cells of the row above the window have triangles at the window's pixels too. */
    const int first = window.row > 0 ? window.row - 1 : 0, bottom = window.row + window.height;
    memset(s->memory, 0, PLANES * s->plane_size * sizeof *s->memory);
    for (int row = first; row < bottom; row++) {
        if (row + 1 < grid->height) {
            add_row(s, grid, row, left, end, row + 1 < bottom);
        }
    }
    for (int row = window.row; row < bottom; row++) {
        root_row(s, grid, row * w + window.column, row * w + end);
    }
    for (int row = window.row; row < bottom; row++) {
        sum_row(s, row * w + window.column, row * w + end);
    }
    for (int row = window.row; row < bottom; row++) {
        scale_row(s, row * w + window.column, row * w + end);
    }
}

/* Raises `most` to the larger of each pair. No value is negative, so that floats have the same
 * order as their bits. */
#define LARGER(most, bound)                                                                \
    do {                                                                                   \
        const iso_lane_bits now = (iso_lane_bits)ISO_LANES_LOAD(bound), is = now > (most); \
        (most) = (now & is) | ((most) & ~is);                                              \
    } while (0)

double iso_grid_stencil_bound(const struct iso_grid_stencil *s, struct iso_grid_window window)
{
    union {
        iso_lane_bits bits;
        float value[ISO_LANES];
    } most = {.bits = {0}};
    const int first = window.row > 0 ? window.row - 1 : 0; /* its cells reach into the window */
    for (int row = first / BLOCK * BLOCK; row < window.row + window.height; row += BLOCK) {
        const float *bound = &s->bound[row * s->stride + window.column];
        for (int i = 0; i < window.width; i += ISO_LANES) {
            LARGER(most.bits, &bound[i - 1]);
        }
        LARGER(most.bits, &bound[window.width - ISO_LANES]);
    }
    float all = 0.0f;
    for (int k = 0; k < ISO_LANES; k++) {
        all = most.value[k] > all ? most.value[k] : all;
    }
    return (double)all;
}
