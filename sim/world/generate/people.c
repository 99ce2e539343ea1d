#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "sim/world/generate/job.h"

/* The expression in a session. The gallery is neutral. If the preset has sessions of rest, the
 * first of them is neutral too and the others are mild; later sessions have the preset's
 * expression. */
static enum sim_expression expression_of(const struct sim_preset *preset, enum sim_role role,
                                         int session)
{
    if (role == SIM_ROLE_GALLERY || (preset->rest_sessions > 0 && session == 1)) {
        return SIM_NEUTRAL;
    }
    return session <= preset->rest_sessions ? SIM_MILD : preset->expression;
}

static struct sim_person person_of(const struct sim_job *job, int index)
{
    const struct sim_generate_options *o = job->options;
    return sim_person_draw(o->population, o->seed, (uint32_t)index, sim_job_variance(job));
}

/* A session of person `index`. Its number determines its name and its random draws. */
static struct sim_session_plan plan_of(const struct sim_job *job, char letter, int index,
                                       int session, enum sim_role role)
{
    const struct sim_preset *preset = job->preset;
    const struct sim_generate_options *o = job->options;
    const bool gallery = role == SIM_ROLE_GALLERY;
    const bool placed = o->far_mm > 0.0;
    struct sim_session_plan plan = {
        .row = {.role = role, .count = (size_t)sim_job_frames(job)},
        .person = person_of(job, index),
        .expression = expression_of(preset, role, session),
        .pose = gallery ? preset->gallery_pose : preset->probe_pose,
        .sway = 1.0,
        .keeps_hair = o->keeps_hair,
        .bystander = !gallery && preset->bystander,
        .open_hall = !gallery && preset->bystander, /* a wall might stand before the bystander */
    };
    if (!gallery) {
        plan.near_mm = placed ? o->near_mm : preset->near_mm;
        plan.far_mm = placed ? o->far_mm : preset->far_mm;
    }
    (void)snprintf(plan.row.subject, sizeof plan.row.subject, "%c%04d", letter, index);
    (void)snprintf(plan.row.session, sizeof plan.row.session, "s%d", session);
    /* The origin of the people: a corpus for learning must not share people with a corpus for
     * tests. */
    (void)snprintf(plan.row.note, sizeof plan.row.note, "%s-%" PRIu64, o->population, o->seed);
    plan.random = sim_random_seeded(plan.person.key, sim_random_hash(preset->name),
                                    (uint64_t)session);
    return plan;
}

static int record_session(const struct sim_job *job, char letter, int index, int session,
                          enum sim_role role, struct iso_fault *fault)
{
    const struct sim_session_plan plan = plan_of(job, letter, index, session, role);
    return sim_session_record(job->studio, job->ict, job->sensor, &plan, fault);
}

/* Records later sessions of the enrolled people, then the strangers. */
static int record_later_visits(const struct sim_job *job, struct iso_fault *fault)
{
    const int people = sim_job_people(job);
    const int strangers = sim_job_strangers(job);
    const int probes = sim_job_probes(job);
    int error = 0;
    for (int i = 0; error == 0 && i < probes; i++) {
        error = record_session(job, 'p', i % people, 1 + i / people, SIM_ROLE_PROBE, fault);
    }
    for (int i = 0; error == 0 && i < strangers; i++) {
        error = record_session(job, 'x', people + i, 1, SIM_ROLE_IMPOSTOR, fault);
    }
    return error;
}

/* Records a neutral session of each enrolled person, then the visits. */
static int record_visits(const struct sim_job *job, struct iso_fault *fault)
{
    const int people = sim_job_people(job);
    int error = 0;
    for (int i = 0; error == 0 && i < people; i++) {
        error = record_session(job, 'p', i, 0, SIM_ROLE_GALLERY, fault);
    }
    return error == 0 ? record_later_visits(job, fault) : error;
}

/* The poses of an enrolment, as firmware/recognise/enroll_pose.h has them: yaw above 0 is to the
 * subject's left, pitch above 0 is up. */
static const struct {
    const char *suffix;
    double yaw_rad, pitch_rad;
} poses[] = {
    {"left", SIM_DEGREES(18), 0},
    {"right", SIM_DEGREES(-18), 0},
    {"down", 0, SIM_DEGREES(-15)},
    {"up", 0, SIM_DEGREES(15)},
};

enum { N_POSES = sizeof poses / sizeof *poses };

/* Records the enrolment of a person: the frontal row, with the role gallery, and rows of the same
 * session in the other poses. All of them use the same random numbers, so that the hair is the
 * same, too. */
static int record_enrolment(const struct sim_job *job, int index, struct iso_fault *fault)
{
    struct sim_session_plan plan = plan_of(job, 'p', index, 0, SIM_ROLE_GALLERY);
    const struct sim_corpus_row row = plan.row;
    plan.open_hall = true;
    int error = sim_session_record(job->studio, job->ict, job->sensor, &plan, fault);
    for (int i = 0; error == 0 && i < N_POSES; i++) {
        (void)snprintf(plan.row.recording, sizeof plan.row.recording, "%.20s-%.20s-%s", row.subject,
                       row.session, poses[i].suffix);
        plan.row.role = SIM_ROLE_PROBE;
        plan.yaw_rad = poses[i].yaw_rad;
        plan.pitch_rad = poses[i].pitch_rad;
        error = sim_session_record(job->studio, job->ict, job->sensor, &plan, fault);
    }
    return error;
}

/* Records the enrolment in every pose, then visits as record_visits() does. */
static int record_poses(const struct sim_job *job, struct iso_fault *fault)
{
    const int people = sim_job_people(job);
    int error = 0;
    for (int i = 0; error == 0 && i < people; i++) {
        error = record_enrolment(job, i, fault);
    }
    return error == 0 ? record_later_visits(job, fault) : error;
}

/* Records a visit of person `index` with person `behind` close behind. `note` describes the second
 * person; it follows the origin in the row's note. */
static int record_pair(const struct sim_job *job, int index, int session, enum sim_role role,
                       int behind, const char *note, struct iso_fault *fault)
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

/* Records the enrolments, then visits of two people: an enrolled person with a stranger or another
 * enrolled person behind, alternately; and a stranger with an enrolled person behind. */
static int record_pairs(const struct sim_job *job, struct iso_fault *fault)
{
    const int people = sim_job_people(job);
    const int strangers = sim_job_strangers(job);
    const int probes = sim_job_probes(job);
    int error = 0;
    for (int i = 0; error == 0 && i < people; i++) {
        struct sim_session_plan plan = plan_of(job, 'p', i, 0, SIM_ROLE_GALLERY);
        plan.row.count *= 3; /* an enrolment needs more frames */
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

/* Records equally many sessions of each person. Nobody is enrolled. */
static int record_repeats(const struct sim_job *job, struct iso_fault *fault)
{
    const int people = sim_job_people(job);
    const int sessions = sim_job_sessions(job);
    int error = 0;
    for (int i = 0; error == 0 && i < people * sessions; i++) {
        struct sim_session_plan plan = plan_of(job, 'p', i / sessions, 1 + i % sessions,
                                               SIM_ROLE_PROBE);
        plan.pose.disc_rad = job->options->pose_limit_rad;
        plan.pose.disc_pitch_rad = job->options->pitch_limit_rad;
        error = sim_session_record(job->studio, job->ict, job->sensor, &plan, fault);
    }
    return error;
}

static int count_visits(const struct sim_job *job)
{
    return sim_job_people(job) + sim_job_strangers(job) + sim_job_probes(job);
}

static int count_poses(const struct sim_job *job)
{
    return N_POSES * sim_job_people(job) + count_visits(job);
}

static int count_repeats(const struct sim_job *job)
{
    return sim_job_people(job) * sim_job_sessions(job);
}

const struct sim_job_kind sim_job_visits = {record_visits, count_visits};
const struct sim_job_kind sim_job_poses = {record_poses, count_poses};
const struct sim_job_kind sim_job_pairs = {record_pairs, count_visits};
const struct sim_job_kind sim_job_repeats = {record_repeats, count_repeats};
