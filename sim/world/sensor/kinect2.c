/* Time of flight: Kinect v2.
 *
 * - 512 x 424, f 365 px, 1 mm counts, 0.5 to 4.5 m: Kinect for Windows SDK 2.0.
 * - Noise and flying pixels: Sarbolandi, Lefloch and Kolb, "Kinect Range Sensing:
 *   Structured-Light versus Time-of-Flight Kinect", CVIU 139 (2015). The noise is about 1 mm at
 *   0.8 m on a bright surface that faces the sensor. It grows with the distance, and when the
 *   amplitude falls. A pixel that sees several surfaces reports the mean of their depths, weighted
 *   by amplitude, or nothing.
 * - Multipath and wiggling cause systematic errors of some millimetres: Corti, Giancola, Mainetti
 *   and Sala, "A metrological characterization of the Kinect V2 time-of-flight camera", Robotics
 *   and Autonomous Systems 75 (2016). In this model they are an offset that the whole frame shares,
 *   and a smooth error of half a millimetre over a face.
 * - Assumed: the albedos in the near infrared, and the loss of mixed pixels. */
#include <math.h>

#include "sim/world/sensor/noise_plane.h"
#include "sim/world/sensor/sensor.h"
#include "sim/world/sensor/time_of_flight.h"

static const double noise_mm = 0.8, noise_distance_mm = 800.0; /* for amplitude 1 */
static const double multipath_mm = 0.5, offset_mm = 2.0;
static const double noise_limit_mm = 8.0; /* noisier pixels are reported as not measured */
static const double near_mm = 500.0, far_mm = 4500.0;
/* Pixels whose parts are farther apart than this have no single phase and mostly drop out. */
static const double mixed_mm = 60.0, mixed_loss = 0.7;

static void measure(const struct sim_view *view, double noise_scale, struct sim_random *random,
                    struct sim_sensor_workspace *workspace, float *depth_mm)
{
    const int width = view->camera.width_px / view->supersample;
    const int height = view->camera.height_px / view->supersample;
    float *multipath = workspace->plane[1];
    sim_noise_plane(random, width, height, 14, 14, workspace->plane[0], multipath);
    const double offset = offset_mm * sim_random_normal(random);
    size_t i = 0;
    for (int row = 0; row < height; row++) {
        for (int column = 0; column < width; column++, i++) {
            const struct sim_mixed_pixel pixel = sim_time_of_flight_mix(view, column, row, 0);
            const double deviate = sim_random_normal(random), luck = sim_random_unit(random);
            const double z = pixel.depth_mm, ratio = z / noise_distance_mm;
            const double sd = noise_mm * ratio * ratio / fmax(pixel.amplitude, 1e-3);
            if (z < near_mm || z > far_mm || sd > noise_limit_mm ||
                (pixel.spread_mm > mixed_mm && luck < mixed_loss)) {
                depth_mm[i] = 0.0f;
                continue;
            }
            const double error = sd * deviate + multipath_mm * (double)multipath[i] + offset;
            depth_mm[i] = (float)(z + noise_scale * error);
        }
    }
}

const struct sim_sensor sim_sensor_kinect2 = {
    .name = "kinect2",
    .summary = "time of flight, Kinect v2, 512x424",
    .camera = {.projection = ISO_PINHOLE,
               .width_px = 512,
               .height_px = 424,
               .fx_px = 365.0,
               .fy_px = 365.0,
               .cx_px = 255.5,
               .cy_px = 211.5},
    .unit_mm = 1.0,
    .supersample = 2,
    .distance_min_mm = 700.0,
    .distance_max_mm = 1000.0,
    .infrared = {.level = 0.125, .bits = 16, .shot = 1e-5, .dark = 3e-4},
    .measure = measure,
};
