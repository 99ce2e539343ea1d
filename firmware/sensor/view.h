/* What the sensor sees, in words and numbers, for the person who installs or aims it. It describes
 * where a face is and how well it was measured. It contains nothing that tells one face from
 * another: no template, no landmark, no shape. */
#ifndef ISO_FIRMWARE_SENSOR_VIEW_H
#define ISO_FIRMWARE_SENSOR_VIEW_H

#include <stdbool.h>

#include "firmware/recognise/track.h"
#include "isotherm/extract.h"

struct iso_view {
    enum iso_capture capture;

    bool posed;                            /* if something like a face is there: */
    double right_mm, down_mm, distance_mm; /* of the nose tip, from the sensor's axis */
    double yaw_rad, pitch_rad, roll_rad;   /* as in iso_extraction */

    bool fitted;         /* if the head model was fitted to it: */
    double residual_mm;  /* distance of the measured surface from the fitted one */
    double fit_coverage; /* share of the visible fitted face that was measured, 0..1 */
    double coverage;     /* measured share of the face patch, 0..1; 0: not computed */
    double sigma_mm;     /* of the least certain landmark */
    double expression;   /* strength in standard deviations */

    bool tracked;       /* if there is an earlier frame to compare with: */
    double mm_s, rad_s; /* speed */
};

/* Makes the view of a frame. `capture` is the final word for the frame. `motion` is the result of
 * track.h for it (all zero without a fitted face). */
struct iso_view iso_view_of(const struct iso_extraction *extraction, enum iso_capture capture,
                            const struct iso_track_motion *motion);

#endif
