#include "drivers/sensor/picture/sensor_stereo.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/sensor/picture/picture_format.h"
#include "drivers/stereo/stereo_module.h"

const struct iso_option_spec iso_sensor_stereo_options[] = {
    {.name = "left", .required = true, .help = "the left camera, as seen from behind the cameras"},
    {.name = "right", .required = true, .help = "the right camera"},
    {.name = "calibration",
     .kind = ISO_OPTION_PATH,
     .required = true,
     .help = "the file of `isotherm-sim calibrate`"},
    ISO_PICTURE_SENSOR_OPTIONS,
    {.name = "near_mm",
     .kind = ISO_OPTION_NUMBER,
     .min = 100,
     .max = 10000,
     .standard = "300",
     .help = "the nearest distance that is measured"},
    {.name = "far_mm",
     .kind = ISO_OPTION_NUMBER,
     .min = 100,
     .max = 10000,
     .standard = "1200",
     .help = "the farthest distance that is measured"},
    {.name = "confidence",
     .kind = ISO_OPTION_NUMBER,
     .min = 0,
     .max = 1,
     .standard = "0.75",
     .help = "least correlation of the two pictures for a depth to count"},
    {.name = NULL},
};

static void read_cameras(const struct iso_option_set *set, struct iso_sensor_stereo_cameras *out)
{
    out->ids[ISO_EYE_LEFT] = iso_option_text(set, "left");
    out->ids[ISO_EYE_RIGHT] = iso_option_text(set, "right");
    iso_picture_sensor_options(set, &out->fps, &out->tolerance_ns);
}

/* If the pictures differ from their model by more than half a pixel, matching gives wrong
 * depths. */
static enum iso_fault_code judge_calibration(const struct iso_stereo_calibration *calibration)
{
    static const double rms_max_px = 0.5;
    if (calibration->pairs == 0) {
        return ISO_FAULT_CALIBRATION_NOMINAL;
    }
    return calibration->rms_px > rms_max_px ? ISO_FAULT_CALIBRATION_POOR : ISO_FAULT_NONE;
}

/* Writes a text such as "60.0 mm apart, 0.21 px rms of 24 pairs". */
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

static int read_matching(const struct iso_option_set *set,
                         struct iso_stereo_calibration *calibration,
                         struct iso_stereo_options *stereo, struct iso_fault *fault)
{
    *stereo = iso_stereo_options_default();
    stereo->near_mm = iso_option_number(set, "near_mm");
    stereo->far_mm = iso_option_number(set, "far_mm");
    stereo->confidence_min = iso_option_number(set, "confidence");
    const int error = iso_stereo_calibration_read(iso_option_text(set, "calibration"), calibration,
                                                  fault);
    if (error == -ENOENT) {
        return iso_fault_recode(fault, ISO_FAULT_CALIBRATION_MISSING, error);
    }
    return error ? iso_fault_code_default(fault, ISO_FAULT_CALIBRATION_WRONG,
                                          error == -ENOMEM ? error : -EINVAL)
                 : 0;
}

int iso_sensor_stereo_load(const char *owner, struct iso_fault *fault)
{
    struct iso_fault why = {.text = ""};
    const int error = iso_stereo_module_load(&why);
    return error ? iso_fault_set_code(fault, why.code, error, "%s: %s", owner, why.text) : 0;
}

int iso_sensor_stereo_init(const char *owner, const struct iso_option *options, size_t n_options,
                           struct iso_sensor_stereo *out, struct iso_sensor_stereo_cameras *cameras,
                           struct iso_fault *fault)
{
    struct iso_stereo_calibration calibration;
    struct iso_stereo_options stereo;
    struct iso_sensor_stereo_cameras eyes = {.fps = 0};
    struct iso_sensor_stereo made = {.owner = owner};
    const struct iso_option_set set = {iso_sensor_stereo_options, options, n_options};
    read_cameras(&set, &eyes);
    int error = read_matching(&set, &calibration, &stereo, fault);
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
    const size_t n = (size_t)camera->width_px * (size_t)camera->height_px;
    describe_calibration(&calibration, made.calibration, sizeof made.calibration);
    made.calibration_code = judge_calibration(&calibration);
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
        /* This pair is lost, but the next one may be good. */
        return iso_fault_set_code(fault, ISO_FAULT_SENSOR_FAILED, -EBADMSG,
                                  "%s: the pictures cannot be matched: %s", stereo->owner,
                                  strerror(-error));
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
    out->calibration_code = stereo->calibration_code;
}
