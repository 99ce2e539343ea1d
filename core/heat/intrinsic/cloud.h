/* Further work on the triangles that iso_cloud_triangulate() (isotherm/stiffness_mass.h) makes of a
 * cloud of points: its boundary, and triangles that stand in it more than once. */
#ifndef ISO_CORE_HEAT_INTRINSIC_CLOUD_H
#define ISO_CORE_HEAT_INTRINSIC_CLOUD_H

#include "isotherm/mesh.h"

/* Finds the boundary of the surface on which the points lie. open [n_vertices] becomes 1 for a
 * point whose own triangles do not form a closed ring around it, else 0. A point's own triangles
 * have it as their first corner. Call this before iso_cloud_merge(), which removes some of them. */
void iso_cloud_boundary(const struct iso_mesh *cloud, uint8_t *open);

/* Leaves one of the triangles that have the same corners, the first one, and keeps their order.
 * -ENOMEM. */
int iso_cloud_merge(struct iso_mesh *cloud) __attribute__((warn_unused_result));

#endif
