#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "core/isotherm/grid_band.h"
#include "core/isotherm/grid_isotherm.h"
#include "core/isotherm/tracer_store.h"

struct iso_grid_tracer {
    struct iso__grid_band band;
    uint8_t *passed; /* for each cell, bits of the triangles (cell.h) that are traced already */
    struct iso_tracer *curves;
};

/* What is being traced. */
struct scene {
    const struct iso_grid *grid;
    const struct iso_grid_field *field;
    double level;
};

/* A triangle of the curve; left_out < 0: there is none. */
struct place {
    int32_t cell;
    int left_out;
};

int iso_grid_tracer_new(const struct iso_grid *grid, struct iso_grid_tracer **out)
{
    struct iso_grid_tracer *t = calloc(1, sizeof *t);
    if (!t) {
        return -ENOMEM;
    }
    t->passed = calloc(iso_grid_plane_size(grid), 1);
    int error = t->passed ? iso__grid_band_init(&t->band, grid) : -ENOMEM;
    if (!error) {
        error = iso_tracer_new(2 * grid->width * grid->height, &t->curves);
    }
    if (error) {
        iso_grid_tracer_free(t);
        return error;
    }
    *out = t;
    return 0;
}

void iso_grid_tracer_free(struct iso_grid_tracer *tracer)
{
    if (tracer) {
        iso__grid_band_done(&tracer->band);
        iso_tracer_free(tracer->curves);
        free(tracer->passed);
        free(tracer);
    }
}

const struct iso_tracer *iso_grid_tracer_curves(const struct iso_grid_tracer *tracer)
{
    return tracer->curves;
}

/* The two edges that a level cuts, each by the corner opposite to it: at one the triangle turns
 * from hot to cold, at the other back, counter-clockwise (tracer_store.h). -1: the level does not
 * cut the triangle. */
struct turn {
    int8_t enters, leaves;
};

static struct turn turn_of(const struct scene *scene, struct place at)
{
    /* By the set of the hot corners. */
    static const struct turn turns[8] = {{-1, -1}, {2, 1}, {0, 2}, {0, 1},
                                         {1, 0},   {2, 0}, {1, 2}, {-1, -1}};
    unsigned hot = 0;
    for (int k = 0; k < 3; k++) {
        const int32_t vertex = iso_grid_corner(scene->grid, at.cell,
                                               iso_cell_corners[at.left_out][k]);
        hot |= (unsigned)((double)scene->field->value[vertex] >= scene->level) << k;
    }
    return turns[hot];
}

static struct iso_vec3 cut(const struct scene *scene, struct place at, int edge)
{
    const uint8_t *corners = iso_cell_corners[at.left_out];
    const int32_t a = iso_grid_corner(scene->grid, at.cell, corners[(edge + 1) % 3]);
    const int32_t b = iso_grid_corner(scene->grid, at.cell, corners[(edge + 2) % 3]);
    double from = (double)scene->field->value[a], to = (double)scene->field->value[b];
    const struct iso_vec3 start = iso_grid_vertex(scene->grid, a);
    return iso_madd(start, (scene->level - from) / (to - from),
                    iso_sub(iso_grid_vertex(scene->grid, b), start));
}

/* The triangle of a cell that has the corners p and q, which lie on one side of the cell, so that
 * there is at most one. None outside the window. */
static struct place with_corners(const struct scene *scene, int32_t cell, int p, int q)
{
    int32_t row = cell / scene->grid->stride, column = cell % scene->grid->stride;
    const struct iso_grid_window *w = &scene->field->window;
    const struct place none = {cell, -1};
    if (row < w->row || column < w->column || row + 1 >= w->row + w->height ||
        column + 1 >= w->column + w->width) {
        return none;
    }
    for (int k = 0; k < 4; k++) {
        if (scene->grid->cell[cell] >> k & 1 && k != p && k != q) {
            return (struct place){cell, k};
        }
    }
    return none;
}

/* The triangle on the other side of an edge. */
static struct place across(const struct scene *scene, struct place at, int edge)
{
    const uint8_t *corners = iso_cell_corners[at.left_out];
    int p = corners[(edge + 1) % 3], q = corners[(edge + 2) % 3];
    switch (1 << p | 1 << q) {
    case 1 << 0 | 1 << 1:
        return at.cell < scene->grid->stride
                   ? (struct place){at.cell, -1}
                   : with_corners(scene, at.cell - scene->grid->stride, 2, 3);
    case 1 << 2 | 1 << 3:
        return with_corners(scene, at.cell + scene->grid->stride, 0, 1);
    case 1 << 0 | 1 << 2:
        return at.cell % scene->grid->stride == 0 ? (struct place){at.cell, -1}
                                                  : with_corners(scene, at.cell - 1, 1, 3);
    case 1 << 1 | 1 << 3:
        return with_corners(scene, at.cell + 1, 0, 2);
    default: { /* the diagonal: the cell's other triangle, if it is there */
        const int other = 3 - at.left_out;
        return (struct place){at.cell, scene->grid->cell[at.cell] >> other & 1 ? other : -1};
    }
    }
}

static bool is_passed(const struct iso_grid_tracer *t, struct place at)
{
    return t->passed[at.cell] >> at.left_out & 1;
}

/* As in tracer.c: follows the level until it returns or leaves the window. */
static void walk(struct iso_grid_tracer *t, const struct scene *scene, struct place first)
{
    struct iso_tracer *curves = t->curves;
    int32_t n = curves->start[curves->n_curves];
    struct place at = first;
    bool open = false;
    while (!is_passed(t, at)) {
        t->passed[at.cell] |= (uint8_t)(1 << at.left_out);
        const struct turn turn = turn_of(scene, at);
        curves->points[n++] = cut(scene, at, turn.enters);
        const struct place next = across(scene, at, turn.leaves);
        if (next.left_out < 0) {
            curves->points[n++] = cut(scene, at, turn.leaves);
            open = true;
            break;
        }
        at = next;
    }
    curves->closed[curves->n_curves] = !open && at.cell == first.cell &&
                                       at.left_out == first.left_out;
    curves->start[++curves->n_curves] = n;
}

void iso_grid_tracer_begin(struct iso_grid_tracer *tracer, const struct iso_grid *grid,
                           const struct iso_grid_field *field)
{
    iso__grid_band_begin(&tracer->band, grid, field);
}

/* Lists the triangles of the band that a level cuts, without a branch for each, and marks them as
 * not passed. Returns how many. */
static int32_t list_cut(struct iso_grid_tracer *tracer, double level)
{
    const struct iso__grid_band *band = &tracer->band;
    int32_t n = 0;
    for (int32_t i = 0; i < band->n; i++) {
        const struct iso__grid_triangle *t = &band->triangle[i];
        tracer->passed[t->cell] = 0;
        tracer->curves->cut[n] = i;
        n += (int)(t->heat.low < level) & (int)(t->heat.high >= level);
    }
    return n;
}

int iso_grid_tracer_run(struct iso_grid_tracer *tracer, double radius_mm, double *level)
{
    const struct iso__grid_band *band = &tracer->band;
    double found;
    const int error = iso__grid_band_find(&tracer->band, radius_mm, &found);
    if (error) {
        return error;
    }
    const struct scene scene = {band->grid, band->field, found};
    const int32_t n_cut = list_cut(tracer, found);
    tracer->curves->n_curves = 0;
    tracer->curves->start[0] = 0;
    /* The first pass traces the open curves, from where they enter the window. The second pass
     * traces the loops. */
    for (int loops = 0; loops < 2; loops++) {
        for (int32_t i = 0; i < n_cut; i++) {
            const struct iso__grid_triangle *t = &band->triangle[tracer->curves->cut[i]];
            const struct place at = {t->cell, t->left_out};
            if (!is_passed(tracer, at) &&
                (loops || across(&scene, at, turn_of(&scene, at).enters).left_out < 0)) {
                walk(tracer, &scene, at);
            }
        }
    }
    *level = found;
    return tracer->curves->n_curves;
}
