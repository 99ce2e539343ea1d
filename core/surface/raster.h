/* Z-buffered rasterising of triangles into a plane of depths. */
#ifndef ISO_CORE_SURFACE_RASTER_H
#define ISO_CORE_SURFACE_RASTER_H

#include <stdint.h>

#include "isotherm/camera.h"

/* The plane that is drawn into: a window of the camera's image, as in iso_frame. Depth 0 is empty.
 * `triangle` and `weight` may be NULL; else they say what is seen: index of the triangle (set to -1
 * by iso_raster_clear) and barycentric weights of its second and third corner, perspective-correct.
 */
struct iso_raster {
    struct iso_camera camera; /* distortion is ignored */
    int width_px, height_px, crop_x_px, crop_y_px;
    float *depth_mm;    /* [height_px * width_px] */
    int32_t *triangle;  /* the same, or NULL */
    float (*weight)[2]; /* the same, or NULL */
};

void iso_raster_clear(const struct iso_raster *raster);

/* Draws triangles given by camera-frame vertices. A pixel is covered if its centre is inside;
 * nearer wins. Triangles with a corner at z < near_mm are left out. Only those facing the camera
 * are drawn if `cull` (counter-clockwise seen from outside in a right-handed frame). The index
 * written is first_index + i. */
void iso_raster_triangles(const struct iso_raster *raster, const struct iso_vec3 *vertices_mm,
                          const uint32_t (*triangles)[3], int32_t n_triangles, int32_t first_index,
                          double near_mm, int cull);

#endif
