/* This file says in which order a fit stores the modes of a head model, and computes the vertices
 * of the head from coefficients. Internal to core/landmark.
 *
 * Vertices are stored in groups of ISO_SHAPE_GROUP, and modes in chunks of ISO_GRAM_LANES. What a
 * chunk moves the vertices of a group lies together, [vertex of the group][axis][mode of the
 * chunk], so that a register of any width holds as many whole rows of a chunk as it can, and all
 * of them are multiplied by the same coefficients. */
#ifndef ISO_CORE_LANDMARK_SHAPE_VERTICES_H
#define ISO_CORE_LANDMARK_SHAPE_VERTICES_H

#include <stddef.h>

#include "core/base/gram.h"

enum {
    ISO_SHAPE_GROUP = 4,
    ISO_SHAPE_AXES = 3,
    /* Floats of a chunk for one vertex and for a group. */
    ISO_SHAPE_CHUNK = ISO_SHAPE_AXES * ISO_GRAM_LANES,
    ISO_SHAPE_GROUP_CHUNK = ISO_SHAPE_GROUP * ISO_SHAPE_CHUNK,
};

/* Returns how many floats the modes of n vertices take. Each vertex has `stride` modes, a multiple
 * of ISO_GRAM_LANES. */
static inline size_t iso_shape_modes_floats(size_t n, int stride)
{
    const size_t groups = (n + ISO_SHAPE_GROUP - 1) / ISO_SHAPE_GROUP;
    return groups * ISO_SHAPE_GROUP * ISO_SHAPE_AXES * (size_t)stride;
}

/* Where the modes of the vertex at a place begin: [ISO_SHAPE_AXES][ISO_GRAM_LANES], how far the
 * first modes move it along x, y and z. Those of the next chunk lie ISO_SHAPE_GROUP_CHUNK floats
 * behind them. */
static inline size_t iso_shape_modes_of(size_t place, int stride)
{
    const size_t group = place / ISO_SHAPE_GROUP, inside = place % ISO_SHAPE_GROUP;
    return group * ISO_SHAPE_GROUP * ISO_SHAPE_AXES * (size_t)stride + inside * ISO_SHAPE_CHUNK;
}

/* Where mode k moves a vertex along x, in floats behind iso_shape_modes_of(). What it moves it
 * along y and z lies ISO_GRAM_LANES and 2 ISO_GRAM_LANES floats behind that. */
static inline size_t iso_shape_mode_at(int k)
{
    return (size_t)(k / ISO_GRAM_LANES) * ISO_SHAPE_GROUP_CHUNK + (size_t)(k % ISO_GRAM_LANES);
}

/* How far the modes move the first n vertices, mm: moved_mm [n rounded up to whole groups]
 * [ISO_SHAPE_AXES]. modes: those of the vertices; coefficient: [stride], with zeros behind the
 * modes. Both begin at multiples of ISO_GRAM_LINE bytes. Each sum has ISO_GRAM_LANES partial sums,
 * which are added in their order. The functions give the same results to the bit. */
typedef void iso_shape_vertices_function(const float *modes, int stride, const float *coefficient,
                                         int n, float (*moved_mm)[ISO_SHAPE_AXES]);

iso_shape_vertices_function iso__shape_vertices_baseline;
iso_shape_vertices_function iso__shape_vertices_avx2; /* x86-64 only */
iso_shape_vertices_function iso_shape_vertices; /* the fastest one that this machine can run */

#endif
