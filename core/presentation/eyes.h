/* Whether a face has holes for eyes: on both sides the surface within the lids is far behind them.
 *
 * Behind a print with its eyes cut out, the sensor measures the eyes of the wearer, or whatever
 * lies behind the print. Eyes that are closed, behind glasses or not measured are no reason for
 * doubt: sensors often fail to measure eyes (wet, dark, specular). */
#ifndef ISO_CORE_PRESENTATION_EYES_H
#define ISO_CORE_PRESENTATION_EYES_H

#include "core/landmark/shape_fit.h"
#include "isotherm/frame.h"

struct iso_eye {
    double around_share; /* of places about the lids that are measured, and on the face */
    double behind_share; /* of places within the lids, measured far behind those about them */
    double hole_share;   /* of places within the lids, not measured */
    double depth_mm;     /* median of how far behind those about them: negative for a proud eye;
                            0 if nothing is measured */
};

enum { ISO_EYE_R, ISO_EYE_L, ISO_EYES };

/* Farther behind the lids than this is not an eye: its white lies 2 to 4 mm behind them. */
#define ISO_EYE_BEHIND_MM 6.0

/* Looks into the frame as it came: cleaning would take small pieces that lie behind for outliers.
 * `fit` is of the same frame or its cleaned part. */
void iso_eyes_measure(const struct iso_frame *frame, const struct iso_shape_fit *fit,
                      struct iso_eye eyes[ISO_EYES]);

#endif
