/* A session: one person before the sensor for a few frames, alive: pose and position drift from
 * frame to frame. */
#ifndef SIM_WORLD_GENERATE_SESSION_H
#define SIM_WORLD_GENERATE_SESSION_H

#include "sim/world/face/expression.h"
#include "sim/world/generate/studio.h"

/* How a session's pose is drawn: each of yaw, pitch and roll normal or uniform; or yaw and pitch
 * together, uniform over a disc that is flattened in pitch, and roll uniform. */
struct sim_pose_range {
    double sd_rad;    /* normal with this standard deviation, if > 0 */
    double limit_rad; /* else uniform within +- this */
    double disc_rad;  /* if > 0, the disc's radius instead, in yaw; limit_rad is that of roll */
};

struct sim_session_plan {
    struct sim_corpus_row row; /* subject, session, role and count; the rest is filled in */
    struct sim_person person;
    enum sim_expression expression;
    struct sim_pose_range pose;
    double near_mm, far_mm; /* where the nose tip is, if not where people stand before the sensor */
    bool open_hall;      /* no wall within the sensor's range (never one if it is for faces only) */
    double body_yaw_rad; /* pi shows the back of the head */
    double sway;         /* how much of a session's usual motion there is from frame to frame: 1
                            shifts from foot to foot, 0.1 stands as still as people can, 0 is a statue */
    bool frozen;         /* the first frame is repeated bit by bit */
    bool bystander;      /* somebody else stands behind and beside the person */
    const struct sim_person *behind; /* who; NULL: anybody */
    double behind_min_mm;            /* how far at least, instead of the usual half metre */
    struct iso_vec3 offset_mm;       /* added to the position: a face cut by the image border */
    struct sim_random random;        /* everything that happens in the session */
};

/* Records the session as SUBJECT-SESSION. Fills in row.recording, and for a row of a person
 * (subject not `none`) pose, "y+12p-03r+05": yaw, pitch and roll in degrees, and expression. Errors
 * of sim_studio_record. */
int sim_session_record(struct sim_studio *studio, const struct sim_ict *ict,
                       const struct sim_sensor *sensor, const struct sim_session_plan *plan,
                       struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
