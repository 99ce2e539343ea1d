/* The triangles around one point of a cloud. The point and its nearest neighbours are projected
 * into the plane that fits them best, and their Delaunay triangulation is taken there (Sharp and
 * Crane 2020, section 5.7). Internal to core/heat/intrinsic. */
#ifndef ISO_CORE_HEAT_INTRINSIC_STAR_H
#define ISO_CORE_HEAT_INTRINSIC_STAR_H

#include "core/heat/intrinsic/nearest.h"

/* A neighbour in the tangent plane, after an inversion about the centre. */
struct iso_spot {
    double x, y;
    int32_t point;
};

/* The working memory of one star. */
struct iso_star {
    int n_found;                 /* neighbours */
    struct iso_neighbour *found; /* [neighbours] */
    struct iso_spot *spot;       /* [neighbours] */
    struct iso_spot *hull;       /* [2 neighbours]: corners of the convex hull of the spots */
    int n_corners;               /* of the hull */
    int32_t (*triangle)[3];      /* [neighbours]: the result; the first corner is the centre */
    int n_triangles;
};

/* Makes the memory for stars of at most so many neighbours. -ENOMEM. */
int iso_star_init(struct iso_star *star, int32_t neighbours) __attribute__((warn_unused_result));

/* Releases what it holds. */
void iso_star_done(struct iso_star *star);

/* Finds the triangles around a point. star->found has its neighbours, which are elsewhere.
 *
 * weight [points] makes the triangulation unique where four points or more are on one circle: that
 * of the squares of all distances plus small weights. Stars of different points then agree with
 * each other. The triangles are in their order around the point, counter-clockwise seen from one
 * side; each begins at the edge where the one before ends, unless there is a gap. -EDOM if the
 * plane cannot be computed, -ENOMEM. */
int iso_star_find(struct iso_star *star, const struct iso_vec3 *point, const double *weight,
                  int32_t centre) __attribute__((warn_unused_result));

#endif
