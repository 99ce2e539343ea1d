/* Rectification: both cameras are turned by computation until their images have one plane and their
 * rows are parallel to the baseline, so that a point is in the same row of both images. */
#ifndef ISO_DRIVERS_STEREO_RECTIFICATION_H
#define ISO_DRIVERS_STEREO_RECTIFICATION_H

#include "drivers/stereo/calibration.h"

struct iso_rectification {
    struct iso_camera camera; /* of both rectified images: no distortion */
    struct iso_mat3 rectified_from_eye[ISO_EYES];
    double baseline_mm;
};

/* Computes the rectification. x runs along the baseline; z is the direction perpendicular to x that
 * is nearest to the mean of the two optical axes (Fusiello, Trucco and Verri 2000). The image has
 * the cameras' size, the principal point in its middle, and the mean of the four focal lengths,
 * rounded to a whole pixel. The calibration must have passed its check. */
struct iso_rectification iso_rectification_of(const struct iso_stereo_calibration *calibration);

/* For each pixel of an eye's rectified image, row by row, its position in the original image. x_px
 * and y_px have room for width_px * height_px. A pixel that the camera does not see gets a position
 * outside of the original image. */
void iso_rectification_map(const struct iso_rectification *rectification,
                           const struct iso_stereo_calibration *calibration, enum iso_eye eye,
                           float *x_px, float *y_px);

#endif
