/* The calibration of a pair of cameras: the lens of each, and the pose of the right one relative to
 * the left one.
 *
 * The file, format 1, is written by `isotherm-sim calibrate`:
 *
 *   [stereo]           format = 1; pairs and rms_px: how many pictures it was made from, and the
 *                      root mean square of what is left between their corners and the model
 *   [left], [right]    width_px, height_px, fx_px, fy_px, cx_px, cy_px, k1, k2, k3, p1, p2
 *                      (distortion as in isotherm/camera.h; what is left out is 0)
 *   [right_from_left]  rx_rad, ry_rad, rz_rad (rotation vector), tx_mm, ty_mm, tz_mm:
 *                      x_right = R x_left + t
 *
 * Lines have at most 190 bytes. Left and right are as seen from behind the cameras: the left
 * camera's picture shows things farther to the right. */
#ifndef ISO_DRIVERS_STEREO_CALIBRATION_H
#define ISO_DRIVERS_STEREO_CALIBRATION_H

#include "core/base/fault.h"
#include "isotherm/camera.h"

enum iso_eye { ISO_EYE_LEFT, ISO_EYE_RIGHT, ISO_EYES };

struct iso_stereo_calibration {
    struct iso_camera camera[ISO_EYES]; /* pinhole */
    struct iso_rigid right_from_left;
    int pairs; /* 0: not known */
    double rms_px;
};

/* Distance between the two cameras. */
double iso_stereo_baseline_mm(const struct iso_stereo_calibration *calibration);

/* Whether two cameras in this pose can be used as a pair: both pinhole and sane, images of one
 * size, focal lengths within 10 % of each other, baseline 5..1000 mm, the right camera at the
 * right, and both optical axes within 0.3 rad of the perpendicular to the baseline. 0, or -EINVAL
 * with a fault. */
int iso_stereo_calibration_check(const struct iso_stereo_calibration *calibration,
                                 struct iso_fault *fault) __attribute__((warn_unused_result));

/* Parses the text of a file; `name` stands for it in faults. -EBADMSG for an unknown, repeated or
 * missing key, a bad value, another format, cameras that cannot be a pair; -ENOMEM. */
int iso_stereo_calibration_parse(const char *name, const char *text,
                                 struct iso_stereo_calibration *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Reads a file. Errors of parsing, or the errno of open and read. */
int iso_stereo_calibration_read(const char *path, struct iso_stereo_calibration *out,
                                struct iso_fault *fault) __attribute__((warn_unused_result));

/* Writes a file that reads back the same within rounding (1e-15 rad); one that could not be written
 * whole is removed. -EINVAL if the calibration fails its check, or the errno of writing. */
int iso_stereo_calibration_write(const char *path, const struct iso_stereo_calibration *calibration,
                                 struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
