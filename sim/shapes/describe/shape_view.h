/* Pictures of shapes: the viewpoint, and the shape in the colours of its vertices. */
#ifndef SIM_SHAPES_DESCRIBE_SHAPE_VIEW_H
#define SIM_SHAPES_DESCRIBE_SHAPE_VIEW_H

#include <cairo.h>

#include "sim/lab/picture/scene.h"
#include "sim/shapes/describe/array.h"

/* A view from the front left and slightly above, with the whole shape in the picture. */
struct sim_view sim_shape_view(const struct iso_mesh *mesh);

/* The same from another direction, which is the way to the viewer, of unit length. The y axis of
 * the mesh is upright. */
struct sim_view sim_shape_view_from(const struct iso_mesh *mesh, struct iso_vec3 direction);

/* Draws a mesh in a view into a square of size_px, without colours. The caller destroys the
 * picture. -ENOMEM. */
int sim_shape_picture_from(const struct iso_mesh *mesh, const struct sim_view *view, int size_px,
                           cairo_surface_t **out) __attribute__((warn_unused_result));

/* Copies a mesh, and turns its triangles so that the viewer of the first view sees their front: for
 * clouds, whose triangles have no common orientation. Free it with iso_mesh_free(). -ENOMEM. */
int sim_shape_face_viewer(const struct iso_mesh *mesh, struct iso_mesh **out)
    __attribute__((warn_unused_result));

/* The triangles by which a cloud of points is drawn: those of each point and its neighbours
 * (isotherm/stiffness_mass.h; 0: ISO_CLOUD_NEIGHBOURS), turned to the viewer of the first view. The
 * vertices are the points. Free it with iso_mesh_free(). -EINVAL for neighbours; -ENOMEM. */
int sim_shape_cloud_surface(const struct iso_mesh *points, int32_t neighbours,
                            struct iso_mesh **out) __attribute__((warn_unused_result));

/* Draws a mesh in the first view into a square of size_px. colour [n_vertices]. The first column of
 * `dots` has the numbers of vertices that get a white dot; NULL: none. The caller destroys the
 * picture. -ENOMEM. */
int sim_shape_picture(const struct iso_mesh *mesh, const struct sim_colour *colour,
                      const struct sim_array *dots, int size_px, cairo_surface_t **out)
    __attribute__((warn_unused_result));

#endif
