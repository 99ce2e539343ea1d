/* What a mesh shows of itself in a direction: the area of each triangle in a parallel projection,
 * and scores of these. Internal to core/shape/describe. */
#ifndef ISO_CORE_SHAPE_DESCRIBE_VIEW_AREA_H
#define ISO_CORE_SHAPE_DESCRIBE_VIEW_AREA_H

#include "core/surface/raster.h"
#include "isotherm/signature.h"

/* A mesh in a frame of its own, and the picture of it. */
struct iso_view_area {
    const struct iso_mesh *mesh; /* borrowed */
    struct iso_vec3 centre;
    struct iso_vec3 axis[3]; /* principal axes of the surface, the longest first; right-handed */
    double radius;           /* of the sphere about the centre that contains the mesh */
    double total_area;
    double *area;             /* [n_triangles]: of the surface */
    int32_t *seen;            /* [n_triangles]: pixels */
    struct iso_vec3 *turned;  /* [n_vertices]: in the camera's frame */
    struct iso_raster raster; /* owns its planes */
};

/* -EINVAL for a mesh without area, -EDOM if its axes cannot be found, -ENOMEM. */
int iso_view_area_init(struct iso_view_area *view, const struct iso_mesh *mesh)
    __attribute__((warn_unused_result));

/* Releases what it holds. */
void iso_view_area_done(struct iso_view_area *view);

/* Draws the mesh and computes the scores of a direction, of unit length, into *out. */
void iso_view_area_score(struct iso_view_area *view, struct iso_vec3 direction,
                         struct iso_shape_view *out);

#endif
