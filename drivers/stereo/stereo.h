/* Depth from two cameras: the whole way from a pair of pictures to a depth frame.
 *
 *   rectify (rectification.h, stereo_opencv.h) -> match at half size, with the left-right check of
 *   the matcher -> first guess (coarse.h) -> refine at full size (refine.h) -> drop pixels with
 *   little confidence, hidden from the right camera by another surface, or close to an outline ->
 *   depth = f b / disparity
 *
 * Everything is made once for the size of the cameras' images; only OpenCV allocates per frame. One
 * object is used by one thread at a time. */
#ifndef ISO_DRIVERS_STEREO_STEREO_H
#define ISO_DRIVERS_STEREO_STEREO_H

#include <stdint.h>

#include "core/base/fault.h"
#include "drivers/stereo/rectification.h"
#include "isotherm/frame.h"

struct iso_stereo_options {
    double near_mm, far_mm; /* the range that is measured */
    double confidence_min;  /* least correlation of the two windows for a depth: 0..1 */
    int window_px;          /* of the refinement: odd, 3..31 */
};

/* 300 to 1200 mm, 0.75, 9 px. */
struct iso_stereo_options iso_stereo_options_default(void);

struct iso_stereo;

/* Makes the object for a pair of cameras. -EINVAL with *fault for cameras that cannot be a pair
 * (iso_stereo_calibration_check), an image with an odd side or one below 64 px, or options out of
 * range; -ENOMEM; the errors of iso_stereo_module_load. */
int iso_stereo_new(const struct iso_stereo_calibration *calibration,
                   const struct iso_stereo_options *options, struct iso_stereo **out,
                   struct iso_fault *fault) __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void iso_stereo_free(struct iso_stereo *stereo);

/* The camera of the frames and its rotation relative to the two real ones. Owned by `stereo`. */
const struct iso_rectification *iso_stereo_rectification(const struct iso_stereo *stereo);

/* Computes one frame from a pair of 8-bit pictures as the cameras gave them, both [height_px *
 * width_px]. The frame's planes have that size; its camera, crop and depths are set, and its
 * intensity (the left picture, rectified) if it has one; the caller sets time and sequence.
 * *confidence (may be NULL) is set to a plane of correlations, which belongs to the stereo object
 * and is valid until its next use. -EINVAL if the frame has another size, -ENOMEM, -EIO. */
int iso_stereo_compute(struct iso_stereo *stereo, const uint8_t *left, const uint8_t *right,
                       const float **confidence, struct iso_frame *frame)
    __attribute__((warn_unused_result));

#endif
