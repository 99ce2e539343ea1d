/* What a cloud of points and its triangles (iso_cloud_triangulate(), isotherm/stiffness_mass.h) are
 * used for besides their matrices. */
#ifndef ISO_CORE_HEAT_INTRINSIC_CLOUD_H
#define ISO_CORE_HEAT_INTRINSIC_CLOUD_H

#include "isotherm/mesh.h"

/* Marks the points around which the triangles do not close a ring, by 1 in open [n_vertices]: the
 * boundary of the surface that the points are of. The triangles of a point, which have it as their
 * first corner, must still be in their order. */
void iso_cloud_boundary(const struct iso_mesh *cloud, uint8_t *open);

/* Leaves one of the triangles that have the same corners, the first one, and keeps their order.
 * -ENOMEM. */
int iso_cloud_merge(struct iso_mesh *cloud) __attribute__((warn_unused_result));

#endif
