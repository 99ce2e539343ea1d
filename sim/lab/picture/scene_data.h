/* The data of a scene. Internal to sim/lab/picture. */
#ifndef SIM_LAB_PICTURE_SCENE_DATA_H
#define SIM_LAB_PICTURE_SCENE_DATA_H

#include "sim/lab/picture/scene.h"

struct sim_scene {
    const struct iso_mesh *mesh;
    struct sim_canvas *canvas;
    struct iso_rigid camera_from_face;
    struct iso_raster raster;     /* one pixel for each sample of the canvas */
    struct iso_vec3 *vertices_mm; /* camera frame */
    struct iso_vec3 *normals;     /* camera frame, outward, of unit length */
};

/* Interpolates a vector of the vertices, such as the normal, at a sample that shows the triangle.
 */
struct iso_vec3 sim_scene_interpolate(const struct sim_scene *scene, long sample, int32_t triangle,
                                      const struct iso_vec3 *values);

#endif
