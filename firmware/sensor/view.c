#include "firmware/sensor/view.h"

#include <math.h>

static double worst_sigma(const struct iso_extraction *extraction)
{
    double worst_mm = 0.0;
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        worst_mm = fmax(worst_mm, extraction->sigma_mm[l]);
    }
    return worst_mm;
}

struct iso_view iso_view_of(const struct iso_extraction *extraction, enum iso_capture capture,
                            const struct iso_track_motion *motion)
{
    const struct iso_vec3 nose_mm = extraction->camera_from_face.translation_mm;
    struct iso_view view = {.capture = capture};
    /* A frame without a candidate leaves the pose all zero, and no face is at the sensor itself. */
    if (nose_mm.z != 0.0) {
        view.posed = true;
        view.right_mm = nose_mm.x;
        view.down_mm = nose_mm.y;
        view.distance_mm = nose_mm.z;
        view.yaw_rad = extraction->yaw_rad;
        view.pitch_rad = extraction->pitch_rad;
        view.roll_rad = extraction->roll_rad;
    }
    if (extraction->fitted) {
        view.fitted = true;
        view.residual_mm = extraction->residual_mm;
        view.fit_coverage = extraction->fit_coverage;
        view.coverage = extraction->coverage;
        view.sigma_mm = worst_sigma(extraction);
        view.expression = extraction->expression_norm;
    }
    if (motion->known) {
        view.tracked = true;
        view.mm_s = motion->mm_s;
        view.rad_s = motion->rad_s;
    }
    return view;
}
