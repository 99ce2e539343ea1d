#include "drivers/stereo/stereo.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/stereo/coarse.h"
#include "drivers/stereo/refine.h"
#include "drivers/stereo/stereo_module.h"

/* The difference of two neighbours that counts as a jump: 20 mm at 0.6 m, with f = 900 px and 60 mm
 * between the cameras. */
static const float jump_px = 3.0f;

enum { OUTLINE_PX = 2 };

struct iso_stereo {
    struct iso_rectification rectification;
    struct iso_stereo_options options;
    size_t n_pixels;
    struct iso_stereo_opencv *opencv;
    struct iso_refine *refine;
    uint8_t *rectified[ISO_EYES]; /* each has n_pixels */
    float *half_px;               /* [n_pixels / 4] */
    float *disparity_px, *confidence;
    float *claim_px; /* [width]: the largest disparity that matches a column of the right image */
};

struct iso_stereo_options iso_stereo_options_default(void)
{
    return (struct iso_stereo_options){
        .near_mm = 300.0, .far_mm = 1200.0, .confidence_min = 0.75, .window_px = 9};
}

/* ---- making ----------------------------------------------------------------- */

static int allocate_planes(struct iso_stereo *s)
{
    const size_t n = s->n_pixels;
    s->rectified[ISO_EYE_LEFT] = malloc(n);
    s->rectified[ISO_EYE_RIGHT] = malloc(n);
    s->half_px = malloc(n / 4 * sizeof(float));
    s->disparity_px = malloc(n * sizeof(float));
    s->confidence = malloc(n * sizeof(float));
    s->claim_px = malloc((size_t)s->rectification.camera.width_px * sizeof(float));
    return s->rectified[ISO_EYE_LEFT] && s->rectified[ISO_EYE_RIGHT] && s->half_px &&
                   s->disparity_px && s->confidence && s->claim_px
               ? 0
               : -ENOMEM;
}

/* OpenCV copies the maps, so they are in memory that is freed at once. */
static int make_matcher(struct iso_stereo *s, const struct iso_stereo_calibration *calibration)
{
    const struct iso_camera *camera = &s->rectification.camera;
    const double fb = camera->fx_px * s->rectification.baseline_mm;
    float *maps = malloc(4 * s->n_pixels * sizeof(float));
    struct iso_stereo_opencv_options options = {
        .width_px = camera->width_px,
        .height_px = camera->height_px,
        .disparity_min_px = (int)(fb / s->options.far_mm),
        .disparity_max_px = (int)(fb / s->options.near_mm) + 1,
    };
    if (!maps) {
        return -ENOMEM;
    }
    for (int eye = 0; eye < ISO_EYES; eye++) {
        float *x_px = maps + (size_t)(2 * eye) * s->n_pixels, *y_px = x_px + s->n_pixels;
        iso_rectification_map(&s->rectification, calibration, (enum iso_eye)eye, x_px, y_px);
        options.map_x_px[eye] = x_px;
        options.map_y_px[eye] = y_px;
    }
    const int error = iso_stereo_opencv_new(&options, &s->opencv);
    free(maps);
    return error;
}

static int make_stages(struct iso_stereo *s, const struct iso_stereo_calibration *calibration)
{
    const struct iso_camera *camera = &s->rectification.camera;
    struct iso_refine_options refine = {.window_px = s->options.window_px,
                                        .smooth_px = s->options.window_px - 2,
                                        .iterations = 2,
                                        .step_max_px = 1.0,
                                        .contrast_min = 1.5};
    int error = allocate_planes(s);
    if (!error) {
        error = make_matcher(s, calibration);
    }
    if (!error) {
        error = iso_refine_new(camera->width_px, camera->height_px, &refine, &s->refine);
    }
    return error;
}

/* Returns what is wrong with the options for this sound calibration, or NULL. */
static const char *find_flaw(const struct iso_stereo_calibration *calibration,
                             const struct iso_stereo_options *options)
{
    const struct iso_camera *camera = &calibration->camera[ISO_EYE_LEFT];
    const double fb = camera->fx_px * iso_stereo_baseline_mm(calibration);
    if (!(options->near_mm >= 100.0 && options->near_mm < options->far_mm &&
          options->far_mm <= 10000.0)) {
        return "the range must lie within 100..10000 mm";
    }
    if (fb / options->near_mm - fb / options->far_mm > 1000.0) {
        return "the range spans more than 1000 px of disparity";
    }
    if (!(options->confidence_min >= 0.0 && options->confidence_min <= 1.0)) {
        return "the least confidence must be 0..1";
    }
    if (options->window_px < 3 || options->window_px > 31 || options->window_px % 2 == 0) {
        return "the window must be an odd number of pixels, 3..31";
    }
    if (camera->width_px % 2 || camera->height_px % 2 || camera->width_px < 64 ||
        camera->height_px < 64) {
        return "the images must be even in width and height, and at least 64 px";
    }
    return NULL;
}

int iso_stereo_new(const struct iso_stereo_calibration *calibration,
                   const struct iso_stereo_options *options, struct iso_stereo **out,
                   struct iso_fault *fault)
{
    struct iso_fault why;
    int error = iso_stereo_calibration_check(calibration, &why);
    if (error) {
        return iso_fault_set_code(fault, why.code, error, "stereo: %s", why.text);
    }
    const char *flaw = find_flaw(calibration, options);
    if (flaw) {
        return iso_fault_set(fault, -EINVAL, "stereo: %s", flaw);
    }
    error = iso_stereo_module_load(fault);
    if (error) {
        return error;
    }
    struct iso_stereo *stereo = calloc(1, sizeof *stereo);
    if (!stereo) {
        return iso_fault_set(fault, -ENOMEM, "stereo: out of memory");
    }
    stereo->rectification = iso_rectification_of(calibration);
    stereo->options = *options;
    stereo->n_pixels = (size_t)stereo->rectification.camera.width_px *
                       (size_t)stereo->rectification.camera.height_px;
    error = make_stages(stereo, calibration);
    if (error) {
        iso_stereo_free(stereo);
        return iso_fault_set(fault, error, "stereo: the matcher cannot be made: %s",
                             strerror(-error));
    }
    *out = stereo;
    return 0;
}

void iso_stereo_free(struct iso_stereo *stereo)
{
    if (stereo) {
        iso_stereo_opencv_free(stereo->opencv);
        iso_refine_free(stereo->refine);
        free(stereo->rectified[ISO_EYE_LEFT]);
        free(stereo->rectified[ISO_EYE_RIGHT]);
        free(stereo->half_px);
        free(stereo->disparity_px);
        free(stereo->confidence);
        free(stereo->claim_px);
        free(stereo);
    }
}

const struct iso_rectification *iso_stereo_rectification(const struct iso_stereo *stereo)
{
    return &stereo->rectification;
}

/* ---- frames ----------------------------------------------------------------- */

/* Whether two neighbouring disparities are known and belong to different surfaces. */
static bool surfaces_differ(float a, float b)
{
    return a > 0.0f && b > 0.0f && fabsf(a - b) > jump_px;
}

/* A column of the right image shows only the nearest surface. If another pixel that matches the
 * same column is farther by more than a pixel of disparity, its own surface is hidden there, and
 * the match is wrong. */
static void drop_hidden(struct iso_stereo *s, float *disparity_px)
{
    const int width = s->rectification.camera.width_px;
    memset(s->claim_px, 0, (size_t)width * sizeof *s->claim_px);
    for (int column = 0; column < width; column++) {
        int at = (int)((float)column - disparity_px[column] + 0.5f);
        if (disparity_px[column] > 0.0f && at >= 0 && disparity_px[column] > s->claim_px[at]) {
            s->claim_px[at] = disparity_px[column];
        }
    }
    for (int column = 0; column < width; column++) {
        const int at = (int)((float)column - disparity_px[column] + 0.5f);
        if (disparity_px[column] > 0.0f && at >= 0 &&
            disparity_px[column] < s->claim_px[at] - 1.0f) {
            disparity_px[column] = 0.0f;
        }
    }
}

/* The position of an outline is known only to a pixel or two. Pixels that are so close to a jump
 * may have the depth of the other side, so they are dropped on both sides. */
static void drop_outlines(struct iso_stereo *s)
{
    const struct iso_camera *camera = &s->rectification.camera;
    int width = camera->width_px, height = camera->height_px;
    for (int row = 0; row < height; row++) {
        for (int column = 0; column < width; column++) {
            const size_t i = (size_t)row * (size_t)width + (size_t)column;
            const float own = s->disparity_px[i];
            const size_t reach = OUTLINE_PX, down = OUTLINE_PX * (size_t)width;
            bool jump =
                (column >= OUTLINE_PX && surfaces_differ(own, s->disparity_px[i - reach])) ||
                (column < width - OUTLINE_PX && surfaces_differ(own, s->disparity_px[i + reach])) ||
                (row >= OUTLINE_PX && surfaces_differ(own, s->disparity_px[i - down])) ||
                (row < height - OUTLINE_PX && surfaces_differ(own, s->disparity_px[i + down]));
            s->confidence[i] = jump ? 0.0f : s->confidence[i];
        }
    }
}

static void fill_frame(struct iso_stereo *s, struct iso_frame *frame)
{
    const size_t width = (size_t)s->rectification.camera.width_px;
    const double fb = s->rectification.camera.fx_px * s->rectification.baseline_mm;
    for (size_t i = 0; i < s->n_pixels; i++) {
        if ((double)s->confidence[i] < s->options.confidence_min) {
            s->disparity_px[i] = s->confidence[i] = 0.0f;
        }
    }
    for (size_t first = 0; first < s->n_pixels; first += width) {
        drop_hidden(s, s->disparity_px + first);
    }
    drop_outlines(s);
    for (size_t i = 0; i < s->n_pixels; i++) {
        const double depth_mm = s->disparity_px[i] > 0.0f && s->confidence[i] > 0.0f
                                    ? fb / (double)s->disparity_px[i]
                                    : 0.0;
        const bool seen = depth_mm >= s->options.near_mm && depth_mm <= s->options.far_mm;
        frame->depth_mm[i] = seen ? (float)depth_mm : 0.0f;
        s->confidence[i] = seen ? s->confidence[i] : 0.0f;
        if (frame->intensity) {
            frame->intensity[i] = (float)s->rectified[ISO_EYE_LEFT][i] / 255.0f;
        }
    }
    frame->camera = s->rectification.camera;
    frame->crop_x_px = frame->crop_y_px = 0;
}

int iso_stereo_compute(struct iso_stereo *stereo, const uint8_t *left, const uint8_t *right,
                       const float **confidence, struct iso_frame *frame)
{
    const struct iso_camera *camera = &stereo->rectification.camera;
    uint8_t *const *rectified = stereo->rectified;
    if (frame->width_px != camera->width_px || frame->height_px != camera->height_px) {
        return -EINVAL;
    }
    int error = iso_stereo_opencv_rectify(stereo->opencv, 0, left, rectified[ISO_EYE_LEFT]);
    if (!error) {
        error = iso_stereo_opencv_rectify(stereo->opencv, 1, right, rectified[ISO_EYE_RIGHT]);
    }
    if (!error) {
        error = iso_stereo_opencv_match(stereo->opencv, rectified[ISO_EYE_LEFT],
                                        rectified[ISO_EYE_RIGHT], stereo->half_px);
    }
    if (error) {
        return error;
    }
    iso_coarse_spread(stereo->half_px, camera->width_px, camera->height_px, stereo->disparity_px);
    iso_refine_run(stereo->refine, rectified[ISO_EYE_LEFT], rectified[ISO_EYE_RIGHT],
                   stereo->disparity_px, stereo->confidence);
    fill_frame(stereo, frame);
    if (confidence) {
        *confidence = stereo->confidence;
    }
    return 0;
}
