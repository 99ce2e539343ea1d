#include "sim/world/stereo/rig.h"

static struct iso_stereo_calibration built(void)
{
    /* Lenses with some barrel distortion; cameras mounted with a few milliradians of error. */
    return (struct iso_stereo_calibration){
        .camera = {{.projection = ISO_PINHOLE,
                    .width_px = 1280,
                    .height_px = 800,
                    .fx_px = 899.2,
                    .fy_px = 899.6,
                    .cx_px = 644.1,
                    .cy_px = 395.3,
                    .k1 = -0.11,
                    .k2 = 0.06,
                    .p1 = 0.0006,
                    .p2 = -0.0004},
                   {.projection = ISO_PINHOLE,
                    .width_px = 1280,
                    .height_px = 800,
                    .fx_px = 900.9,
                    .fy_px = 900.3,
                    .cx_px = 636.7,
                    .cy_px = 402.2,
                    .k1 = -0.105,
                    .k2 = 0.055,
                    .p1 = -0.0003,
                    .p2 = 0.0005}},
        .right_from_left = {iso_mat3_rotation(iso_vec3(0.003, -0.006, 0.002)), {-60.0, 0.3, -0.4}},
    };
}

/* The errors that remain after a calibration, in proportion to `error`. The baseline's length is
 * only as exact as the board's print. */
static struct iso_stereo_calibration believed(double error)
{
    struct iso_stereo_calibration c = built();
    struct iso_mat3 turn = iso_mat3_rotation(iso_scale(error, iso_vec3(3e-5, 3e-5, -2e-5)));
    for (int eye = 0; eye < ISO_EYES; eye++) {
        const double sign = eye == ISO_EYE_LEFT ? 1.0 : -1.0;
        c.camera[eye].fx_px += 0.1 * error * sign;
        c.camera[eye].fy_px -= 0.1 * error * sign;
        c.camera[eye].cx_px += 0.1 * error;
        c.camera[eye].cy_px -= 0.1 * error * sign;
        c.camera[eye].k1 += 0.001 * error;
    }
    c.right_from_left.rotation = iso_mat3_mul(&turn, &c.right_from_left.rotation);
    c.right_from_left.translation_mm = iso_scale(1.0 + 2e-4 * error,
                                                 c.right_from_left.translation_mm);
    return c;
}

struct sim_stereo_rig sim_stereo_rig(double calibration_error)
{
    return (struct sim_stereo_rig){
        .built = built(),
        .believed = believed(calibration_error),
        .projector_mm = {25.0, 0.0, 0.0},
        .dots = true,
        .dots_key = UINT64_C(0x5eed0fd075),
        .dot_spacing = 0.0085, /* some 11,000 dots in view; an Intel D435 has 5000 in a wider one */
        .dot_radius = 0.0014,
        .flood_share = 0.25,
        .scatter_mm = 0.7, /* assumed: skin at 850 nm */
        .scatter_share = 0.4,
        .full_well_e = 6000.0, /* assumed: a pixel of 3 um */
        .read_noise_e = 6.0,
        .right_gain = 0.94,
        .samples = 2,
    };
}
