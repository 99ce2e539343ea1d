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
    double around_share; /* share of the places about the lids that are measured on the face */
    double behind_share; /* share of the places within the lids that lie more than
                            ISO_EYE_BEHIND_MM behind those about the lids */
    double hole_share;   /* share of the places within the lids that are not measured */
    double depth_mm;     /* median of how far the places within the lids lie behind those about
                            them; negative for an eye that stands out; 0 if none is measured */
};

enum { ISO_EYE_R, ISO_EYE_L, ISO_EYES };

/* A surface that lies farther behind the lids than this is not an eye. The white of an eye lies 2
 * to 4 mm behind the lids. */
#define ISO_EYE_BEHIND_MM 6.0

/* Measures both eyes in the original frame, because cleaning would remove small pieces that lie
 * behind the lids as outliers. `fit` is the fit to the same frame or to its cleaned part. */
void iso_eyes_measure(const struct iso_frame *frame, const struct iso_shape_fit *fit,
                      struct iso_eye eyes[ISO_EYES]);

#endif
