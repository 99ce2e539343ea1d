/* The part of a frame about a face, at a working pitch, without outliers.
 *
 * A pixel is kept if at least 5 of its 8 neighbours lie within 8 mm of it and it lies within 6 mm
 * of the median of its 5 x 5 surroundings. The two outermost rows and columns of the part are
 * dropped. Then connected pieces of less than 30 cm^2 are dropped (flying pixels, hair).
 *
 * Some sensors report depths in coarse steps (depth_step.h). Both bounds are at least 1.25 times
 * the step, so that neighbours on a slope, which differ by a whole step, are kept. */
#ifndef ISO_CORE_SURFACE_CLEAN_H
#define ISO_CORE_SURFACE_CLEAN_H

#include "isotherm/frame.h"

struct iso_cleaner;

/* Makes a cleaner for parts of at most capacity_px pixels after shrinking. -EINVAL if that is 0,
 * -ENOMEM. */
int iso_cleaner_new(size_t capacity_px, struct iso_cleaner **out)
    __attribute__((warn_unused_result));

/* Wipes and frees it and what it holds. NULL is accepted. */
void iso_cleaner_free(struct iso_cleaner *cleaner);

/* Cuts out the square of half side radius_mm about a camera-frame point, shrinks it by the largest
 * whole factor that keeps a pixel at most pitch_mm wide (1..ISO_SHRINK_MAX), and cleans it. *out
 * belongs to the cleaner and lasts until the next call. -ENODATA if the point lies behind the
 * camera or less than 8 x 8 shrunken pixels of the square lie in the frame, -ENOSPC if the part is
 * too large. */
int iso_clean(struct iso_cleaner *cleaner, const struct iso_frame *frame, struct iso_vec3 centre_mm,
              double radius_mm, double pitch_mm, const struct iso_frame **out)
    __attribute__((warn_unused_result));

#endif
