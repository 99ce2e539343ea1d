/* The viewpoint of pictures of shapes. */
#ifndef SIM_SHAPES_DESCRIBE_SHAPE_VIEW_H
#define SIM_SHAPES_DESCRIBE_SHAPE_VIEW_H

#include "sim/lab/picture/scene.h"

/* A view from the front left and slightly above, with the whole shape in the picture. */
struct sim_view sim_shape_view(const struct iso_mesh *mesh);

#endif
