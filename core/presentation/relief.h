/* Whether the middle of a face has the relief of a face: cheeks and brow are curved in both
 * directions, and a nose stands 15 to 30 mm in front of them. A picture of a face, held flat, bent
 * or creased, has no such relief. */
#ifndef ISO_CORE_PRESENTATION_RELIEF_H
#define ISO_CORE_PRESENTATION_RELIEF_H

#include "core/presentation/bent_sheet.h"
#include "isotherm/frame.h"

struct iso_relief {
    int n_cells;                     /* how many cells of 6 mm were measured */
    struct iso_sheet_fit flat, bent; /* the fits to the cells' mean points, face frame */
    double nose_mm; /* how far the nose tip stands before the plane through cheeks, brow and upper
                       lip; 0 if it was not measured */
};

/* The limit of a residual. */
#define ISO_RELIEF_LIMIT_MM 4.0

/* Measures the disc of 48 mm about the origin of the face frame. The frame is a cleaned one, or any
 * other without flying pixels. The means over cells reduce the noise of the sensor to a few tenths
 * of a millimetre. The share of cells on the best sheet (bent.inlier_share) decides: faces have
 * 0.29 to 0.76 (2800 rendered frames, 370 real ones), pictures that were taken for a face 0.89 to
 * 1. -ENODATA if fewer than 60 of some 200 cells are measured, or if a plane or a sheet cannot be
 * fitted. */
int iso_relief_measure(const struct iso_frame *frame, const struct iso_rigid *camera_from_face,
                       struct iso_relief *out) __attribute__((warn_unused_result));

#endif
