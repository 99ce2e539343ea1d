/* The functions of OpenCV that the stereo path uses: resampling an image through a map, and
 * semi-global matching (Hirschmueller 2008; OpenCV's StereoSGBM, which sums five directions in one
 * pass over Birchfield-Tomasi costs). The .cc file is C++, this header is C; no exception leaves
 * it. The code is in the module `stereo` (stereo_module.h).
 *
 * OpenCV's own threads are switched off for the whole process: its parallel code runs in the
 * caller's thread. */
#ifndef ISO_DRIVERS_STEREO_STEREO_OPENCV_H
#define ISO_DRIVERS_STEREO_STEREO_OPENCV_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

struct iso_stereo_opencv;

struct iso_stereo_opencv_options {
    int width_px, height_px;                /* of one image; both even */
    const float *map_x_px[2], *map_y_px[2]; /* [height_px * width_px], of each eye; copied */
    int disparity_min_px, disparity_max_px; /* searched, in pixels of the whole image */
};

/* -EINVAL for a size below 64 or odd, or a range that is empty or over 1024 wide; -ENOMEM; the
 * errors of iso_stereo_module_load. */
int iso_stereo_opencv_new(const struct iso_stereo_opencv_options *options,
                          struct iso_stereo_opencv **out) __attribute__((warn_unused_result));

/* Frees it. NULL is accepted. */
void iso_stereo_opencv_free(struct iso_stereo_opencv *stereo);

/* Resamples (bilinearly) an image of the left eye (0) or the right one (1); a pixel that lies
 * outside of the image becomes 0. Both images are [height_px * width_px]. -ENOMEM, -EIO. */
int iso_stereo_opencv_rectify(struct iso_stereo_opencv *stereo, int eye, const uint8_t *image,
                              uint8_t *rectified) __attribute__((warn_unused_result));

/* Matches rectified images at half their size. disparity_px is [height_px/2 * width_px/2]: column
 * in the left image minus column in the right one, in pixels of the WHOLE image, 0 where there is
 * none (no unique match, left and right disagree by more than one half-size pixel, or a speckle).
 * -ENOMEM, -EIO. */
int iso_stereo_opencv_match(struct iso_stereo_opencv *stereo, const uint8_t *left,
                            const uint8_t *right, float *disparity_px)
    __attribute__((warn_unused_result));

#ifdef __cplusplus
}
#endif
#endif
