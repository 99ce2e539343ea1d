/* The camera that made a depth image: how pixels and points of space correspond.
 *
 * Camera frame: x right, y down, z forward along the optical axis, millimetres. Pixel (u, v) has
 * its centre at integer coordinates, u to the right, v down, counted in the sensor's FULL image:
 * a cropped frame carries its offset (frame.h), so that one camera serves every crop of it. */
#ifndef ISOTHERM_CAMERA_H
#define ISOTHERM_CAMERA_H

#include <stdbool.h>

#include "isotherm/vec.h"

enum iso_projection {
    ISO_PROJECTION_NONE = 0,
    ISO_PINHOLE,      /* fx, fy, cx, cy, with Brown-Conrady distortion k1..k3, p1, p2 */
    ISO_ORTHOGRAPHIC, /* pitch_mm per pixel, cx, cy */
};

struct iso_camera {
    enum iso_projection projection;
    int width_px, height_px; /* the full image */
    double fx_px, fy_px;     /* pinhole: focal length */
    double pitch_mm;         /* orthographic: millimetres per pixel */
    double cx_px, cy_px;     /* principal point */
    double k1, k2, k3;       /* pinhole: radial distortion (Brown 1971) */
    double p1, p2;           /* pinhole: tangential distortion */
};

/* Whether the camera is one that could exist: finite, positive, of sane size (at most 8192 pixels a
 * side, focal length 16..65536 px, pitch 0.01..100 mm, principal point within one image of the
 * image, distortion below 10). Returns 0, or -EINVAL with *fault (if not NULL) set to a static text
 * that names the quantity at fault. */
int iso_camera_check(const struct iso_camera *camera, const char **fault)
    __attribute__((warn_unused_result));

/* The point of space seen at (u_px, v_px) with depth z_mm along the optical axis. Distortion is
 * undone by fixed-point iteration (Heikkila and Silven 1997), to below 1e-4 px inside the image of
 * any camera that iso_camera_check passes and whose distortion is one-to-one there. */
struct iso_vec3 iso_camera_back_project(const struct iso_camera *camera, double u_px, double v_px,
                                        double z_mm);

/* The pixel at which a point appears. False, with the outputs untouched, if it lies behind a
 * pinhole camera (z <= 0). */
bool iso_camera_project(const struct iso_camera *camera, struct iso_vec3 point_mm, double *u_px,
                        double *v_px);

/* Millimetres that one pixel spans across the optical axis at depth z_mm. */
double iso_camera_pixel_mm(const struct iso_camera *camera, double z_mm);

#endif
