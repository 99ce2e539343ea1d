#include "drivers/sensor/picture/sensor_stereo.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/sensor/picture/picture_format.h"
#include "drivers/stereo/stereo_module.h"

static int read_cameras(const char *owner, const struct iso_option *options, size_t n_options,
                        struct iso_sensor_stereo_cameras *out, struct iso_fault *fault)
{
    static const char *const known[] = {"left",    "right",  "calibration", "fps", "pair_ms",
                                        "near_mm", "far_mm", "confidence",  NULL};
    static const char *const eyes[ISO_EYES] = {"left", "right"};
    int error = iso_options_check(owner, options, n_options, known, fault);
    for (int eye = 0; !error && eye < ISO_EYES; eye++) {
        error = iso_options_required(owner, options, n_options, eyes[eye], &out->ids[eye], fault);
    }
    return error ? error
                 : iso_picture_sensor_options(owner, options, n_options, &out->fps,
                                              &out->tolerance_ns, fault);
}

/* "60.0 mm apart, 0.21 px rms of 24 pairs". */
static void describe_calibration(const struct iso_stereo_calibration *calibration, char *text,
                                 size_t size)
{
    if (calibration->pairs > 0) {
        (void)snprintf(text, size, "%.1f mm apart, %.2f px rms of %d pairs",
                       iso_stereo_baseline_mm(calibration), calibration->rms_px,
                       calibration->pairs);
    } else {
        (void)snprintf(text, size, "%.1f mm apart, by hand", iso_stereo_baseline_mm(calibration));
    }
}

static int read_matching(const char *owner, const struct iso_option *options, size_t n_options,
                         struct iso_stereo_calibration *calibration,
                         struct iso_stereo_options *stereo, struct iso_fault *fault)
{
    const char *path = NULL;
    *stereo = iso_stereo_options_default();
    int error = iso_options_required(owner, options, n_options, "calibration", &path, fault);
    error = error ? error
                  : iso_options_number(owner, options, n_options, "near_mm", 100.0, 10000.0,
                                       stereo->near_mm, &stereo->near_mm, fault);
    error = error ? error
                  : iso_options_number(owner, options, n_options, "far_mm", 100.0, 10000.0,
                                       stereo->far_mm, &stereo->far_mm, fault);
    error = error ? error
                  : iso_options_number(owner, options, n_options, "confidence", 0.0, 1.0,
                                       stereo->confidence_min, &stereo->confidence_min, fault);
    if (!error) {
        error = iso_stereo_calibration_read(path, calibration, fault);
        error = error && error != -ENOMEM && error != -ENOENT ? -EINVAL : error;
    }
    return error;
}

int iso_sensor_stereo_load(const char *owner, struct iso_fault *fault)
{
    struct iso_fault why = {""};
    const int error = iso_stereo_module_load(&why);
    return error ? iso_fault_set(fault, error, "%s: %s", owner, why.text) : 0;
}

int iso_sensor_stereo_init(const char *owner, const struct iso_option *options, size_t n_options,
                           struct iso_sensor_stereo *out, struct iso_sensor_stereo_cameras *cameras,
                           struct iso_fault *fault)
{
    struct iso_stereo_calibration calibration;
    struct iso_stereo_options stereo;
    struct iso_sensor_stereo_cameras eyes = {.fps = 0};
    struct iso_sensor_stereo made = {.owner = owner};
    int error = read_cameras(owner, options, n_options, &eyes, fault);
    if (!error) {
        error = read_matching(owner, options, n_options, &calibration, &stereo, fault);
    }
    if (!error) {
        error = iso_sensor_stereo_load(owner, fault);
    }
    if (!error) {
        error = iso_stereo_new(&calibration, &stereo, &made.stereo, fault);
    }
    if (error) {
        return error;
    }
    const struct iso_camera *camera = &iso_stereo_rectification(made.stereo)->camera;
    size_t n = (size_t)camera->width_px * (size_t)camera->height_px;
    describe_calibration(&calibration, made.calibration, sizeof made.calibration);
    made.width_px = camera->width_px;
    made.height_px = camera->height_px;
    made.pictures[ISO_EYE_LEFT] = calloc(1, n);
    made.pictures[ISO_EYE_RIGHT] = calloc(1, n);
    error = iso_frame_new(camera, camera->width_px, camera->height_px, true, &made.frame);
    if (error || !made.pictures[ISO_EYE_LEFT] || !made.pictures[ISO_EYE_RIGHT]) {
        iso_sensor_stereo_done(&made);
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", owner);
    }
    *cameras = eyes;
    *out = made;
    return 0;
}

int iso_sensor_stereo_check(const char *owner, const struct iso_option *options, size_t n_options,
                            struct iso_fault *fault)
{
    struct iso_sensor_stereo stereo;
    struct iso_sensor_stereo_cameras cameras;
    const int error = iso_sensor_stereo_init(owner, options, n_options, &stereo, &cameras, fault);
    if (!error) {
        iso_sensor_stereo_done(&stereo);
    }
    return error;
}

void iso_sensor_stereo_done(struct iso_sensor_stereo *stereo)
{
    iso_picture_stream_close(stereo->base.stream);
    iso_stereo_free(stereo->stereo);
    iso_frame_free(stereo->frame);
    free(stereo->pictures[ISO_EYE_LEFT]);
    free(stereo->pictures[ISO_EYE_RIGHT]);
}

int iso_sensor_stereo_wait(void *self, int64_t deadline_ns, const struct iso_frame **frame,
                           struct iso_fault *fault)
{
    struct iso_sensor_stereo *stereo = self;
    struct iso_picture_set set;
    int error = iso_picture_stream_wait(stereo->base.stream, deadline_ns, &set, fault);
    if (error) {
        return error;
    }
    for (int eye = 0; eye < ISO_EYES; eye++) {
        iso_picture_to_grey8(&set.pictures[eye], stereo->pictures[eye]);
    }
    error = iso_stereo_compute(stereo->stereo, stereo->pictures[ISO_EYE_LEFT],
                               stereo->pictures[ISO_EYE_RIGHT], NULL, stereo->frame);
    if (error) {
        /* This pair is lost; the next may be good. */
        return iso_fault_set(fault, -EBADMSG, "%s: the pictures cannot be matched: %s",
                             stereo->owner, strerror(-error));
    }
    stereo->frame->t_ns = set.t_ns;
    stereo->frame->sequence = set.sequence;
    *frame = stereo->frame;
    return 0;
}

void iso_sensor_stereo_describe(const struct iso_sensor_stereo *stereo, const char *serial,
                                struct iso_sensor_description *out)
{
    *out = (struct iso_sensor_description){.model = "stereo",
                                           .width_px = stereo->width_px,
                                           .height_px = stereo->height_px,
                                           .intensity = true};
    (void)snprintf(out->serial, sizeof out->serial, "%s", serial);
    (void)snprintf(out->calibration, sizeof out->calibration, "%s", stereo->calibration);
}
