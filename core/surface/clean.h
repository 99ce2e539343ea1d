/* The part of a frame about a face, at a working pitch, without outliers.
 *
 * A pixel is kept if at least 5 of its 8 neighbours lie within 8 mm of it and it lies within 6 mm
 * of the median of its 5 x 5 surroundings; pieces of less than 30 cm^2 are then dropped (flying
 * pixels, strands of hair). */
#ifndef ISO_CORE_SURFACE_CLEAN_H
#define ISO_CORE_SURFACE_CLEAN_H

#include "isotherm/frame.h"

struct iso_cleaner;

/* Works on frames whose cleaned part has at most capacity_px pixels. -EINVAL, -ENOMEM. */
int iso_cleaner_new(size_t capacity_px, struct iso_cleaner **out)
    __attribute__((warn_unused_result));

/* Wipes and frees it and what it holds. NULL is accepted. */
void iso_cleaner_free(struct iso_cleaner *cleaner);

/* Cuts out the square of half side radius_mm about a camera-frame point, shrunk by the largest
 * whole factor that keeps a pixel at most pitch_mm wide, and cleans it. The result belongs to the
 * cleaner and lasts until the next call. -ENODATA if the square misses the frame, -ENOSPC if the
 * part is too large. */
int iso_clean(struct iso_cleaner *cleaner, const struct iso_frame *frame, struct iso_vec3 centre_mm,
              double radius_mm, double pitch_mm, const struct iso_frame **out)
    __attribute__((warn_unused_result));

#endif
