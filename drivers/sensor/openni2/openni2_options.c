#include "drivers/sensor/openni2/openni2_options.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char owner[] = "sensor openni2";

static int read_mode(const char *text, struct iso__openni2_wish *wish)
{
    int end = -1;
    const int n = sscanf(text, "%5dx%5d@%5d%n", &wish->width_px, &wish->height_px, &wish->fps,
                         &end);
    const bool whole = n == 3 && end >= 0 && !text[end];
    return whole && wish->width_px >= 1 && wish->height_px >= 1 && wish->fps >= 1 ? 0 : -EINVAL;
}

static int check_mode(const char *value, struct iso_fault *fault)
{
    struct iso__openni2_wish wish;
    return read_mode(value, &wish) ? iso_fault_set_code(fault, ISO_FAULT_OPTION_WRONG, -EINVAL,
                                                        "'%s' is not WIDTHxHEIGHT@HZ", value)
                                   : 0;
}

static int read_intrinsics(const char *text, struct iso_camera *camera)
{
    int end = -1;
    const int n = sscanf(text, "%lf %lf %lf %lf%n", &camera->fx_px, &camera->fy_px, &camera->cx_px,
                         &camera->cy_px, &end);
    return n == 4 && end >= 0 && !text[end] ? 0 : -EINVAL;
}

/* Checks what can be checked before the size of the pictures is known. */
static int check_intrinsics(const char *value, struct iso_fault *fault)
{
    struct iso_camera largest = {.projection = ISO_PINHOLE, .width_px = 8192, .height_px = 8192};
    struct iso_fault why;
    if (read_intrinsics(value, &largest)) {
        return iso_fault_set_code(fault, ISO_FAULT_OPTION_WRONG, -EINVAL, "'%s' is not FX FY CX CY",
                                  value);
    }
    return iso_camera_check(&largest, &why)
               ? iso_fault_set_code(fault, ISO_FAULT_OPTION_WRONG, -EINVAL, "%s", why.text)
               : 0;
}

const struct iso_option_spec iso__openni2_options[] = {
    {.name = "device",
     .standard = "",
     .help = "URI or serial number of the camera; the first camera if empty"},
    {.name = "path",
     .kind = ISO_OPTION_PATH,
     .standard = "",
     .help = "an .oni file to play instead of a camera"},
    {.name = "mode",
     .standard = "",
     .check = check_mode,
     .help = "WIDTHxHEIGHT@HZ; the present mode of the camera if empty"},
    {.name = "unit",
     .kind = ISO_OPTION_CHOICE,
     .choices = "finest|100um|1mm",
     .standard = "finest",
     .help = "the length that a count of depth stands for"},
    {.name = "intensity",
     .kind = ISO_OPTION_CHOICE,
     .choices = "no|ir|color",
     .standard = "no",
     .help = "which image comes with the depths"},
    {.name = "intrinsics",
     .standard = "",
     .check = check_intrinsics,
     .help = "FX FY CX CY in pixels, from a calibration, instead of a camera file"},
    {.name = "camera",
     .kind = ISO_OPTION_PATH,
     .standard = "",
     .help = "a file like recording.ini that describes the lens of the depth camera"},
    {.name = "pace",
     .kind = ISO_OPTION_CHOICE,
     .choices = "realtime|asap",
     .standard = "realtime",
     .help = "of an .oni file: when frames are due, by their time stamps or at once"},
    {.name = "loop",
     .kind = ISO_OPTION_SWITCH,
     .standard = "no",
     .help = "of an .oni file: whether the first frame follows the last one"},
    {.name = "record",
     .kind = ISO_OPTION_PATH,
     .standard = "",
     .tools_only = true,
     .help = "an .oni file that OpenNI 2 writes from start to stop"},
    {.name = NULL},
};

static int parse_words(const struct iso_option_set *set, struct iso__openni2_settings *settings,
                       struct iso_fault *fault)
{
    static const int unit_um[] = {0, 100, 1000};
    struct iso__openni2_wish *wish = &settings->wish;
    const char *mode = iso_option_text(set, "mode");
    const char *intrinsics = iso_option_text(set, "intrinsics");
    wish->unit_um = unit_um[iso_option_choice(set, "unit")];
    wish->grey = (enum iso__openni2_grey)iso_option_choice(set, "intensity");
    wish->loop = iso_option_switch(set, "loop");
    settings->realtime = iso_option_choice(set, "pace") == 0;
    settings->calibrated = *intrinsics;
    if ((*mode && read_mode(mode, wish)) ||
        (settings->calibrated && read_intrinsics(intrinsics, &settings->lens))) {
        return iso_fault_set_code(fault, ISO_FAULT_OPTION_WRONG, -EINVAL,
                                  "%s: bad mode or intrinsics", owner);
    }
    return 0;
}

static int parse_camera(const struct iso_option_set *set, struct iso__openni2_settings *settings,
                        struct iso_fault *fault)
{
    if (!iso_option_is_given(set, "camera")) {
        return 0;
    }
    if (settings->calibrated) {
        return iso_fault_set_code(fault, ISO_FAULT_OPTION_WRONG, -EINVAL,
                                  "%s: options 'camera' and 'intrinsics' exclude each other",
                                  owner);
    }
    settings->has_camera = true;
    return iso_camera_file_read(iso_option_text(set, "camera"), &settings->camera, fault);
}

static int copy_text(const struct iso_option_set *set, const char *name, char **out,
                     struct iso_fault *fault)
{
    if (!iso_option_is_given(set, name)) {
        return 0;
    }
    *out = strdup(iso_option_text(set, name));
    return *out ? 0 : iso_fault_set(fault, -ENOMEM, "%s: out of memory", owner);
}

/* Checks that the options may be combined. */
static int check_together(const struct iso__openni2_settings *settings, struct iso_fault *fault)
{
    if (settings->path && settings->device) {
        return iso_fault_set_code(fault, ISO_FAULT_OPTION_WRONG, -EINVAL,
                                  "%s: options 'path' and 'device' exclude each other", owner);
    }
    if (!settings->path && (!settings->realtime || settings->wish.loop)) {
        return iso_fault_set_code(fault, ISO_FAULT_OPTION_WRONG, -EINVAL,
                                  "%s: options 'pace' and 'loop' need a file ('path')", owner);
    }
    return 0;
}

int iso__openni2_settings_init(struct iso__openni2_settings *settings,
                               const struct iso_option *options, size_t n_options,
                               struct iso_fault *fault)
{
    const struct iso_option_set set = {iso__openni2_options, options, n_options};
    *settings = (struct iso__openni2_settings){.path = NULL};
    int error = parse_words(&set, settings, fault);
    if (!error) {
        error = parse_camera(&set, settings, fault);
    }
    if (!error) {
        error = copy_text(&set, "path", &settings->path, fault);
    }
    if (!error) {
        error = copy_text(&set, "device", &settings->device, fault);
    }
    if (!error) {
        error = copy_text(&set, "record", &settings->record, fault);
    }
    if (!error) {
        error = check_together(settings, fault);
    }
    if (error) {
        iso__openni2_settings_done(settings);
        return error;
    }
    settings->wish.path = settings->path;
    settings->wish.device = settings->device;
    return 0;
}

void iso__openni2_settings_done(struct iso__openni2_settings *settings)
{
    free(settings->path);
    free(settings->device);
    free(settings->record);
    *settings = (struct iso__openni2_settings){.path = NULL};
}
