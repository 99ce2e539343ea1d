/* Fine structured light at arm's length: the class of Apple's TrueDepth.
 *
 * Its maker has not published a noise model. Known from Breitbarth et al., "Measurement accuracy
 * and dependence on external influences of the iPhone X TrueDepth sensor", Proc. SPIE 11144
 * (2019): "accuracies in the millimeter range". Assumed here: 640 x 480, f 600 px, baseline 27
 * mm; 0.4 mm of noise at 0.4 m, which is 0.040 px of disparity, smooth over 5 px; steps of 1/64
 * px; counts of 0.1 mm. */
#include "sim/world/sensor/sensor.h"
#include "sim/world/sensor/triangulation.h"

static void measure(const struct sim_view *view, double noise_scale, struct sim_random *random,
                    struct sim_sensor_workspace *workspace, float *depth_mm)
{
    static const struct sim_triangulation model = {
        .focal_px = 600.0,
        .baseline_mm = 27.0,
        .second_eye = -1,
        .window_u = 2,
        .window_v = 2,
        .noise_px = 0.040,
        .step_px = 1.0 / 64.0,
        .edge_px = 0.6,
        .near_mm = 150.0,
        .far_mm = 3000.0,
    };
    sim_triangulation_measure(&model, view, noise_scale, random, workspace, depth_mm);
}

const struct sim_sensor sim_sensor_truedepth = {
    .name = "truedepth",
    .summary = "fine structured light, the class of TrueDepth, 640x480",
    .camera = {.projection = ISO_PINHOLE,
               .width_px = 640,
               .height_px = 480,
               .fx_px = 600.0,
               .fy_px = 600.0,
               .cx_px = 319.5,
               .cy_px = 239.5},
    .unit_mm = 0.1,
    .supersample = 1,
    .distance_min_mm = 300.0,
    .distance_max_mm = 500.0,
    .infrared = {.level = 0.1, .bits = 10, .shot = 5e-5, .dark = 1e-3},
    .measure = measure,
};
