/* isotherm-sim show: draws pictures of a frame of a recording. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/base/shipped.h"
#include "drivers/model/model_file.h"
#include "drivers/recording/recording.h"
#include "sim/base/make_directory.h"
#include "sim/commands/command.h"
#include "sim/commands/commands.h"
#include "sim/lab/landmarks/fit_picture.h"
#include "sim/lab/match/extract_options.h"
#include "sim/lab/picture/depth.h"
#include "sim/lab/picture/face.h"

struct arguments {
    const char *recording, *out, *what, *model;
    size_t frame;
    struct sim_face_angle angle;
    struct iso_extract_options extract;
};

#define FIELD(name) offsetof(struct arguments, name)

static const struct sim_option own_options[] = {
    {"recording", "DIR", "the recording of the frame", sim_option_text, FIELD(recording)},
    {"frame", "N", "number of the frame, from 0", sim_option_count, FIELD(frame)},
    {"what", "depth|fit|mesh|heat|isotherms|all", "what to draw", sim_option_text, FIELD(what)},
    {"out", "FILE", "PNG file; with --what all: a directory", sim_option_text, FIELD(out)},
    {"model", "FILE", "head model", sim_option_text, FIELD(model)},
    {"yaw", "DEGREES", "angle of view from the face's left (-17)", sim_option_degrees,
     FIELD(angle.yaw_rad)},
    {"pitch", "DEGREES", "angle of view from above (3)", sim_option_degrees,
     FIELD(angle.pitch_rad)},
};

/* The pictures that need a usable face. */
static const struct {
    const char *name;
    int (*draw)(const struct sim_face *face, struct sim_face_angle angle, const char *path,
                struct iso_fault *fault);
} face_pictures[] = {
    {"mesh", sim_picture_mesh},
    {"heat", sim_picture_heat},
    {"isotherms", sim_picture_isotherms},
};

static const size_t n_face_pictures = sizeof face_pictures / sizeof *face_pictures;

static bool is_wanted(const struct arguments *arguments, const char *name)
{
    return strcmp(arguments->what, name) == 0 || strcmp(arguments->what, "all") == 0;
}

static bool is_known(const char *what)
{
    bool known = strcmp(what, "all") == 0 || strcmp(what, "depth") == 0 || strcmp(what, "fit") == 0;
    for (size_t i = 0; i < n_face_pictures; i++) {
        known = known || strcmp(what, face_pictures[i].name) == 0;
    }
    return known;
}

/* The file of one picture: `out` itself, or with "all" NAME.png in the directory `out`. */
static int path_of(const struct arguments *arguments, const char *name, char *path, size_t size,
                   struct iso_fault *fault)
{
    const bool all = strcmp(arguments->what, "all") == 0;
    const int length = all ? snprintf(path, size, "%s/%s.png", arguments->out, name)
                           : snprintf(path, size, "%s", arguments->out);
    return length >= 0 && (size_t)length < size
               ? 0
               : iso_fault_set(fault, -ENAMETOOLONG, "%s: path too long", arguments->out);
}

static int draw_depth(const struct arguments *arguments, const struct iso_frame *frame,
                      struct iso_fault *fault)
{
    char path[4096];
    const int error = path_of(arguments, "depth", path, sizeof path, fault);
    if (error) {
        return error;
    }
    return sim_picture_depth(frame, path, fault);
}

/* Draws the fit of any frame, usable or not. `extracted` has no truth and no title yet. */
static int draw_fit(const struct arguments *arguments, const struct iso_recording *recording,
                    const struct sim_fit_subject *extracted, struct iso_fault *fault)
{
    char path[4096], title[4096];
    struct sim_truth *truth = NULL;
    int error = path_of(arguments, "fit", path, sizeof path, fault);
    if (!error) {
        error = sim_truth_of_recording(recording, &truth, fault);
    }
    if (error) {
        return error;
    }
    (void)snprintf(title, sizeof title, "%.3900s frame %zu", arguments->recording,
                   arguments->frame);
    struct sim_fit_subject subject = *extracted;
    subject.truth = &truth[arguments->frame];
    subject.title = title;
    error = sim_fit_picture(&subject, path, fault);
    free(truth);
    return error;
}

/* Draws the wanted pictures of the face. -ENODATA if the frame has no usable face. */
static int draw_face(const struct arguments *arguments, const struct sim_fit_subject *subject,
                     struct iso_fault *fault)
{
    int error = 0;
    if (subject->extraction->outcome != ISO_CAPTURE_OK) {
        return iso_fault_set(fault, -ENODATA, "frame %zu: no usable face (%s)", arguments->frame,
                             iso_capture_name(subject->extraction->outcome));
    }
    struct sim_face face = sim_face_of(subject->extractor, subject->extraction);
    for (size_t i = 0; !error && i < n_face_pictures; i++) {
        char path[4096];
        if (is_wanted(arguments, face_pictures[i].name)) {
            error = path_of(arguments, face_pictures[i].name, path, sizeof path, fault);
            if (!error) {
                error = face_pictures[i].draw(&face, arguments->angle, path, fault);
            }
        }
    }
    return error;
}

static int draw_subject(const struct arguments *arguments, const struct iso_recording *recording,
                        struct sim_fit_subject *subject, struct iso_fault *fault)
{
    int error = 0;
    if (is_wanted(arguments, "fit")) {
        error = draw_fit(arguments, recording, subject, fault);
    }
    if (!error && strcmp(arguments->what, "fit") != 0) {
        error = draw_face(arguments, subject, fault);
    }
    return error;
}

/* Draws all wanted pictures that need the extractor. */
static int extract_and_draw(const struct arguments *arguments,
                            const struct iso_recording *recording, const struct iso_frame *frame,
                            struct iso_fault *fault)
{
    struct iso_head_model *model = NULL;
    struct iso_extractor *extractor = NULL;
    struct iso_extraction *extraction = NULL;
    int error = iso_head_model_load(arguments->model, &model, fault);
    if (error) {
        return error;
    }
    error = iso_extractor_new(model, &arguments->extract, &extractor);
    if (!error) {
        extraction = calloc(1, sizeof *extraction);
        error = extraction ? iso_extractor_run(extractor, frame, extraction) : -ENOMEM;
    }
    if (error) {
        (void)iso_fault_set(fault, error, "extractor: %s",
                            error == -EINVAL ? "an option is out of range" : strerror(-error));
    } else {
        struct sim_fit_subject subject = {
            .model = model, .extractor = extractor, .extraction = extraction, .frame = frame};
        error = draw_subject(arguments, recording, &subject, fault);
    }
    free(extraction);
    iso_extractor_free(extractor);
    iso_head_model_free(model);
    return error;
}

static int show_frame(const struct arguments *arguments, struct iso_fault *fault)
{
    struct iso_recording *recording = NULL;
    struct iso_frame *frame = NULL;
    int error = 0;
    if (strcmp(arguments->what, "all") == 0) {
        error = sim_make_directory(arguments->out, fault);
    }
    if (!error) {
        error = iso_recording_open(arguments->recording, &recording, fault);
    }
    if (error) {
        return error;
    }
    error = iso_recording_frame_new(recording, &frame);
    if (error) {
        (void)iso_fault_set(fault, error, "%s: out of memory", arguments->recording);
    } else {
        error = iso_recording_read(recording, arguments->frame, frame, fault);
    }
    if (!error && is_wanted(arguments, "depth")) {
        error = draw_depth(arguments, frame, fault);
    }
    if (!error && strcmp(arguments->what, "depth") != 0) {
        error = extract_and_draw(arguments, recording, frame, fault);
    }
    iso_frame_free(frame);
    iso_recording_close(recording);
    return error;
}

static int report_fault(const struct iso_fault *fault, int exit_code)
{
    fprintf(stderr, "isotherm-sim show: %s\n", fault->text);
    return exit_code;
}

int sim_cmd_show(int argc, char **argv)
{
    struct arguments arguments = {
        .what = "isotherms",
        .model = iso_shipped_model(),
        .angle = {.yaw_rad = -0.30, .pitch_rad = 0.06},
        .extract = iso_extract_options_default(),
    };
    const struct sim_option_set sets[] = {
        {own_options, sizeof own_options / sizeof *own_options, &arguments},
        sim_extract_option_set(&arguments.extract),
    };
    const size_t n_sets = sizeof sets / sizeof *sets;
    struct iso_fault fault = {.text = ""};
    switch (sim_options_parse(argc, argv, sets, n_sets, &fault)) {
    case SIM_OPTIONS_HELP:
        puts("Usage: isotherm-sim show --recording DIR --frame N --out FILE [OPTION...]\n\n"
             "Draws the depth of a frame, the head model fitted to it, or the mesh, the heat or\n"
             "the isotherms of its face.\n");
        sim_options_help(sets, n_sets, stdout);
        return SIM_EXIT_OK;
    case SIM_OPTIONS_REFUSED:
        return report_fault(&fault, SIM_EXIT_USAGE);
    case SIM_OPTIONS_READ:
        break;
    }
    if (!arguments.recording || !arguments.out) {
        (void)iso_fault_set(&fault, 0, "--recording and --out are needed");
        return report_fault(&fault, SIM_EXIT_USAGE);
    }
    if (!is_known(arguments.what)) {
        (void)iso_fault_set(&fault, 0, "--what: '%s' is unknown", arguments.what);
        return report_fault(&fault, SIM_EXIT_USAGE);
    }
    const int error = show_frame(&arguments, &fault);
    if (!error) {
        return SIM_EXIT_OK;
    }
    return report_fault(&fault,
                        error == -ENODATA ? SIM_EXIT_NO_MATCH : sim_command_exit_code(error));
}
