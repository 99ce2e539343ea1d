#include "sim/world/generate/generate.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "sim/base/progress.h"
#include "sim/world/generate/attacks.h"
#include "sim/world/generate/not_faces.h"
#include "sim/world/generate/session.h"
#include "sim/world/generate/stored.h"

#define DEGREES(x) ((x)*0.017453292519943295)

struct job;

struct preset {
    const char *name;
    /* Records all of it. */
    int (*record)(struct job *job, struct iso_fault *fault);
    const struct sim_sensor *sensor;
    enum sim_expression expression; /* of probes and strangers; the gallery is neutral */
    struct sim_pose_range gallery_pose, probe_pose;
    int n_people, n_strangers, n_probes, n_sessions, n_per_kind, frames_per_visit;
    int rest_sessions; /* of "training": the first of everybody are neutral, then mild */
    double noise_scale, identity_variance; /* 0: the head model's own */
    double near_mm,
        far_mm; /* of later visits and strangers, in place of the sensor's; 0: its own */
    int png_level;
    bool bystander;   /* in visits */
    bool instruments; /* a sensor that sees nothing but skin is of no use */
};

struct job {
    const struct sim_generate_options *options;
    const struct preset *preset;
    const struct sim_sensor *sensor;
    struct sim_ict *ict;
    struct sim_studio *studio;
};

static int record_visits(struct job *job, struct iso_fault *fault);
static int record_pairs(struct job *job, struct iso_fault *fault);
static int record_repeats(struct job *job, struct iso_fault *fault);
static int record_attacks(struct job *job, struct iso_fault *fault);
static int record_not_faces(struct job *job, struct iso_fault *fault);
static int record_stored(struct job *job, struct iso_fault *fault);

/* What presets of visits have in common. */
#define VISITS                                                                     \
    .record = record_visits, .n_people = 100, .n_strangers = 100, .n_probes = 400, \
    .frames_per_visit = 1, .noise_scale = 1.0, .png_level = 4

static const struct preset presets[] = {
    {.name = "mild",
     VISITS,
     .sensor = &sim_sensor_astra,
     .expression = SIM_MILD,
     .gallery_pose = {DEGREES(3), 0, 0},
     .probe_pose = {0, DEGREES(10), 0}},
    {.name = "strong",
     VISITS,
     .sensor = &sim_sensor_astra,
     .expression = SIM_STRONG,
     .gallery_pose = {DEGREES(3), 0, 0},
     .probe_pose = {0, DEGREES(15), 0}},
    {.name = "crowd",
     VISITS,
     .sensor = &sim_sensor_astra,
     .expression = SIM_MILD,
     .gallery_pose = {DEGREES(3), 0, 0},
     .probe_pose = {0, DEGREES(10), 0},
     .bystander = true},
    {.name = "pairs",
     .record = record_pairs,
     .sensor = &sim_sensor_astra,
     .expression = SIM_MILD,
     .gallery_pose = {DEGREES(3), 0, 0},
     .probe_pose = {0, DEGREES(10), 0},
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
     .gallery_pose = {DEGREES(2), 0, 0},
     .probe_pose = {0, DEGREES(5), 0}},
    {.name = "hard", /* people who look alike */
     VISITS,
     .sensor = &sim_sensor_astra,
     .expression = SIM_MILD,
     .gallery_pose = {DEGREES(3), 0, 0},
     .probe_pose = {0, DEGREES(10), 0},
     .identity_variance = 0.36},
    {.name = "pose",
     VISITS,
     .sensor = &sim_sensor_astra,
     .expression = SIM_MILD,
     .gallery_pose = {DEGREES(3), 0, 0},
     .probe_pose = {0, DEGREES(10), DEGREES(35)}},
    {.name = "far",
     VISITS,
     .sensor = &sim_sensor_astra,
     .expression = SIM_MILD,
     .gallery_pose = {DEGREES(3), 0, 0},
     .probe_pose = {0, DEGREES(10), 0},
     .near_mm = 900.0,
     .far_mm = 1200.0},
    {.name = "landmarks",
     .record = record_repeats,
     .sensor = &sim_sensor_astra,
     .expression = SIM_STRONG,
     .probe_pose = {0, DEGREES(15), 0}, /* and the disc that the options give */
     .n_people = 100,
     .n_sessions = 24, /* over 600 of 2400 lie beyond 25 degrees */
     .frames_per_visit = 1,
     .noise_scale = 2.5,
     .png_level = 4},
    {.name = "training", /* each person at rest, then mildly, then strongly moved */
     .record = record_repeats,
     .sensor = &sim_sensor_truedepth,
     .expression = SIM_STRONG,
     .probe_pose = {0, DEGREES(10), 0}, /* and the disc that the options give */
     .rest_sessions = 2,
     .n_people = 1000,
     .n_sessions = 5,
     .frames_per_visit = 1,
     .noise_scale = 1.0,
     .png_level = 4},
    {.name = "attacks",
     .record = record_attacks,
     .sensor = &sim_sensor_astra,
     .n_people = 100,
     .n_per_kind = 300,
     .frames_per_visit = 15,
     .noise_scale = 1.0,
     .png_level = 4,
     .instruments = true},
    {.name = "not-faces",
     .record = record_not_faces,
     .sensor = &sim_sensor_astra,
     .n_per_kind = 200,
     .noise_scale = 1.0,
     .png_level = 4,
     .instruments = true},
    {.name = "stored",
     .record = record_stored,
     .sensor = &sim_sensor_astra,
     .noise_scale = 1.0,
     .png_level = 9,
     .instruments = true},
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
        .n_sessions = -1,
        .n_per_kind = -1,
        .pose_limit_rad = DEGREES(35),
        .frames_per_visit = 0,
        .noise_scale = -1.0,
        .identity_variance = -1.0,
    };
}

static int count_or(int given, int otherwise)
{
    return given >= 0 ? given : otherwise;
}

static int frames_of(const struct job *job)
{
    int given = job->options->frames_per_visit;
    return given > 0 ? given : job->preset->frames_per_visit;
}

static double variance_of(const struct job *job)
{
    double given = job->options->identity_variance, own = job->preset->identity_variance;
    return given >= 0.0 ? given : own > 0.0 ? own : 1.0;
}

/* The face a person makes: the gallery neutral; where there are sessions of rest, the first of them
 * is neutral too and the others mild. */
static enum sim_expression expression_of(const struct preset *preset, enum sim_role role,
                                         int session)
{
    if (role == SIM_ROLE_GALLERY || (preset->rest_sessions > 0 && session == 1)) {
        return SIM_NEUTRAL;
    }
    return session <= preset->rest_sessions ? SIM_MILD : preset->expression;
}

static struct sim_person person_of(const struct job *job, int index)
{
    const struct sim_generate_options *o = job->options;
    return sim_person_draw(o->population, o->seed, (uint32_t)index, variance_of(job));
}

/* A session of person `index`; its number makes its name and its randomness. */
static struct sim_session_plan plan_of(const struct job *job, char letter, int index, int session,
                                       enum sim_role role)
{
    const struct preset *preset = job->preset;
    const struct sim_generate_options *o = job->options;
    bool gallery = role == SIM_ROLE_GALLERY, placed = o->far_mm > 0.0;
    struct sim_session_plan plan = {
        .row = {.role = role, .count = (size_t)frames_of(job)},
        .person = person_of(job, index),
        .expression = expression_of(preset, role, session),
        .pose = gallery ? preset->gallery_pose : preset->probe_pose,
        .near_mm = gallery  ? 0.0
                   : placed ? o->near_mm
                            : preset->near_mm,
        .far_mm = gallery  ? 0.0
                  : placed ? o->far_mm
                           : preset->far_mm,
        .sway = 1.0,
        .bystander = !gallery && preset->bystander,
        .open_hall = !gallery && preset->bystander, /* a wall might stand before the bystander */
    };
    if (preset->record == record_repeats) {
        plan.pose.disc_rad = job->options->pose_limit_rad;
    }
    (void)snprintf(plan.row.subject, sizeof plan.row.subject, "%c%04d", letter, index);
    (void)snprintf(plan.row.session, sizeof plan.row.session, "s%d", session);
    /* Who is in the corpus: what is learned from it must not be tested with it. */
    (void)snprintf(plan.row.note, sizeof plan.row.note, "%s-%" PRIu64, job->options->population,
                   job->options->seed);
    plan.random = sim_random_seeded(plan.person.key, sim_random_hash(preset->name),
                                    (uint64_t)session);
    return plan;
}

static int record(struct job *job, char letter, int index, int session, enum sim_role role,
                  struct iso_fault *fault)
{
    const struct sim_session_plan plan = plan_of(job, letter, index, session, role);
    return sim_session_record(job->studio, job->ict, job->sensor, &plan, fault);
}

/* A neutral session of everybody who is enrolled, later ones of them, and strangers. */
static int record_visits(struct job *job, struct iso_fault *fault)
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

/* A visit of person `index` with another one close behind; what that one is stands in the note,
 * after the origin. */
static int record_pair(struct job *job, int index, int session, enum sim_role role, int behind,
                       const char *note, struct iso_fault *fault)
{
    const char letter = role == SIM_ROLE_IMPOSTOR ? 'x' : 'p';
    const struct sim_person other = person_of(job, behind);
    struct sim_session_plan plan = plan_of(job, letter, index, session, role);
    plan.behind = &other;
    plan.behind_min_mm = 200.0;
    const size_t origin = strlen(plan.row.note);
    (void)snprintf(plan.row.note + origin, sizeof plan.row.note - origin, " %s", note);
    return sim_session_record(job->studio, job->ict, job->sensor, &plan, fault);
}

/* Everybody who is enrolled, and visits of two: an enrolled person with a stranger or with another
 * enrolled one behind, in turns; a stranger with an enrolled one behind. */
static int record_pairs(struct job *job, struct iso_fault *fault)
{
    int people = count_or(job->options->n_people, job->preset->n_people);
    int strangers = count_or(job->options->n_strangers, job->preset->n_strangers);
    int probes = count_or(job->options->n_probes, job->preset->n_probes);
    int error = 0;
    for (int i = 0; error == 0 && i < people; i++) {
        struct sim_session_plan plan = plan_of(job, 'p', i, 0, SIM_ROLE_GALLERY);
        plan.row.count *= 3; /* an enrolment takes its time */
        error = sim_session_record(job->studio, job->ict, job->sensor, &plan, fault);
    }
    for (int i = 0; error == 0 && i < probes; i++) {
        const bool known = i % 2 != 0 && people > 1;
        const int behind = known ? (i + 1) % people : people + strangers + i;
        error = record_pair(job, i % people, 1 + i / people, SIM_ROLE_PROBE, behind,
                            known ? "enrolled-behind" : "stranger-behind", fault);
    }
    for (int i = 0; error == 0 && i < strangers; i++) {
        error = record_pair(job, people + i, 1, SIM_ROLE_IMPOSTOR, i % people, "enrolled-behind",
                            fault);
    }
    return error;
}

/* The same sessions of everybody, and nobody enrolled. */
static int record_repeats(struct job *job, struct iso_fault *fault)
{
    int people = count_or(job->options->n_people, job->preset->n_people);
    int sessions = count_or(job->options->n_sessions, job->preset->n_sessions);
    int error = 0;
    for (int i = 0; error == 0 && i < people * sessions; i++) {
        error = record(job, 'p', i / sessions, 1 + i % sessions, SIM_ROLE_PROBE, fault);
    }
    return error;
}

static struct sim_attacks_plan plan_attacks(const struct job *job)
{
    const struct sim_generate_options *o = job->options;
    return (struct sim_attacks_plan){
        .population = o->population,
        .seed = o->seed,
        .identity_variance = variance_of(job),
        .n_people = count_or(o->n_people, job->preset->n_people),
        .per_kind = count_or(o->n_per_kind, job->preset->n_per_kind),
        .frames = frames_of(job),
    };
}

static int record_attacks(struct job *job, struct iso_fault *fault)
{
    const struct sim_attacks_plan plan = plan_attacks(job);
    return sim_attacks_record(job->studio, job->ict, job->sensor, &plan, fault);
}

static int per_kind_of(const struct job *job)
{
    return count_or(job->options->n_per_kind, job->preset->n_per_kind);
}

static int record_not_faces(struct job *job, struct iso_fault *fault)
{
    return sim_not_faces_record(job->studio, job->ict, job->sensor, job->options->seed,
                                per_kind_of(job), fault);
}

static int record_stored(struct job *job, struct iso_fault *fault)
{
    return sim_stored_record(job->studio, job->ict, job->sensor, job->options->seed, fault);
}

/* How many recordings a preset makes. */
static uint64_t count_recordings(const struct job *job)
{
    const struct sim_generate_options *o = job->options;
    const struct preset *preset = job->preset;
    const int people = count_or(o->n_people, preset->n_people);
    int n = 0;
    if (preset->record == record_visits || preset->record == record_pairs) {
        n = people + count_or(o->n_strangers, preset->n_strangers) +
            count_or(o->n_probes, preset->n_probes);
    } else if (preset->record == record_repeats) {
        n = people * count_or(o->n_sessions, preset->n_sessions);
    } else if (preset->record == record_attacks) {
        const struct sim_attacks_plan plan = plan_attacks(job);
        n = sim_attacks_count(&plan);
    } else if (preset->record == record_not_faces) {
        n = sim_not_faces_count(per_kind_of(job));
    } else if (preset->record == record_stored) {
        n = sim_stored_count();
    }
    return (uint64_t)n;
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

static int check(const struct sim_generate_options *o, struct iso_fault *fault)
{
    const struct preset *preset = find_preset(o->preset);
    if (!preset) {
        return iso_fault_set(fault, -EINVAL, "unknown preset '%s'", o->preset);
    }
    int error = check_counts(o, fault);
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
    if (!(o->pose_limit_rad > 0.0 && o->pose_limit_rad <= DEGREES(90))) {
        return iso_fault_set(fault, -EINVAL, "pose limit outside 0..90 degrees");
    }
    if (preset->instruments && o->sensor && o->sensor->face_only) {
        return iso_fault_set(fault, -EINVAL, "sensor %s sees nothing but faces: useless for %s",
                             o->sensor->name, preset->name);
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
    double noise_scale = options->noise_scale;
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
        const bool shown = sim_progress_begin("rendering recordings", count_recordings(&job));
        error = job.preset->record(&job, fault);
        sim_progress_end(shown);
    }
    if (error == 0) {
        error = sim_studio_finish(job.studio, fault);
    }
    sim_studio_free(job.studio);
    sim_ict_free(job.ict);
    return error;
}
