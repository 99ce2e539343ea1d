/* isotherm-sim sensor: measures the depth errors of a sensor model on faces, by distance. */
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>

#include "sim/base/make_directory.h"
#include "sim/base/options.h"
#include "sim/base/progress.h"
#include "sim/commands/commands.h"
#include "sim/lab/picture/depth.h"
#include "sim/lab/picture/depth_error.h"
#include "sim/world/scene/depth_error.h"

struct arguments {
    const char *ict, *sensor, *pictures;
    size_t faces, seed;
    double noise_scale, from_mm, to_mm, step_mm;
};

#define FIELD(name) offsetof(struct arguments, name)

static const struct sim_option options[] = {
    {"ict", "DIR", "the ICT-FaceKit head model", sim_option_text, FIELD(ict)},
    {"sensor", "NAME", "sensor model (see `isotherm-sim generate --help`)", sim_option_text,
     FIELD(sensor)},
    {"from", "MM", "nearest distance of the nose tip (400)", sim_option_number, FIELD(from_mm)},
    {"to", "MM", "farthest distance (1000)", sim_option_number, FIELD(to_mm)},
    {"step", "MM", "difference between two distances (100)", sim_option_number, FIELD(step_mm)},
    {"faces", "N", "faces at each distance (5)", sim_option_count, FIELD(faces)},
    {"seed", "S", "seed of all random numbers (1)", sim_option_count, FIELD(seed)},
    {"noise-scale", "X", "factor on the sensor's random errors (1)", sim_option_number,
     FIELD(noise_scale)},
    {"pictures", "DIR", "draw depth and error of the first face at each distance", sim_option_text,
     FIELD(pictures)},
};

struct pictures {
    const char *directory;
    int distance_mm;
    bool drawn;
    int error;
    struct iso_fault *fault;
};

static void show(void *context, const struct sim_view *view, const struct iso_frame *frame)
{
    struct pictures *to = context;
    char depth[PATH_MAX], wrong[PATH_MAX];
    if (to->drawn || !to->directory) {
        return;
    }
    to->drawn = true;
    (void)snprintf(depth, sizeof depth, "%s/%04d-depth.png", to->directory, to->distance_mm);
    (void)snprintf(wrong, sizeof wrong, "%s/%04d-error.png", to->directory, to->distance_mm);
    to->error = sim_picture_depth(frame, depth, to->fault);
    if (!to->error) {
        to->error = sim_picture_depth_error(view, frame, 3.0, wrong, to->fault);
    }
}

static int measure_all(const struct arguments *a, const struct sim_depth_error_options *measure,
                       struct pictures *pictures, struct iso_fault *fault)
{
    puts("distance   pixels  holes    bias     rms  median    95 %  > 5 mm");
    for (double at_mm = a->from_mm; at_mm <= a->to_mm + 1e-6; at_mm += a->step_mm) {
        struct sim_depth_error e;
        pictures->distance_mm = (int)at_mm;
        pictures->drawn = false;
        int error = sim_depth_error_measure(measure, at_mm, &e, fault);
        if (!error) {
            error = pictures->error;
        }
        if (error) {
            return error;
        }
        sim_progress_pause();
        printf("%5.0f mm  %7zu %5.1f %%  %+6.2f  %6.2f  %6.2f  %6.2f %6.2f %%\n", e.distance_mm,
               e.pixels, 100.0 * (double)e.holes / (double)e.pixels, e.bias_mm, e.rms_mm,
               e.median_mm, e.p95_mm, 100.0 * e.gross);
        (void)fflush(stdout);
        sim_progress_resume();
    }
    return 0;
}

static uint64_t count_faces(const struct arguments *a,
                            const struct sim_depth_error_options *measure)
{
    const double distances = floor((a->to_mm - a->from_mm + 1e-6) / a->step_mm) + 1.0;
    return (uint64_t)fmax(distances, 0.0) * measure->faces;
}

static int run(const struct arguments *a, struct iso_fault *fault)
{
    struct sim_ict *ict = NULL;
    struct pictures pictures = {.directory = a->pictures, .fault = fault};
    struct sim_depth_error_options measure = {.sensor = sim_sensor_find(a->sensor),
                                              .faces = a->faces,
                                              .seed = a->seed,
                                              .noise_scale = a->noise_scale,
                                              .show = show,
                                              .context = &pictures};
    int error = a->pictures ? sim_make_directory(a->pictures, fault) : 0;
    if (!error) {
        error = sim_sensor_load(measure.sensor, fault);
    }
    if (!error) {
        error = sim_ict_load(a->ict, &ict, fault);
    }
    if (!error) {
        measure.ict = ict;
        printf("%s: %s\nFaces: skin within %.0f mm of the nose tip, %zu at each distance; errors "
               "in mm\n",
               measure.sensor->name, measure.sensor->summary, SIM_DEPTH_ERROR_RADIUS_MM, a->faces);
        const bool shown = sim_progress_begin("rendering faces", count_faces(a, &measure));
        error = measure_all(a, &measure, &pictures, fault);
        sim_progress_end(shown);
    }
    sim_ict_free(ict);
    return error;
}

/* Describes what is wrong with the arguments. NULL if they are valid. */
static const char *find_flaw(const struct arguments *a)
{
    if (!a->ict || !a->sensor) {
        return "--ict and --sensor are needed";
    }
    if (!sim_sensor_find(a->sensor)) {
        return "--sensor: no such model";
    }
    if (!(a->from_mm >= 100.0 && a->to_mm <= 10000.0 && a->from_mm <= a->to_mm &&
          a->step_mm >= 1.0)) {
        return "--from, --to, --step: distances must rise, within 100..10000 mm";
    }
    if (a->faces < 1 || a->faces > 100 || !(a->noise_scale >= 0.0 && a->noise_scale <= 100.0)) {
        return "--faces must be 1..100, --noise-scale 0..100";
    }
    return NULL;
}

int sim_cmd_sensor(int argc, char **argv)
{
    struct arguments arguments = {.from_mm = 400.0,
                                  .to_mm = 1000.0,
                                  .step_mm = 100.0,
                                  .faces = 5,
                                  .seed = 1,
                                  .noise_scale = 1.0};
    const struct sim_option_set set = {options, sizeof options / sizeof *options, &arguments};
    struct iso_fault fault = {.text = ""};
    switch (sim_options_parse(argc, argv, &set, 1, &fault)) {
    case SIM_OPTIONS_HELP:
        puts("Usage: isotherm-sim sensor --ict DIR --sensor NAME [OPTION...]\n\n"
             "Renders faces at known depths through a sensor model, and prints the errors of its "
             "depths.\n");
        sim_options_help(&set, 1, stdout);
        return SIM_EXIT_OK;
    case SIM_OPTIONS_REFUSED:
        fprintf(stderr, "isotherm-sim sensor: %s\n", fault.text);
        return SIM_EXIT_USAGE;
    case SIM_OPTIONS_READ:
        break;
    }
    const char *flaw = find_flaw(&arguments);
    if (flaw) {
        fprintf(stderr, "isotherm-sim sensor: %s\n", flaw);
        return SIM_EXIT_USAGE;
    }
    const int error = run(&arguments, &fault);
    if (error) {
        fprintf(stderr, "isotherm-sim sensor: %s\n", fault.text);
        return error == -ENOENT ? SIM_EXIT_NOT_FOUND : SIM_EXIT_FAULT;
    }
    return SIM_EXIT_OK;
}
