/* Z-buffered rasterising of triangles into a plane of depths. */
#ifndef ISO_CORE_SURFACE_RASTER_H
#define ISO_CORE_SURFACE_RASTER_H

#include <stdint.h>

#include "isotherm/camera.h"

/* The planes that are drawn into: a window of the camera's image, as in iso_frame. Depth 0 is
 * empty. `triangle` is the index of the triangle that a pixel sees, -1 for none. `weight` has the
 * perspective-correct barycentric weights of its second and third corner at that pixel. */
struct iso_raster {
    struct iso_camera camera; /* distortion is ignored */
    int width_px, height_px, crop_x_px, crop_y_px;
    float *depth_mm;    /* [height_px * width_px] */
    int32_t *triangle;  /* of the same shape, or NULL */
    float (*weight)[2]; /* of the same shape, or NULL */
};

/* Sets all depths to 0 and all triangles to -1. */
void iso_raster_clear(const struct iso_raster *raster);

/* Draws a triangle given by its camera-frame corners. It covers the pixels whose centres lie in it;
 * each pixel keeps the nearest triangle. A triangle with a corner at z < near_mm or z <= 0 is left
 * out. If `cull` is not 0, it is drawn only if it faces the camera (counter-clockwise seen from the
 * camera). */
void iso_raster_triangle(const struct iso_raster *raster, const struct iso_vec3 corners_mm[3],
                         int32_t index, double near_mm, int cull);

/* Draws triangles given by camera-frame vertices, each as iso_raster_triangle() does. Triangle i
 * gets the index first_index + i. */
void iso_raster_triangles(const struct iso_raster *raster, const struct iso_vec3 *vertices_mm,
                          const uint32_t (*triangles)[3], int32_t n_triangles, int32_t first_index,
                          double near_mm, int cull);

#endif
