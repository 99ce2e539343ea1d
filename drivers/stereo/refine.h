/* Refines disparities to a few hundredths of a pixel.
 *
 * The right image is warped onto the left one by the disparities known so far. In a window around
 * each pixel the left image L is regressed on the warped image W and its derivative W',
 *
 *     L ~ alpha + beta W + gamma W',        disparity -= gamma / beta,
 *
 * which is the step of Lucas and Kanade (1981); the gain and the offset of the window are fitted,
 * too. Each pixel of a window is warped by its own disparity. Windows therefore follow slanted
 * surfaces, and pixels of another surface do not shift the result. The correlation of L and W in
 * the window is the confidence.
 *
 * Each step is followed by a mean, weighted by confidence, over the smooth_px x smooth_px
 * neighbours of the same surface (within a pixel of disparity). Without it neighbours drift apart
 * from step to step, because each window measures the mean of its pixels. */
#ifndef ISO_DRIVERS_STEREO_REFINE_H
#define ISO_DRIVERS_STEREO_REFINE_H

#include <stdint.h>

struct iso_refine_options {
    int window_px;       /* odd, 3..31 */
    int smooth_px;       /* odd, 1..window_px: see above */
    int iterations;      /* 1..8 */
    double step_max_px;  /* a pixel that would move farther in one step stays, with confidence 0 */
    double contrast_min; /* least standard deviation of the left image in a window, grey levels */
};

struct iso_refine;

/* Makes a workspace for images of one size. -EINVAL a side is shorter than 8 px or an option is out
 * of range, -ENOMEM. */
int iso_refine_new(int width_px, int height_px, const struct iso_refine_options *options,
                   struct iso_refine **out) __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void iso_refine_free(struct iso_refine *refine);

/* Refines disparity_px of rectified images in place; 0 means that there is none, and remains 0.
 * confidence receives -1..1, and 0 where the last step was not possible. All planes are
 * [height_px * width_px]. */
void iso_refine_run(struct iso_refine *refine, const uint8_t *left, const uint8_t *right,
                    float *disparity_px, float *confidence);

#endif
