/* A session: one living person stands before the sensor for a few frames; pose and position
 * drift from frame to frame. */
#ifndef SIM_WORLD_GENERATE_SESSION_H
#define SIM_WORLD_GENERATE_SESSION_H

#include "sim/world/face/expression.h"
#include "sim/world/generate/studio.h"

/* How a session's pose is drawn. Either yaw, pitch and roll are each normal or uniform, with a
 * range of its own for pitch or not; or yaw and pitch are uniform over a disc that is flattened in
 * pitch, and roll is uniform. */
struct sim_pose_range {
    double sd_rad;    /* if > 0: normal with this standard deviation */
    double limit_rad; /* otherwise: uniform within +- this angle */
    double disc_rad; /* if > 0: radius of the disc in yaw; the two fields above are for roll only */
    double pitch_limit_rad; /* if > 0 and there is no disc: pitch is uniform within +- this angle */
    double disc_pitch_rad;  /* if > 0: radius of the disc in pitch; otherwise 0.7 of that in yaw */
};

struct sim_session_plan {
    struct sim_corpus_row row; /* the caller sets subject, session, role and count, and recording if
                                  it is not to be SUBJECT-SESSION */
    struct sim_person person;
    enum sim_expression expression;
    struct sim_pose_range pose;
    double yaw_rad, pitch_rad; /* added to what is drawn */
    double near_mm, far_mm;    /* distance of the nose tip; both 0: the sensor's own */
    bool open_hall; /* no wall within the sensor's range (a sensor for faces only never has one) */
    double body_yaw_rad; /* pi shows the back of the head */
    double sway; /* motion from frame to frame: 1 for a person who shifts from foot to foot, 0.1 for
                    a person who stands as still as possible, 0 for a statue */
    bool frozen; /* the first frame is repeated bit by bit */
    bool keeps_hair;                 /* the person's hair stays between sessions */
    bool bystander;                  /* another person stands behind and beside the person */
    const struct sim_person *behind; /* the bystander; NULL: any person */
    double behind_min_mm;            /* least distance of the bystander; 0: 500 mm */
    struct iso_vec3 offset_mm;       /* added to the position drawn, e.g. to cut a face at the image
                                        border */
    struct sim_random random;        /* source of all random draws of the session */
};

/* Records the session and adds its row to the manifest. In the row of a person
 * (subject not `none`) it sets the pose, "y+12p-03r+05" (yaw, pitch and roll in degrees), and the
 * expression that was drawn. Errors of sim_studio_record. */
int sim_session_record(struct sim_studio *studio, const struct sim_ict *ict,
                       const struct sim_sensor *sensor, const struct sim_session_plan *plan,
                       struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
