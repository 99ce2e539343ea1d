/* A corpus that is being generated: its preset, and the options that change it. Internal to
 * sim/world/generate. */
#ifndef SIM_WORLD_GENERATE_JOB_H
#define SIM_WORLD_GENERATE_JOB_H

#include "sim/world/face/expression.h"
#include "sim/world/generate/generate.h"
#include "sim/world/generate/session.h"
#include "sim/world/generate/staging.h"

#define SIM_DEGREES(x) ((x)*0.017453292519943295)

struct sim_job;

/* The function that makes the recordings of a preset, and their number. */
struct sim_job_kind {
    /* Makes all recordings of the job. Errors of sim_studio_record. */
    int (*record)(const struct sim_job *job, struct iso_fault *fault);
    /* The number of recordings that `record` makes; used to show progress. */
    int (*count)(const struct sim_job *job);
};

/* Sessions of people (people.c).
 * - visits: an enrolment of each enrolled person, later visits of these people, and one visit of
 *   each stranger.
 * - poses: the same, but an enrolment also has a recording of each other pose, as a row of the same
 *   session whose role is probe.
 * - pairs: as visits, but a second person stands behind the visitor in every visit, and an
 *   enrolment has three times as many frames.
 * - repeats: equally many sessions of each person; nobody is enrolled. */
extern const struct sim_job_kind sim_job_visits, sim_job_poses, sim_job_pairs, sim_job_repeats;

struct sim_preset {
    const char *name;
    const struct sim_job_kind *kind;
    const struct sim_sensor *sensor;
    enum sim_expression expression; /* of probes and strangers; the gallery is neutral */
    struct sim_pose_range gallery_pose, probe_pose;
    int n_people, n_strangers, n_probes, n_sessions, n_per_kind, frames_per_visit;
    int rest_sessions; /* if > 0: a person's first session is neutral, the following ones up to this
                          number are mild, and the later ones have `expression` */
    double noise_scale, identity_variance; /* variance 0: that of the head model, which is 1 */
    double near_mm, far_mm; /* distance in sessions other than enrolments; 0: the sensor's own */
    struct sim_turn turn;   /* of attack instruments */
    int png_level;
    bool bystander;   /* another person stands behind the visitor */
    bool instruments; /* needs a sensor that sees more than skin */
};

/* The preset with this name, or NULL. */
const struct sim_preset *sim_preset_find(const char *name);

struct sim_job {
    const struct sim_generate_options *options;
    const struct sim_preset *preset;
    const struct sim_sensor *sensor;
    struct sim_ict *ict;
    struct sim_studio *studio;
};

/* The value of the option if it is given, otherwise that of the preset. Frames are per session,
 * sessions are per person. */
int sim_job_people(const struct sim_job *job);
int sim_job_strangers(const struct sim_job *job);
int sim_job_probes(const struct sim_job *job);
int sim_job_sessions(const struct sim_job *job);
int sim_job_frames(const struct sim_job *job);
double sim_job_variance(const struct sim_job *job); /* of identities */

#endif
