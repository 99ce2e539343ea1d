/* The geometry of the Texas 3D Face Recognition Database (3DFRD).
 *
 * - Range images of 501 x 751 pixels, 0.32 mm apart, orthographic, 8 bits, background 0, made with
 *   an MU-2 stereo system: Gupta, Castleman, Markey and Bovik, "Texas 3D Face Recognition
 *   Database", SSIAI 2010.
 * - Assumed: a level is 0.4 mm, so that 255 of them hold a face from the nose tip to the temples;
 *   noise of a studio stereo rig, 0.25 mm, smooth over about 3 mm. Levels stand on an offset,
 *   because recordings hold depths from a camera. */
#include "sim/world/sensor/noise_plane.h"
#include "sim/world/sensor/sensor.h"

static const double level_mm = 0.4, noise_mm = 0.25;
static const double cosine_min = 0.2;

enum { LEVELS = 255, NOISE_RADIUS_PX = 4 };

static double nearest_mm(const struct sim_view *view, size_t n)
{
    double nearest = 1e9;
    for (size_t i = 0; i < n; i++) {
        if (view->depth_mm[i] > 0.0f) {
            nearest = fmin(nearest, (double)view->depth_mm[i]);
        }
    }
    return nearest;
}

static void measure(const struct sim_view *view, double noise_scale, struct sim_random *random,
                    struct sim_sensor_workspace *workspace, float *depth_mm)
{
    float *noise = workspace->plane[1];
    const double farthest = nearest_mm(view, workspace->n_pixels) + LEVELS * level_mm;
    sim_noise_plane(random, view->camera.width_px, view->camera.height_px, NOISE_RADIUS_PX,
                    NOISE_RADIUS_PX, workspace->plane[0], noise);
    for (size_t i = 0; i < workspace->n_pixels; i++) {
        const double z = (double)view->depth_mm[i];
        const bool seen = z > 0.0 && z < farthest && (double)view->cosine[i] > cosine_min &&
                          view->material[i] == SIM_SKIN;
        depth_mm[i] = seen ? (float)(z + noise_scale * noise_mm * (double)noise[i]) : 0.0f;
    }
}

const struct sim_sensor sim_sensor_texas = {
    .name = "texas",
    .summary = "studio stereo in the Texas 3DFRD geometry, orthographic, 501x751",
    .camera = {.projection = ISO_ORTHOGRAPHIC,
               .width_px = 501,
               .height_px = 751,
               .pitch_mm = 0.32,
               .cx_px = 250.0,
               .cy_px = 375.0},
    .unit_mm = 0.4,
    .supersample = 1,
    .face_only = true,
    .distance_min_mm = 600.0,
    .distance_max_mm = 600.0,
    .infrared = {.level = 0.9, .bits = 8, .shot = 5e-5, .dark = 4e-3, .ambient = true},
    .measure = measure,
};
