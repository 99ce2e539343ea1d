#include "sim/generate/generate.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "sim/generate/session.h"
#include "sim/generate/stored.h"

#define DEGREES(x) ((x)*0.017453292519943295)

struct preset {
    const char *name;
    const struct sim_sensor *sensor;
    enum sim_expression expression; /* of probes and strangers; the gallery is neutral */
    struct sim_pose_range gallery_pose, probe_pose;
    int n_people, n_strangers, n_probes, frames_per_visit;
    bool bystander; /* in visits */
};

static const struct preset presets[] = {
    {"mild",
     &sim_sensor_astra,
     SIM_MILD,
     {DEGREES(3), 0},
     {0, DEGREES(10)},
     100,
     100,
     200,
     1,
     false},
    {"strong",
     &sim_sensor_astra,
     SIM_STRONG,
     {DEGREES(3), 0},
     {0, DEGREES(15)},
     100,
     100,
     200,
     1,
     false},
    {"crowd",
     &sim_sensor_astra,
     SIM_MILD,
     {DEGREES(3), 0},
     {0, DEGREES(10)},
     100,
     100,
     200,
     1,
     true},
    {"texas",
     &sim_sensor_texas,
     SIM_MILD,
     {DEGREES(2), 0},
     {0, DEGREES(5)},
     100,
     100,
     200,
     1,
     false},
};

struct job {
    const struct sim_generate_options *options;
    const struct preset *preset;
    const struct sim_sensor *sensor;
    struct sim_ict *ict;
    struct sim_studio *studio;
};

struct sim_generate_options sim_generate_options_default(void)
{
    return (struct sim_generate_options){
        .preset = "mild",
        .population = SIM_POPULATION_TEST,
        .seed = 1,
        .n_people = -1,
        .n_strangers = -1,
        .n_probes = -1,
        .frames_per_visit = 0,
        .noise_scale = 1.0,
        .identity_variance = 1.0,
    };
}

/* One session of person `index`; the number of the session makes its name and its randomness. */
static int record(struct job *job, char letter, int index, int session, enum sim_role role,
                  struct iso_fault *fault)
{
    const struct sim_generate_options *o = job->options;
    const struct preset *preset = job->preset;
    int frames = o->frames_per_visit > 0 ? o->frames_per_visit : preset->frames_per_visit;
    bool gallery = role == SIM_ROLE_GALLERY;
    struct sim_session_plan plan = {
        .row = {.role = role, .count = (size_t)frames},
        .person = sim_person_draw(o->population, o->seed, (uint32_t)index, o->identity_variance),
        .expression = gallery ? SIM_NEUTRAL : preset->expression,
        .pose = gallery ? preset->gallery_pose : preset->probe_pose,
        .bystander = !gallery && preset->bystander,
        .open_hall = !gallery && preset->bystander, /* a wall might stand before the bystander */
    };
    (void)snprintf(plan.row.subject, sizeof plan.row.subject, "%c%04d", letter, index);
    (void)snprintf(plan.row.session, sizeof plan.row.session, "s%d", session);
    plan.random = sim_random_seeded(plan.person.key, sim_random_hash(preset->name),
                                    (uint64_t)session);
    return sim_session_record(job->studio, job->ict, job->sensor, &plan, fault);
}

static int count_or(int given, int otherwise)
{
    return given >= 0 ? given : otherwise;
}

static int record_all(struct job *job, struct iso_fault *fault)
{
    int people = count_or(job->options->n_people, job->preset->n_people);
    int strangers = count_or(job->options->n_strangers, job->preset->n_strangers);
    int probes = count_or(job->options->n_probes, job->preset->n_probes);
    int error = 0;
    for (int i = 0; error == 0 && i < people; i++) {
        error = record(job, 'p', i, 0, SIM_ROLE_GALLERY, fault);
    }
    for (int i = 0; error == 0 && i < probes; i++) {
        error = record(job, 'p', i % people, 1 + i / people, SIM_ROLE_PROBE, fault);
    }
    for (int i = 0; error == 0 && i < strangers; i++) {
        error = record(job, 'x', people + i, 1, SIM_ROLE_IMPOSTOR, fault);
    }
    return error;
}

static const struct preset *find_preset(const char *name)
{
    for (size_t i = 0; i < sizeof presets / sizeof *presets; i++) {
        if (strcmp(presets[i].name, name) == 0) {
            return &presets[i];
        }
    }
    return NULL;
}

static int check(const struct sim_generate_options *o, struct iso_fault *fault)
{
    if (!find_preset(o->preset) && strcmp(o->preset, "stored") != 0) {
        return iso_fault_set(fault, -EINVAL, "unknown preset '%s'", o->preset);
    }
    if (o->n_people == 0 || o->n_people > 9999 || o->n_strangers > 9999 || o->n_probes > 99999 ||
        o->frames_per_visit > 999) {
        return iso_fault_set(fault, -EINVAL, "number of people, probes or frames out of range");
    }
    if (!(o->noise_scale >= 0.0 && o->noise_scale <= 100.0) ||
        !(o->identity_variance >= 0.0 && o->identity_variance <= 100.0)) {
        return iso_fault_set(fault, -EINVAL, "noise scale or identity variance outside 0..100");
    }
    return 0;
}

int sim_generate(const struct sim_generate_options *options, struct iso_fault *fault)
{
    int error = check(options, fault);
    if (error != 0) {
        return error;
    }
    struct job job = {.options = options, .preset = find_preset(options->preset)};
    const struct sim_sensor *own = job.preset ? job.preset->sensor : &sim_sensor_astra;
    job.sensor = options->sensor ? options->sensor : own;
    error = sim_ict_load(options->ict_directory, &job.ict, fault);
    if (error == 0) {
        struct sim_studio_options studio = {job.ict, job.sensor, options->directory,
                                            options->noise_scale, job.preset ? 4 : 9};
        error = sim_studio_new(&studio, &job.studio, fault);
    }
    if (error == 0) {
        error = job.preset
                    ? record_all(&job, fault)
                    : sim_stored_record(job.studio, job.ict, job.sensor, options->seed, fault);
    }
    if (error == 0) {
        error = sim_studio_finish(job.studio, fault);
    }
    sim_studio_free(job.studio);
    sim_ict_free(job.ict);
    return error;
}
