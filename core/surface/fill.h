/* Filling holes of a plane of values, and smoothing it, within a fixed domain. */
#ifndef ISO_CORE_SURFACE_FILL_H
#define ISO_CORE_SURFACE_FILL_H

#include <stdint.h>

struct iso_fill;

/* Workspace for planes of that size (1..1024 a side). -EINVAL, -ENOMEM. */
int iso_fill_new(int width, int height, struct iso_fill **out) __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void iso_fill_free(struct iso_fill *fill);

/* Gives values to the pixels of `domain` that are not `known`: from a pyramid of averages
 * (pull-push: Gortler et al. 1996), then relaxed towards the membrane through the known ones
 * (Laplace's equation). Planes are [height * width], row by row. At least one pixel must be known.
 */
void iso_fill_holes(struct iso_fill *fill, const uint8_t *domain, const uint8_t *known,
                    float *value);

/* Gaussian of sigma_px pixels (0: nothing), normalised over the domain. */
void iso_fill_smooth(struct iso_fill *fill, const uint8_t *domain, double sigma_px, float *value);

#endif
