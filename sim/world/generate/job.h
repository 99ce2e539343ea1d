/* A corpus that is being generated: its preset, and the options that change it. Internal to
 * sim/world/generate. */
#ifndef SIM_WORLD_GENERATE_JOB_H
#define SIM_WORLD_GENERATE_JOB_H

#include "sim/world/face/expression.h"
#include "sim/world/generate/generate.h"
#include "sim/world/generate/session.h"

#define SIM_DEGREES(x) ((x)*0.017453292519943295)

struct sim_job;

/* How the recordings of a preset are made. */
struct sim_job_kind {
    /* Makes all recordings. Errors of sim_studio_record. */
    int (*record)(const struct sim_job *job, struct iso_fault *fault);
    /* The number of recordings. */
    int (*count)(const struct sim_job *job);
};

/* Sessions of people (people.c). The first kind: enrolled people, their later visits, and
 * strangers. The second: the same with two people in each visit. The third: the same sessions
 * for each person, with no one enrolled. */
extern const struct sim_job_kind sim_job_visits, sim_job_pairs, sim_job_repeats;

struct sim_preset {
    const char *name;
    const struct sim_job_kind *kind;
    const struct sim_sensor *sensor;
    enum sim_expression expression; /* of probes and strangers; the gallery is neutral */
    struct sim_pose_range gallery_pose, probe_pose;
    int n_people, n_strangers, n_probes, n_sessions, n_per_kind, frames_per_visit;
    int rest_sessions; /* of "training": a person's first sessions are neutral, the others mild */
    double noise_scale, identity_variance; /* 0: the head model's own */
    double near_mm, far_mm; /* distance of later visits and strangers; 0: the sensor's own */
    int png_level;
    bool bystander;   /* another person stands behind the visitor */
    bool instruments; /* needs a sensor that sees more than skin */
};

/* NULL: no preset has this name. */
const struct sim_preset *sim_preset_find(const char *name);

struct sim_job {
    const struct sim_generate_options *options;
    const struct sim_preset *preset;
    const struct sim_sensor *sensor;
    struct sim_ict *ict;
    struct sim_studio *studio;
};

/* The value of an option or else of the preset. Frames count for a session, sessions for a
 * person. */
int sim_job_people(const struct sim_job *job);
int sim_job_strangers(const struct sim_job *job);
int sim_job_probes(const struct sim_job *job);
int sim_job_sessions(const struct sim_job *job);
int sim_job_frames(const struct sim_job *job);
double sim_job_variance(const struct sim_job *job); /* of identities */

#endif
