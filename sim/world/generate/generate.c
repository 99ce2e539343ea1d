#include "sim/world/generate/generate.h"

#include <errno.h>
#include <math.h>

#include "sim/base/progress.h"
#include "sim/world/generate/job.h"

struct sim_generate_options sim_generate_options_default(void)
{
    return (struct sim_generate_options){
        .preset = "mild",
        .population = SIM_POPULATION_TEST,
        .seed = 1,
        .n_people = -1,
        .n_strangers = -1,
        .n_probes = -1,
        .n_sessions = -1,
        .n_per_kind = -1,
        .pose_limit_rad = SIM_DEGREES(35),
        .frames_per_visit = 0,
        .noise_scale = -1.0,
        .identity_variance = -1.0,
    };
}

static int check_counts(const struct sim_generate_options *o, struct iso_fault *fault)
{
    if (o->n_people == 0 || o->n_people > 9999 || o->n_strangers > 9999 || o->n_probes > 99999 ||
        o->frames_per_visit > 999) {
        return iso_fault_set(fault, -EINVAL, "number of people, probes or frames out of range");
    }
    if (o->n_sessions == 0 || o->n_sessions > 9999 || o->n_per_kind == 0 || o->n_per_kind > 9999) {
        return iso_fault_set(fault, -EINVAL, "number of sessions or of a kind out of range");
    }
    return 0;
}

static int check_options(const struct sim_generate_options *o, struct iso_fault *fault)
{
    const struct sim_preset *preset = sim_preset_find(o->preset);
    if (!preset) {
        return iso_fault_set(fault, -EINVAL, "unknown preset '%s'", o->preset);
    }
    const int error = check_counts(o, fault);
    if (error != 0) {
        return error;
    }
    if (isnan(o->noise_scale) || o->noise_scale > 100.0 || isnan(o->identity_variance) ||
        o->identity_variance > 100.0) {
        return iso_fault_set(fault, -EINVAL, "noise scale or identity variance outside 0..100");
    }
    if ((o->near_mm != 0.0 || o->far_mm != 0.0) &&
        !(o->near_mm >= 100.0 && o->far_mm >= o->near_mm && o->far_mm <= 10000.0)) {
        return iso_fault_set(fault, -EINVAL, "near and far: both, within 100..10000 mm, rising");
    }
    if (!(o->pose_limit_rad > 0.0 && o->pose_limit_rad <= SIM_DEGREES(90))) {
        return iso_fault_set(fault, -EINVAL, "pose limit outside 0..90 degrees");
    }
    if (!(o->pitch_limit_rad >= 0.0 && o->pitch_limit_rad <= SIM_DEGREES(90))) {
        return iso_fault_set(fault, -EINVAL, "pitch limit outside 0..90 degrees");
    }
    if (preset->instruments && o->sensor && o->sensor->face_only) {
        return iso_fault_set(fault, -EINVAL, "sensor %s sees only faces and cannot be used for %s",
                             o->sensor->name, preset->name);
    }
    return 0;
}

int sim_generate(const struct sim_generate_options *options, struct iso_fault *fault)
{
    int error = check_options(options, fault);
    if (error != 0) {
        return error;
    }
    struct sim_job job = {.options = options, .preset = sim_preset_find(options->preset)};
    const double noise_scale = options->noise_scale;
    job.sensor = options->sensor ? options->sensor : job.preset->sensor;
    error = sim_sensor_load(job.sensor, fault);
    if (error == 0) {
        error = sim_ict_load(options->ict_directory, &job.ict, fault);
    }
    if (error == 0) {
        struct sim_studio_options studio = {
            .ict = job.ict,
            .sensor = job.sensor,
            .directory = options->directory,
            .noise_scale = noise_scale >= 0.0 ? noise_scale : job.preset->noise_scale,
            .png_level = job.preset->png_level,
            .marks = options->marks,
            .infrared = options->infrared,
        };
        error = sim_studio_new(&studio, &job.studio, fault);
    }
    if (error == 0) {
        const bool shown = sim_progress_begin("rendering recordings",
                                              (uint64_t)job.preset->kind->count(&job));
        error = job.preset->kind->record(&job, fault);
        sim_progress_end(shown);
    }
    if (error == 0) {
        error = sim_studio_finish(job.studio, fault);
    }
    sim_studio_free(job.studio);
    sim_ict_free(job.ict);
    return error;
}
