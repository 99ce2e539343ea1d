/* Disparities to a few hundredths of a pixel.
 *
 * The right image is warped onto the left one by the disparities known so far; in a window about
 * each pixel the left image is regressed on the warped one and its derivative,
 *
 *     L ~ alpha + beta W + gamma W',        disparity -= gamma / beta,
 *
 * which is the step of Lucas and Kanade (1981) with the window's gain and offset fitted along with
 * it. Since each pixel of a window is warped by its own disparity, windows lie flat on slanted
 * surfaces, and pixels of another surface pull nothing out of place. The correlation of L and W in
 * the window is the confidence.
 *
 * Each step is followed by a mean, weighted by confidence, over the smooth_px x smooth_px
 * neighbours of the same surface (within a pixel of disparity): left alone, neighbours drift apart
 * from step to step, since what each window measures is the mean of them. */
#ifndef ISO_DRIVERS_STEREO_REFINE_H
#define ISO_DRIVERS_STEREO_REFINE_H

#include <stdint.h>

struct iso_refine_options {
    int window_px;       /* odd, 3..31 */
    int smooth_px;       /* odd, 1..window_px: see below */
    int iterations;      /* 1..8 */
    double step_max_px;  /* a pixel that moves farther in one step keeps its confidence 0 */
    double contrast_min; /* least standard deviation of the left image in a window, grey levels */
};

struct iso_refine;

/* A workspace for images of one size. -EINVAL, -ENOMEM. */
int iso_refine_new(int width_px, int height_px, const struct iso_refine_options *options,
                   struct iso_refine **out) __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void iso_refine_free(struct iso_refine *refine);

/* Refines disparity_px (0: none, stays so) of rectified images; confidence is -1..1, 0 where there
 * is none. All planes are [height_px * width_px]. */
void iso_refine_run(struct iso_refine *refine, const uint8_t *left, const uint8_t *right,
                    float *disparity_px, float *confidence);

#endif
