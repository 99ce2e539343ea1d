/* A session: one person before the sensor for a few frames, alive: pose and position drift from
 * frame to frame. */
#ifndef SIM_GENERATE_SESSION_H
#define SIM_GENERATE_SESSION_H

#include "sim/face/expression.h"
#include "sim/generate/studio.h"

/* How a session's pose is drawn: each of yaw, pitch and roll normal or uniform. */
struct sim_pose_range {
    double sd_rad;    /* normal with this standard deviation, if > 0 */
    double limit_rad; /* else uniform within +- this */
};

struct sim_session_plan {
    struct sim_corpus_row row; /* subject, session, role and count; the rest is filled in */
    struct sim_person person;
    enum sim_expression expression;
    struct sim_pose_range pose;
    bool open_hall;      /* no wall within the sensor's range (never one if it is for faces only) */
    double body_yaw_rad; /* pi shows the back of the head */
    bool bystander;      /* somebody else stands behind and beside the person */
    struct iso_vec3 offset_mm; /* added to the position: a face cut by the image border */
    struct sim_random random;  /* everything that happens in the session */
};

/* Records the session as SUBJECT-SESSION. Fills in row.recording, and pose and expression unless
 * the row has a note. Errors of sim_studio_record. */
int sim_session_record(struct sim_studio *studio, const struct sim_ict *ict,
                       const struct sim_sensor *sensor, const struct sim_session_plan *plan,
                       struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
