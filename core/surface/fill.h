/* Filling holes of a plane of values, and smoothing it, within a fixed domain. */
#ifndef ISO_CORE_SURFACE_FILL_H
#define ISO_CORE_SURFACE_FILL_H

#include <stdint.h>

struct iso_fill;

/* Makes a workspace for planes of this size, 1..1024 pixels a side, with values in `domain`
 * ([height * width], 1 inside, not needed afterwards), which are smoothed with a Gaussian of
 * sigma_px pixels (0: not at all). -EINVAL, -ENOMEM. */
int iso_fill_new(int width, int height, const uint8_t *domain, double sigma_px,
                 struct iso_fill **out) __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void iso_fill_free(struct iso_fill *fill);

/* Gives values to the pixels of the domain that are not `known`. They come from a pyramid of
 * averages (pull-push: Gortler et al. 1996) and are then relaxed towards the membrane through the
 * known pixels (Laplace's equation). Pixels outside the domain become 0. Planes are
 * [height * width], row by row. At least one pixel of the domain must be known. */
void iso_fill_holes(struct iso_fill *fill, const uint8_t *known, float *value);

/* Smooths `value` in place with the Gaussian, normalised over the domain. A sigma of 0 changes
 * nothing. Else pixels outside the domain become 0. */
void iso_fill_smooth(struct iso_fill *fill, float *value);

#endif
