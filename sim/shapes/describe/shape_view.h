/* Pictures of shapes: the viewpoint, and the shape in the colours of its vertices. */
#ifndef SIM_SHAPES_DESCRIBE_SHAPE_VIEW_H
#define SIM_SHAPES_DESCRIBE_SHAPE_VIEW_H

#include <cairo.h>

#include "sim/lab/picture/scene.h"
#include "sim/shapes/describe/array.h"

/* A view from the front left and slightly above, with the whole shape in the picture. */
struct sim_view sim_shape_view(const struct iso_mesh *mesh);

/* Draws a mesh in this view into a square of size_px. colour [n_vertices]. The first column of
 * `dots` has the numbers of vertices that get a white dot; NULL: none. The caller destroys the
 * picture. -ENOMEM. */
int sim_shape_picture(const struct iso_mesh *mesh, const struct sim_colour *colour,
                      const struct sim_array *dots, int size_px, cairo_surface_t **out)
    __attribute__((warn_unused_result));

#endif
