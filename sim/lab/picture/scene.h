/* Paints a mesh on a canvas as a camera sees it: visibility, shading, curves, dots. */
#ifndef SIM_LAB_PICTURE_SCENE_H
#define SIM_LAB_PICTURE_SCENE_H

#include <stdbool.h>

#include "core/surface/raster.h"
#include "isotherm/mesh.h"
#include "sim/lab/draw/canvas.h"

/* The viewpoint on a face. */
struct sim_view {
    double yaw_rad,
        pitch_rad; /* of the viewer about the face; > 0 shows more of its left side, of its top */
    struct iso_vec3 centre_mm; /* face frame: the point in the middle of the picture; 0: nose tip */
    double distance_mm;        /* of the viewer from the centre */
    double height_mm;          /* the height of the picture at the centre's distance */
};

struct sim_scene;

/* Finds the visible part of the mesh (face frame) for each sample of a canvas. The mesh and the
 * canvas are borrowed, not copied. -EINVAL for a mesh without triangles, -ENOMEM. */
int sim_scene_new(const struct iso_mesh *mesh, const struct sim_view *view,
                  struct sim_canvas *canvas, struct sim_scene **out)
    __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void sim_scene_free(struct sim_scene *scene);

/* The appearance of the surface. */
struct sim_surface_style {
    struct sim_colour base;
    const struct sim_colour *vertex; /* [n_vertices] colours instead of base, or NULL */
    /* [n_vertices] opacity over the background. It is clipped to 0..1 only after interpolation,
     * so that an edge drawn by it is smooth. NULL: 1. */
    const float *opacity;
    bool edges; /* draw the triangles' edges */
};

/* Shades the visible part: three lights, sky light with ambient occlusion, a soft highlight.
 * -ENOMEM. */
int sim_scene_shade(const struct sim_scene *scene, const struct sim_surface_style *style)
    __attribute__((warn_unused_result));

/* Draws a smooth closed curve through points on the surface (face frame; Catmull and Rom 1974),
 * hidden where the surface is in front of it. Parts next to points of weight 0 are left out. */
void sim_scene_curve(const struct sim_scene *scene, const struct iso_vec3 *points_mm,
                     const float *weight, int n, struct sim_colour colour, double width_px);

/* Draws a dot with a dark rim, hidden in the same way. */
void sim_scene_dot(const struct sim_scene *scene, struct iso_vec3 point_mm,
                   struct sim_colour colour, double radius_px);

#endif
