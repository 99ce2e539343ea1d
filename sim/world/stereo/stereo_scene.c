#include "sim/world/stereo/stereo_scene.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "sim/world/stereo/lens.h"

/* Views of the cameras are larger than their pictures, for rays that distortion bends outwards. */
enum { MARGIN_PX = 100, LEVELS = 4096 };

struct eye {
    struct sim_view *view; /* undistorted */
    struct iso_rigid eye_from_scene;
    struct sim_lens *lens;
};

struct sim_stereo_scene {
    struct sim_stereo_rig rig;
    struct eye eyes[ISO_EYES];
    struct sim_view *projector;
    struct iso_rigid projector_from_scene;
    float *shade;    /* of the projector's view */
    float *radiance; /* of one picture */
    size_t histogram[LEVELS];
};

/* ---- making ----------------------------------------------------------------- */

static struct iso_camera widened_camera(const struct iso_camera *camera)
{
    return (struct iso_camera){.projection = ISO_PINHOLE,
                               .width_px = camera->width_px + 2 * MARGIN_PX,
                               .height_px = camera->height_px + 2 * MARGIN_PX,
                               .fx_px = camera->fx_px,
                               .fy_px = camera->fy_px,
                               .cx_px = camera->cx_px + MARGIN_PX,
                               .cy_px = camera->cy_px + MARGIN_PX};
}

static int make_eye(const struct iso_camera *camera, struct eye *eye)
{
    struct iso_camera without = widened_camera(camera);
    const int error = sim_view_new(&without, 2, &eye->view);
    if (error) {
        return error;
    }
    return sim_lens_new(camera, &eye->lens);
}

static void place_cameras(struct sim_stereo_scene *s)
{
    struct iso_rectification r = iso_rectification_of(&s->rig.believed);
    struct iso_rigid left_from_scene = {iso_mat3_transpose(&r.rectified_from_eye[ISO_EYE_LEFT]),
                                        {0.0, 0.0, 0.0}};
    struct iso_rigid projector_from_left = iso_rigid_identity();
    projector_from_left.translation_mm = iso_scale(-1.0, s->rig.projector_mm);
    s->eyes[ISO_EYE_LEFT].eye_from_scene = left_from_scene;
    s->eyes[ISO_EYE_RIGHT].eye_from_scene = iso_rigid_mul(&s->rig.built.right_from_left,
                                                          &left_from_scene);
    s->projector_from_scene = iso_rigid_mul(&projector_from_left, &left_from_scene);
}

int sim_stereo_scene_new(const struct sim_stereo_rig *rig, struct sim_stereo_scene **out)
{
    struct sim_stereo_scene *scene = calloc(1, sizeof *scene);
    if (!scene) {
        return -ENOMEM;
    }
    scene->rig = *rig;
    const struct iso_camera *camera = &scene->rig.built.camera[ISO_EYE_LEFT];
    struct iso_camera beam = widened_camera(camera);
    place_cameras(scene);
    int error = make_eye(camera, &scene->eyes[ISO_EYE_LEFT]);
    if (!error) {
        error = make_eye(&scene->rig.built.camera[ISO_EYE_RIGHT], &scene->eyes[ISO_EYE_RIGHT]);
    }
    if (!error) {
        error = sim_view_new(&beam, 1, &scene->projector);
    }
    scene->shade = malloc((size_t)beam.width_px * (size_t)beam.height_px * sizeof(float));
    scene->radiance = malloc((size_t)camera->width_px * (size_t)camera->height_px * sizeof(float));
    if (error || !scene->shade || !scene->radiance) {
        sim_stereo_scene_free(scene);
        return -ENOMEM;
    }
    *out = scene;
    return 0;
}

void sim_stereo_scene_free(struct sim_stereo_scene *scene)
{
    if (scene) {
        for (int eye = 0; eye < ISO_EYES; eye++) {
            sim_view_free(scene->eyes[eye].view);
            sim_lens_free(scene->eyes[eye].lens);
        }
        sim_view_free(scene->projector);
        free(scene->shade);
        free(scene->radiance);
        free(scene);
    }
}

void sim_stereo_scene_attach(struct sim_stereo_scene *scene, struct sim_view *view)
{
    view->n_companions = 3;
    for (int eye = 0; eye < ISO_EYES; eye++) {
        view->companions[eye] = (struct sim_companion){scene->eyes[eye].view,
                                                       scene->eyes[eye].eye_from_scene};
    }
    view->companions[2] = (struct sim_companion){scene->projector, scene->projector_from_scene};
}

/* ---- light to pixels -------------------------------------------------------- */

/* The intersection of a ray with the surface that the view shows around its pixel; false if there
 * is none. */
static bool meet_surface(const struct sim_view *view, double x, double y, struct iso_vec3 *point,
                         const struct sim_facet **seen)
{
    const struct iso_camera *camera = &view->camera;
    const double u = camera->cx_px + camera->fx_px * x, v = camera->cy_px + camera->fy_px * y;
    if (!(u > -0.5 && v > -0.5 && u < camera->width_px - 0.5 && v < camera->height_px - 0.5)) {
        return false;
    }
    const int column = (int)lrint(u), row = (int)lrint(v);
    const size_t i = (size_t)row * (size_t)camera->width_px + (size_t)column;
    if (view->facet[i] < 0) {
        return false;
    }
    const struct sim_facet *facet = &view->facets[view->facet[i]];
    const double depth = (double)view->depth_mm[i];
    struct iso_vec3 on = iso_camera_back_project(camera, column, row, depth);
    struct iso_vec3 ray = {x, y, 1.0};
    const double across = iso_dot(facet->normal, ray);
    double t = fabs(across) > 0.05 ? iso_dot(facet->normal, on) / across : depth;
    /* Beyond the facet's edge its plane may be far from the surface. */
    t = fabs(t - depth) < 0.02 * depth ? t : depth;
    *point = iso_scale(t, ray);
    *seen = facet;
    return true;
}

static double pixel_radiance(const struct eye *eye, const struct sim_light *light, int samples,
                             size_t i)
{
    struct iso_rigid scene_from_eye = iso_rigid_inverse(&eye->eye_from_scene);
    double sum = 0.0;
    for (int k = 0; k < samples * samples; k++) {
        const double a = (k % samples + 0.5) / samples, b = ((double)(k / samples) + 0.5) / samples;
        struct iso_vec3 sight = sim_lens_sight(eye->lens, i, a, b), point;
        const struct sim_facet *facet;
        if (meet_surface(eye->view, sight.x, sight.y, &point, &facet)) {
            sum += sim_light_at(light, iso_rigid_apply(&scene_from_eye, point), facet);
        }
    }
    return sum / (samples * samples);
}

static void take_picture(struct sim_stereo_scene *s, enum iso_eye which,
                         const struct sim_light *light)
{
    const struct iso_camera *camera = &s->rig.built.camera[which];
    const size_t n = (size_t)camera->width_px * (size_t)camera->height_px;
    for (size_t i = 0; i < n; i++) {
        s->radiance[i] = (float)pixel_radiance(&s->eyes[which], light, s->rig.samples, i);
    }
}

/* The radiance that only a fiftieth of the middle of the picture exceeds; 1 if all of it is dark.
 */
static double brightest_radiance(struct sim_stereo_scene *s)
{
    const struct iso_camera *camera = &s->rig.built.camera[ISO_EYE_LEFT];
    const size_t width = (size_t)camera->width_px, height = (size_t)camera->height_px;
    size_t n = 0;
    float largest = 0.0f;
    memset(s->histogram, 0, sizeof s->histogram);
    for (int pass = 0; pass < 2; pass++) {
        for (size_t row = height / 4; row < height * 3 / 4; row++) {
            for (size_t column = width / 4; column < width * 3 / 4; column++) {
                const float value = s->radiance[row * width + column];
                if (pass == 0) {
                    largest = value > largest ? value : largest;
                } else {
                    s->histogram[(size_t)(value / largest * (LEVELS - 1))]++;
                    n++;
                }
            }
        }
        if (!(largest > 0.0f)) {
            return 1.0;
        }
    }
    size_t above = 0;
    int level = LEVELS - 1;
    while (level > 1 && (above += s->histogram[level]) < n / 50) {
        level--;
    }
    return (double)largest * level / (LEVELS - 1);
}

static void read_out(const struct sim_stereo_scene *s, double gain, double noise_scale,
                     struct sim_random *random, uint8_t *image)
{
    const struct iso_camera *camera = &s->rig.built.camera[ISO_EYE_LEFT];
    const size_t n = (size_t)camera->width_px * (size_t)camera->height_px;
    for (size_t i = 0; i < n; i++) {
        double electrons = s->rig.full_well_e * gain * (double)s->radiance[i];
        const double sd = sqrt(electrons + s->rig.read_noise_e * s->rig.read_noise_e);
        electrons += noise_scale * sd * sim_random_normal(random);
        const double level = nearbyint(255.0 * electrons / s->rig.full_well_e);
        image[i] = (uint8_t)fmin(fmax(level, 0.0), 255.0);
    }
}

void sim_stereo_scene_expose(struct sim_stereo_scene *scene, uint64_t key, double noise_scale,
                             struct sim_random *random, uint8_t *left, uint8_t *right)
{
    struct sim_light light = {.rig = &scene->rig,
                              .view = scene->projector,
                              .shade = scene->shade,
                              .view_from_scene = scene->projector_from_scene,
                              .key = key};
    sim_light_shade(scene->projector, scene->shade);
    take_picture(scene, ISO_EYE_LEFT, &light);
    const double gain = 200.0 / 255.0 / brightest_radiance(scene);
    read_out(scene, gain, noise_scale, random, left);
    take_picture(scene, ISO_EYE_RIGHT, &light);
    read_out(scene, gain * scene->rig.right_gain, noise_scale, random, right);
}
