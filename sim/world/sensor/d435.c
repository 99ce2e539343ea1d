/* Active stereo: Intel RealSense D435.
 *
 * - 848 x 480, 90 degrees wide: f 424 px; baseline 50 mm; noise (standard deviation) z^2 s / (f b)
 *   with a subpixel error s of 0.08 px on well-textured planes, i.e. 1.36 mm at 0.6 m: Intel,
 *   "Tuning depth cameras for best performance".
 * - Disparities in steps of 1/32 px: Intel, "Subpixel linearity improvement".
 * - Assumed: errors correlate over 5 px, outlines shift by 1.2 px (stereo matching is described in
 *   Keselman et al., "Intel RealSense Stereoscopic Depth Cameras", CVPRW 2017).
 * - The left camera is the reference: surface that only it sees, at the left of objects, is not
 *   measured. */
#include "sim/world/sensor/sensor.h"
#include "sim/world/sensor/triangulation.h"

static void measure(const struct sim_view *view, double noise_scale, struct sim_random *random,
                    struct sim_sensor_workspace *workspace, float *depth_mm)
{
    static const struct sim_triangulation model = {
        .focal_px = 424.0,
        .baseline_mm = 50.0,
        .second_eye = 1,
        .window_u = 2,
        .window_v = 2,
        .noise_px = 0.08,
        .step_px = 1.0 / 32.0,
        .edge_px = 1.2,
        .near_mm = 200.0,
        .far_mm = 10000.0,
    };
    sim_triangulation_measure(&model, view, noise_scale, random, workspace, depth_mm);
}

const struct sim_sensor sim_sensor_d435 = {
    .name = "d435",
    .summary = "active stereo, Intel RealSense D435, 848x480",
    .camera = {.projection = ISO_PINHOLE,
               .width_px = 848,
               .height_px = 480,
               .fx_px = 424.0,
               .fy_px = 424.0,
               .cx_px = 423.5,
               .cy_px = 239.5},
    .unit_mm = 1.0,
    .supersample = 1,
    .distance_min_mm = 400.0,
    .distance_max_mm = 600.0,
    .infrared = {.level = 0.12, .bits = 8, .shot = 2e-4, .dark = 4e-3, .dots = 0.4},
    .measure = measure,
};
