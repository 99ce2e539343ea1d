/* The memory of a tracer. tracer.c fills it on a mesh, grid_tracer.c on a grid. Internal to
 * core/isotherm.
 *
 * A vertex counts as hot if its heat is at least the level. With this rule alone every triangle
 * that the level cuts has one edge from hot to cold and one from cold to hot (counter-clockwise),
 * even if vertices lie exactly on the level. The curve enters by the first edge and leaves by the
 * second, with the hot side on its left. */
#ifndef ISO_CORE_ISOTHERM_TRACER_STORE_H
#define ISO_CORE_ISOTHERM_TRACER_STORE_H

#include "isotherm/isotherm_curve.h"

struct iso_tracer {
    int32_t triangle_capacity;
    struct iso_vec3 *points; /* [2 triangle_capacity], curve after curve */
    int32_t *start;          /* [triangle_capacity + 1], where each curve begins in points */
    bool *closed;            /* [triangle_capacity], of each curve */
    uint8_t *passed;         /* [triangle_capacity], 1 for a triangle of a mesh that is traced */
    int32_t *cut;            /* [triangle_capacity], the triangles of a mesh that the level cuts */
    int32_t n_curves;
};

#endif
