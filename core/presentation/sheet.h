/* The nearest object of a scene, and whether it is a sheet or a plate that somebody holds up.
 *
 * A photograph or a display rarely leads to a fitted face. If no face was found, this says whether
 * the object may be a picture of one. The object is a connected part of a coarse frame. Steps of
 * depth end it; holes do not, because often only the rim of a display is measured. */
#ifndef ISO_CORE_PRESENTATION_SHEET_H
#define ISO_CORE_PRESENTATION_SHEET_H

#include "core/presentation/bent_sheet.h"
#include "isotherm/frame.h"

struct iso_sheet {
    double area_mm2;     /* area of its measured pixels, as seen from the camera */
    double distance_mm;  /* mean depth */
    double border_share; /* share of its outermost pixels in rows and columns that lie on the
                            border of the image */
    double hole_share;   /* share of the pixels that lie between pixels of the object, in their row
                            and in their column, and are not measured */
    double limit_mm;     /* limit of the residuals; grows with distance, as noise does */
    struct iso_sheet_fit flat, bent;
};

struct iso_sheet_finder;

/* Makes a finder for frames of at most capacity_px pixels. -EINVAL, -ENOMEM. */
int iso_sheet_finder_new(size_t capacity_px, struct iso_sheet_finder **out)
    __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void iso_sheet_finder_free(struct iso_sheet_finder *finder);

/* Finds the part with the least mean depth among the parts between two depths that have at least 60
 * cm^2. If it is larger than held_max_mm2, nobody can hold it: only its plane is fitted, and `bent`
 * and the shares of border and holes are 0. -ENOENT if there is none or no sheet can be fitted to
 * it, -ENOSPC over the finder's capacity. */
int iso_sheet_find(struct iso_sheet_finder *finder, const struct iso_frame *coarse, double near_mm,
                   double far_mm, double held_max_mm2, struct iso_sheet *out)
    __attribute__((warn_unused_result));

#endif
