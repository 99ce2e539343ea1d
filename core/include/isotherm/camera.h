/** @file
 * The camera that made a depth image: how pixels and points of space correspond.
 *
 * Camera frame: x right, y down, z forward along the optical axis, in millimetres. The centre of
 * pixel (u, v) has whole coordinates; u counts to the right, v down, both in the FULL image of the
 * sensor. A cropped frame carries its offset (frame.h), so that one camera serves every crop. */
#ifndef ISOTHERM_CAMERA_H
#define ISOTHERM_CAMERA_H

#include <stdbool.h>

#include "isotherm/fault.h"
#include "isotherm/vec.h"

/** How a camera projects points onto its image. */
enum iso_projection {
    ISO_PROJECTION_NONE = 0, /**< Not set; iso_camera_check() refuses it. */
    ISO_PINHOLE,             /**< Central projection with Brown-Conrady distortion (Brown 1971). */
    ISO_ORTHOGRAPHIC,        /**< Parallel rays, a fixed pitch per pixel. */
};

/** The intrinsic parameters of a camera. A plain value: it owns nothing and can be copied. */
struct iso_camera {
    enum iso_projection projection; /**< Which of the members below count. */
    int width_px;                   /**< Width of the full image, pixels. */
    int height_px;                  /**< Height of the full image, pixels. */
    double fx_px;                   /**< Pinhole: horizontal focal length, pixels. */
    double fy_px;                   /**< Pinhole: vertical focal length, pixels. */
    double pitch_mm;                /**< Orthographic: millimetres that one pixel spans. */
    double cx_px;                   /**< Column of the principal point, pixels. */
    double cy_px;                   /**< Row of the principal point, pixels. */
    double k1;                      /**< Pinhole: radial distortion, second order. */
    double k2;                      /**< Pinhole: radial distortion, fourth order. */
    double k3;                      /**< Pinhole: radial distortion, sixth order. */
    double p1;                      /**< Pinhole: first tangential distortion. */
    double p2;                      /**< Pinhole: second tangential distortion. */
};

/** Checks that a camera is one that can exist.
 *
 * All numbers have to be finite, and of sane size: at most 8192 pixels a side, focal length
 * 16..65536 px, pitch 0.01..100 mm, principal point within one image of the image, distortion
 * below 10.
 *
 * @param camera  The camera.
 * @param fault   If not NULL: on failure, receives a text that names the wrong quantity.
 * @return 0, or -EINVAL. */
int iso_camera_check(const struct iso_camera *camera, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/** The point of space that a pixel sees.
 *
 * Distortion is undone by fixed-point iteration (Heikkila and Silven 1997), to below 1e-4 px inside
 * the image of any camera that iso_camera_check() passes and whose distortion is one-to-one there.
 *
 * @param camera  A camera that iso_camera_check() passes.
 * @param u_px    Column in the full image, pixels; fractions are allowed.
 * @param v_px    Row in the full image, pixels.
 * @param z_mm    Depth along the optical axis, millimetres.
 * @return The point in the camera frame, millimetres. */
struct iso_vec3 iso_camera_back_project(const struct iso_camera *camera, double u_px, double v_px,
                                        double z_mm);

/** The pixel at which a point appears.
 *
 * @param camera    A camera that iso_camera_check() passes.
 * @param point_mm  The point in the camera frame, millimetres.
 * @param u_px      Receives the column in the full image, pixels.
 * @param v_px      Receives the row in the full image, pixels.
 * @return False, with the outputs untouched, if the point lies behind a pinhole camera (z <= 0). */
bool iso_camera_project(const struct iso_camera *camera, struct iso_vec3 point_mm, double *u_px,
                        double *v_px);

/** Size of a pixel in space.
 *
 * @param camera  A camera that iso_camera_check() passes.
 * @param z_mm    Depth along the optical axis, millimetres.
 * @return Millimetres that one pixel spans across the optical axis at this depth. */
double iso_camera_pixel_mm(const struct iso_camera *camera, double z_mm);

#endif
