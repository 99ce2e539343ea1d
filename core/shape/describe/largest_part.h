/* The part of a mesh that becomes a shape: the component of the largest area. Components are
 * triangles that have area and share vertices. */
#ifndef ISO_CORE_SHAPE_DESCRIBE_LARGEST_PART_H
#define ISO_CORE_SHAPE_DESCRIBE_LARGEST_PART_H

#include <stdbool.h>

#include "isotherm/mesh.h"

/* What iso_shape_new() takes of a mesh, and what it leaves out. */
struct iso_part_survey {
    int32_t n_vertices, n_triangles; /* of the part */
    double area;                     /* of the part */
    int32_t n_parts;                 /* all parts with area */
    int32_t vertices_left_out;       /* of other parts, or of no triangle with area */
    int32_t flat_triangles;          /* without area, of any part */
    double area_left_out;            /* of the other parts */
};

/* Surveys a mesh that iso_mesh_check() passes. All counts of the part are 0 for a mesh without
 * area. -ENOMEM. */
int iso_part_survey(const struct iso_mesh *mesh, struct iso_part_survey *out)
    __attribute__((warn_unused_result));

/* Whether a triangle has area: more than 1e-8 of the square of its longest edge. */
bool iso_triangle_has_area(const struct iso_mesh *mesh, int32_t t);

/* Finds the component of the largest area. parent [n_vertices] becomes a forest, for
 * iso_part_root(), and area [n_vertices] the area of each component at its root. Returns the root
 * of the largest component, or -1 for a mesh without area. */
int32_t iso_largest_part(const struct iso_mesh *mesh, int32_t *parent, double *area);

/* The root vertex of the component of v. Shortens the path to the root on the way. */
int32_t iso_part_root(int32_t *parent, int32_t v);

#endif
