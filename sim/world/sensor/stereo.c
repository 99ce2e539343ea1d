/* A pair of cameras: renders both pictures and matches them with the product's own stereo code
 * (drivers/stereo), with the calibration error of a real pair.
 *
 * - 1280 x 800, f 900 px (71 degrees wide), baseline 60 mm: a pixel of disparity is 6.7 mm at
 *   0.6 m. sim/world/stereo/rig.c has the other constants.
 * - There is no noise model: errors are those of the matching, and
 *   tests/sim/world/test_stereo_sensor.c measures them. noise_scale multiplies the noise of the
 *   pictures. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/stereo/stereo.h"
#include "drivers/stereo/stereo_module.h"
#include "sim/world/sensor/sensor.h"
#include "sim/world/stereo/stereo_scene.h"

struct pair {
    struct iso_stereo *stereo;
    struct sim_stereo_scene *scene;
    uint8_t *left, *right;
    float *intensity; /* the left picture, rectified */
    size_t n_pixels;
};

static void pair_free(void *own)
{
    struct pair *pair = own;
    iso_stereo_free(pair->stereo);
    sim_stereo_scene_free(pair->scene);
    free(pair->left);
    free(pair->right);
    free(pair->intensity);
    free(pair);
}

static int pair_new(bool dots, void **own)
{
    struct sim_stereo_rig rig = sim_stereo_rig(1.0);
    struct iso_stereo_options options = iso_stereo_options_default();
    const struct iso_camera *camera = &rig.built.camera[ISO_EYE_LEFT];
    const size_t n = (size_t)camera->width_px * (size_t)camera->height_px;
    struct pair *pair = calloc(1, sizeof *pair);
    if (!pair) {
        return -ENOMEM;
    }
    rig.dots = dots;
    pair->left = malloc(n);
    pair->right = malloc(n);
    pair->intensity = calloc(n, sizeof *pair->intensity);
    pair->n_pixels = n;
    int error = pair->left && pair->right && pair->intensity ? 0 : -ENOMEM;
    if (!error) {
        error = sim_stereo_scene_new(&rig, &pair->scene);
    }
    if (!error) {
        error = iso_stereo_new(&rig.believed, &options, &pair->stereo, NULL);
    }
    if (error) {
        pair_free(pair);
        return error;
    }
    *own = pair;
    return 0;
}

static int active_new(void **own)
{
    return pair_new(true, own);
}

static int passive_new(void **own)
{
    return pair_new(false, own);
}

static void attach(void *own, struct sim_view *view)
{
    struct pair *pair = own;
    sim_stereo_scene_attach(pair->scene, view);
}

static void measure(const struct sim_view *view, double noise_scale, struct sim_random *random,
                    struct sim_sensor_workspace *workspace, float *depth_mm)
{
    struct pair *pair = workspace->own;
    struct iso_frame frame = {.width_px = view->camera.width_px,
                              .height_px = view->camera.height_px,
                              .depth_mm = depth_mm,
                              .intensity = pair->intensity};
    const uint64_t key = sim_random_u64(random);
    sim_stereo_scene_expose(pair->scene, key, noise_scale, random, pair->left, pair->right);
    if (iso_stereo_compute(pair->stereo, pair->left, pair->right, NULL, &frame) != 0) {
        for (size_t i = 0; i < workspace->n_pixels; i++) {
            depth_mm[i] = 0.0f; /* out of memory: a frame without a measurement */
        }
    }
}

static void picture(const void *own, float *intensity)
{
    const struct pair *pair = own;
    memcpy(intensity, pair->intensity, pair->n_pixels * sizeof *intensity);
}

/* The rectified left camera. iso_rectification_of gives the same camera for every calibration of
 * such a rig, whose focal length is 900 px to the nearest pixel. */
#define CAMERA                                                                         \
    {                                                                                  \
        .projection = ISO_PINHOLE, .width_px = 1280, .height_px = 800, .fx_px = 900.0, \
        .fy_px = 900.0, .cx_px = 639.5, .cy_px = 399.5                                 \
    }

const struct sim_sensor sim_sensor_stereo = {
    .name = "stereo",
    .summary = "two cameras and a dot projector, matched by the product, 1280x800",
    .camera = CAMERA,
    .unit_mm = 0.1,
    .supersample = 1,
    .distance_min_mm = 450.0,
    .distance_max_mm = 750.0,
    .measure = measure,
    .load = iso_stereo_module_load,
    .own_new = active_new,
    .own_free = pair_free,
    .attach = attach,
    .picture = picture,
};

const struct sim_sensor sim_sensor_stereo_passive = {
    .name = "stereo-passive",
    .summary = "the same with an even lamp instead of dots",
    .camera = CAMERA,
    .unit_mm = 0.1,
    .supersample = 1,
    .distance_min_mm = 450.0,
    .distance_max_mm = 750.0,
    .measure = measure,
    .load = iso_stereo_module_load,
    .own_new = passive_new,
    .own_free = pair_free,
    .attach = attach,
    .picture = picture,
};
