/* Time of flight as coarse recordings of a Kinect v2 show it: multipath, flying pixels, a wiggling
 * distance, and depths that come in steps of 1 to 8 mm.
 *
 * - Size, focal length and range (512 x 424, f 365 px, 0.5 to 4.5 m): Kinect for Windows SDK 2.0.
 * - Noise: Sarbolandi, Lefloch and Kolb, "Kinect Range Sensing: Structured-Light versus
 *   Time-of-Flight Kinect", CVIU 139 (2015). The standard deviation is about 1 mm at 0.8 m. It
 *   grows with the distance. It is larger where the amplitude is lower.
 * - Flying pixels: the same paper. A pixel on an outline reports a depth between the two surfaces.
 *   In this model a pixel receives light from an area of twice its breadth, so that outlines are
 *   two pixels broad. The share of such pixels that drop out is half of that in kinect2.
 * - Wiggling, a periodic error of the distance: Corti, Giancola, Mainetti and Sala, "A metrological
 *   characterization of the Kinect V2 time-of-flight camera", Robotics and Autonomous Systems 75
 *   (2016). The period is a quarter of the unambiguous range at 80 MHz, which is 1.87 m.
 * - Multipath: in a hollow, some of the light is reflected by another surface first, and arrives
 *   later. Corti and others describe it as well. Wasenmueller and Stricker measured it in corners:
 *   "Comparison of Kinect v1 and v2 depth images in terms of accuracy and precision", ACCV
 *   workshops (2016).
 * - Errors that neighbouring pixels share, because the sensor's software filters its depths. The
 *   size of these errors was chosen such that the residuals of the fit resemble those of real
 *   frames (sim/results/time-of-flight.md).
 * - Assumed: the steps (8 bits for 1 to 2 m would be steps of 4 to 8 mm), the share of multipath,
 *   and the amplitude of the wiggling. Steps and share are drawn for each recording. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "sim/world/sensor/multipath.h"
#include "sim/world/sensor/noise_plane.h"
#include "sim/world/sensor/sensor.h"
#include "sim/world/sensor/time_of_flight.h"

static const double noise_mm = 0.8, noise_distance_mm = 800.0; /* for amplitude 1 */
static const double texture_mm = 0.9, drift_mm = 0.7, offset_mm = 2.0;
static const double noise_limit_mm = 8.0; /* noisier pixels are reported as not measured */
static const double near_mm = 500.0, far_mm = 4500.0;
static const double mixed_mm = 60.0, mixed_loss = 0.35;
static const double wiggle_mm = 1.5, wiggle_period_mm = 469.0;
static const double share_least = 0.2, share_most = 0.6;

enum {
    BLUR = 1, /* samples of the view that a pixel receives besides its own, on each side */
    /* Radii of the windows in which errors are alike. */
    FILTER_PX = 1,
    TEXTURE_PX = 3,
    DRIFT_PX = 12,
    STEP_MOST_MM = 8,
};

/* The properties that stay the same during a recording. */
struct coarse {
    struct sim_multipath multipath;
    double step_mm, wiggle_phase_rad;
};

static int coarse_new(void **own)
{
    struct coarse *coarse = calloc(1, sizeof *coarse);
    if (!coarse) {
        return -ENOMEM;
    }
    /* The means, which hold until a recording begins. */
    coarse->multipath = (struct sim_multipath){0.5 * (share_least + share_most), 6.0, 4, 60.0};
    coarse->step_mm = 4.0;
    *own = coarse;
    return 0;
}

static void draw_session(void *own, struct sim_random *random)
{
    struct coarse *coarse = own;
    coarse->step_mm = 1.0 + sim_random_below(random, STEP_MOST_MM);
    coarse->wiggle_phase_rad = sim_random_between(random, 0.0, 6.283185307179586);
    coarse->multipath.share = sim_random_between(random, share_least, share_most);
}

static double wiggle(const struct coarse *coarse, double z_mm)
{
    return wiggle_mm * sin(6.283185307179586 * z_mm / wiggle_period_mm + coarse->wiggle_phase_rad);
}

/* Computes the depth of each pixel, which may be a mean of several surfaces (0: not measured), and
 * the standard deviation of its noise, mm. */
static void receive(const struct sim_view *view, struct sim_random *random, float *depth_mm,
                    float *sd_mm)
{
    const int width = view->camera.width_px / view->supersample;
    const int height = view->camera.height_px / view->supersample;
    for (int i = 0; i < width * height; i++) {
        const struct sim_mixed_pixel pixel = sim_time_of_flight_mix(view, i % width, i / width,
                                                                    BLUR);
        const double luck = sim_random_unit(random);
        const double z = pixel.depth_mm, ratio = z / noise_distance_mm;
        const double sd = noise_mm * ratio * ratio / fmax(pixel.amplitude, 1e-3);
        const bool lost = z < near_mm || z > far_mm || sd > noise_limit_mm ||
                          (pixel.spread_mm > mixed_mm && luck < mixed_loss);
        depth_mm[i] = lost ? 0.0f : (float)z;
        sd_mm[i] = (float)sd;
    }
}

static void measure(const struct sim_view *view, double noise_scale, struct sim_random *random,
                    struct sim_sensor_workspace *workspace, float *depth_mm)
{
    const struct coarse *coarse = workspace->own;
    const int width = view->camera.width_px / view->supersample;
    const int height = view->camera.height_px / view->supersample;
    float *const *plane = workspace->plane;
    float *noise = plane[1], *texture = plane[2], *drift = plane[3], *sd_mm = plane[4];
    float *late_mm = plane[5];
    sim_noise_plane(random, width, height, FILTER_PX, FILTER_PX, plane[0], noise);
    sim_noise_plane(random, width, height, TEXTURE_PX, TEXTURE_PX, plane[0], texture);
    sim_noise_plane(random, width, height, DRIFT_PX, DRIFT_PX, plane[0], drift);
    const double offset = offset_mm * sim_random_normal(random);
    receive(view, random, depth_mm, sd_mm);
    sim_multipath_errors(&coarse->multipath, depth_mm, width, height, plane[0], late_mm);
    for (int i = 0; i < width * height; i++) {
        const double z = (double)depth_mm[i];
        if (!(z > 0.0)) {
            continue;
        }
        const double error = (double)sd_mm[i] * (double)noise[i] + texture_mm * (double)texture[i] +
                             drift_mm * (double)drift[i] + offset + wiggle(coarse, z) +
                             (double)late_mm[i];
        const double steps = nearbyint((z + noise_scale * error) / coarse->step_mm);
        depth_mm[i] = (float)(coarse->step_mm * steps);
    }
}

const struct sim_sensor sim_sensor_kinect2_coarse = {
    .name = "kinect2-coarse",
    .summary = "time of flight, Kinect v2, 512x424, multipath, steps of 1 to 8 mm",
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
    .own_new = coarse_new,
    .own_free = free,
    .session = draw_session,
};
