#include "sim/world/generate/job.h"

#include <string.h>

#include "sim/world/generate/attacks.h"
#include "sim/world/generate/not_faces.h"
#include "sim/world/generate/stored.h"

/* ---- the presets attacks, not-faces and stored; each has its own recorder and header ---- */

static int count_or(int given, int otherwise)
{
    return given >= 0 ? given : otherwise;
}

static int rows_of_kind(const struct sim_job *job)
{
    return count_or(job->options->n_per_kind, job->preset->n_per_kind);
}

static struct sim_attacks_plan plan_attacks(const struct sim_job *job)
{
    const struct sim_generate_options *o = job->options;
    return (struct sim_attacks_plan){
        .population = o->population,
        .seed = o->seed,
        .identity_variance = sim_job_variance(job),
        .n_people = sim_job_people(job),
        .per_kind = rows_of_kind(job),
        .frames = sim_job_frames(job),
        .turn = job->preset->turn,
    };
}

static int record_attacks(const struct sim_job *job, struct iso_fault *fault)
{
    const struct sim_attacks_plan plan = plan_attacks(job);
    return sim_attacks_record(job->studio, job->ict, job->sensor, &plan, fault);
}

static int count_attacks(const struct sim_job *job)
{
    const struct sim_attacks_plan plan = plan_attacks(job);
    return sim_attacks_count(&plan);
}

static int record_not_faces(const struct sim_job *job, struct iso_fault *fault)
{
    return sim_not_faces_record(job->studio, job->ict, job->sensor, job->options->seed,
                                rows_of_kind(job), fault);
}

static int count_not_faces(const struct sim_job *job)
{
    return sim_not_faces_count(rows_of_kind(job));
}

static int record_stored(const struct sim_job *job, struct iso_fault *fault)
{
    return sim_stored_record(job->studio, job->ict, job->sensor, job->options->seed, fault);
}

static int count_stored(const struct sim_job *job)
{
    (void)job;
    return sim_stored_count();
}

static const struct sim_job_kind attacks = {record_attacks, count_attacks};
static const struct sim_job_kind not_faces = {record_not_faces, count_not_faces};
static const struct sim_job_kind stored = {record_stored, count_stored};

/* ---- the table ---- */

/* Fields shared by the presets of visits. */
#define VISITS                                                                     \
    .kind = &sim_job_visits, .n_people = 100, .n_strangers = 100, .n_probes = 400, \
    .frames_per_visit = 1, .noise_scale = 1.0, .png_level = 4

/* Fields shared by the presets of attacks. */
#define ATTACKS                                                                        \
    .kind = &attacks, .sensor = &sim_sensor_astra, .n_people = 100, .n_per_kind = 300, \
    .frames_per_visit = 15, .noise_scale = 1.0, .png_level = 4, .instruments = true

static const struct sim_preset presets[] = {
    {.name = "mild",
     VISITS,
     .sensor = &sim_sensor_astra,
     .expression = SIM_MILD,
     .gallery_pose = {.sd_rad = SIM_DEGREES(3)},
     .probe_pose = {.limit_rad = SIM_DEGREES(10)}},
    {.name = "strong",
     VISITS,
     .sensor = &sim_sensor_astra,
     .expression = SIM_STRONG,
     .gallery_pose = {.sd_rad = SIM_DEGREES(3)},
     .probe_pose = {.limit_rad = SIM_DEGREES(15)}},
    {.name = "crowd",
     VISITS,
     .sensor = &sim_sensor_astra,
     .expression = SIM_MILD,
     .gallery_pose = {.sd_rad = SIM_DEGREES(3)},
     .probe_pose = {.limit_rad = SIM_DEGREES(10)},
     .bystander = true},
    {.name = "pairs",
     .kind = &sim_job_pairs,
     .sensor = &sim_sensor_astra,
     .expression = SIM_MILD,
     .gallery_pose = {.sd_rad = SIM_DEGREES(3)},
     .probe_pose = {.limit_rad = SIM_DEGREES(10)},
     .n_people = 50,
     .n_strangers = 150,
     .n_probes = 150,
     .frames_per_visit = 12,
     .noise_scale = 1.0,
     .png_level = 4,
     .bystander = true},
    {.name = "texas",
     VISITS,
     .sensor = &sim_sensor_texas,
     .expression = SIM_MILD,
     .gallery_pose = {.sd_rad = SIM_DEGREES(2)},
     .probe_pose = {.limit_rad = SIM_DEGREES(5)}},
    {.name = "hard", /* people who look alike */
     VISITS,
     .sensor = &sim_sensor_astra,
     .expression = SIM_MILD,
     .gallery_pose = {.sd_rad = SIM_DEGREES(3)},
     .probe_pose = {.limit_rad = SIM_DEGREES(10)},
     .identity_variance = 0.36},
    {.name = "pose",
     VISITS,
     .sensor = &sim_sensor_astra,
     .expression = SIM_MILD,
     .gallery_pose = {.sd_rad = SIM_DEGREES(3)},
     .probe_pose = {.limit_rad = SIM_DEGREES(10), .disc_rad = SIM_DEGREES(35)}},
    {.name = "poses", /* as pose, and people are enrolled in every pose of an enrolment */
     .kind = &sim_job_poses,
     .sensor = &sim_sensor_astra,
     .expression = SIM_MILD,
     .gallery_pose = {.sd_rad = SIM_DEGREES(2)},
     .probe_pose = {.limit_rad = SIM_DEGREES(10), .disc_rad = SIM_DEGREES(35)},
     .n_people = 100,
     .n_strangers = 100,
     .n_probes = 400,
     .frames_per_visit = 1,
     .noise_scale = 1.0,
     .png_level = 4},
    {.name = "bowed", /* heads bent down or up; turned as in mild */
     VISITS,
     .sensor = &sim_sensor_astra,
     .expression = SIM_MILD,
     .gallery_pose = {.sd_rad = SIM_DEGREES(3)},
     .probe_pose = {.limit_rad = SIM_DEGREES(10), .pitch_limit_rad = SIM_DEGREES(35)}},
    {.name = "far",
     VISITS,
     .sensor = &sim_sensor_astra,
     .expression = SIM_MILD,
     .gallery_pose = {.sd_rad = SIM_DEGREES(3)},
     .probe_pose = {.limit_rad = SIM_DEGREES(10)},
     .near_mm = 900.0,
     .far_mm = 1200.0},
    {.name = "landmarks",
     .kind = &sim_job_repeats,
     .sensor = &sim_sensor_astra,
     .expression = SIM_STRONG,
     .probe_pose = {.limit_rad = SIM_DEGREES(15)}, /* and the disc that the options give */
     .n_people = 100,
     .n_sessions = 24, /* over 600 of 2400 lie beyond 25 degrees */
     .frames_per_visit = 1,
     .noise_scale = 2.5,
     .png_level = 4},
    {.name = "training", /* sessions of a person: neutral, mild, then all strong */
     .kind = &sim_job_repeats,
     .sensor = &sim_sensor_truedepth,
     .expression = SIM_STRONG,
     .probe_pose = {.limit_rad = SIM_DEGREES(10)}, /* and the disc that the options give */
     .rest_sessions = 2,
     .n_people = 1000,
     .n_sessions = 5,
     .frames_per_visit = 1,
     .noise_scale = 1.0,
     .png_level = 4},
    {.name = "attacks", ATTACKS},
    {.name = "attacks-turned",
     ATTACKS,
     .turn = {.away = true, .yaw_least_deg = 25.0, .yaw_most_deg = 40.0, .pitch_most_deg = 30.0}},
    {.name = "not-faces",
     .kind = &not_faces,
     .sensor = &sim_sensor_astra,
     .n_per_kind = 200,
     .noise_scale = 1.0,
     .png_level = 4,
     .instruments = true},
    {.name = "stored",
     .kind = &stored,
     .sensor = &sim_sensor_astra,
     .noise_scale = 1.0,
     .png_level = 9,
     .instruments = true},
};

const struct sim_preset *sim_preset_find(const char *name)
{
    for (size_t i = 0; i < sizeof presets / sizeof *presets; i++) {
        if (strcmp(presets[i].name, name) == 0) {
            return &presets[i];
        }
    }
    return NULL;
}

/* ---- values of the options or the preset ---- */

int sim_job_people(const struct sim_job *job)
{
    return count_or(job->options->n_people, job->preset->n_people);
}

int sim_job_strangers(const struct sim_job *job)
{
    return count_or(job->options->n_strangers, job->preset->n_strangers);
}

int sim_job_probes(const struct sim_job *job)
{
    return count_or(job->options->n_probes, job->preset->n_probes);
}

int sim_job_sessions(const struct sim_job *job)
{
    return count_or(job->options->n_sessions, job->preset->n_sessions);
}

int sim_job_frames(const struct sim_job *job)
{
    const int given = job->options->frames_per_visit;
    return given > 0 ? given : job->preset->frames_per_visit;
}

double sim_job_variance(const struct sim_job *job)
{
    const double given = job->options->identity_variance;
    const double own = job->preset->identity_variance;
    if (given >= 0.0) {
        return given;
    }
    return own > 0.0 ? own : 1.0;
}
