/* Structured light: Orbbec Astra and Kinect v1 (the same PrimeSense principle, nearly the same
 * optics).
 *
 * - 640 x 480, f 575.8 px: OpenNI's default for PrimeSense sensors; baseline 75 mm: Khoshelham and
 *   Elberink, "Accuracy and Resolution of Kinect Depth Data", Sensors 12 (2012).
 * - Disparity in steps of 1/8 px (the same source).
 * - Noise: the same source fits 1.42e-6 z^2 mm on planes, which is 0.061 px of disparity. This
 *   includes 0.125 / sqrt(12) = 0.036 px of the disparity steps; 0.050 px remain without them.
 *   Nguyen, Izadi and Lovell, "Modeling Kinect Sensor Noise for Improved 3D Reconstruction and
 *   Tracking" (2012) fit 1.2 mm + 1.9e-6 (z - 400 mm)^2, which is more at short distances. The 0.07
 *   px here lie between the two at 0.5 to 1 m.
 * - Outlines shift by 0.8 px (Nguyen, Izadi and Lovell 2012).
 * - Correlation window 9 x 7 px (Konolige and Mihelich, "Technical description of Kinect
 *   calibration", ROS).
 * - The projector is at the left in the image, so that shadows fall to the right of objects. */
#include "sim/world/sensor/sensor.h"
#include "sim/world/sensor/triangulation.h"

static void measure(const struct sim_view *view, double noise_scale, struct sim_random *random,
                    struct sim_sensor_workspace *workspace, float *depth_mm)
{
    static const struct sim_triangulation model = {
        .focal_px = 575.8,
        .baseline_mm = 75.0,
        .second_eye = -1,
        .window_u = 4,
        .window_v = 3,
        .noise_px = 0.07,
        .step_px = 0.125,
        .edge_px = 0.8,
        .near_mm = 350.0,
        .far_mm = 8000.0,
    };
    sim_triangulation_measure(&model, view, noise_scale, random, workspace, depth_mm);
}

const struct sim_sensor sim_sensor_astra = {
    .name = "astra",
    .summary = "structured light, Orbbec Astra / Kinect v1, 640x480",
    .camera = {.projection = ISO_PINHOLE,
               .width_px = 640,
               .height_px = 480,
               .fx_px = 575.8,
               .fy_px = 575.8,
               .cx_px = 319.5,
               .cy_px = 239.5},
    .unit_mm = 1.0,
    .supersample = 1,
    .distance_min_mm = 500.0,
    .distance_max_mm = 750.0,
    .infrared = {.level = 0.25, .bits = 10, .shot = 1e-4, .dark = 2e-3, .dots = 0.7},
    .measure = measure,
};
