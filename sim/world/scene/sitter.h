/* One person on one day, ready to be drawn: head, hair, clothes. */
#ifndef SIM_WORLD_SCENE_SITTER_H
#define SIM_WORLD_SCENE_SITTER_H

#include <stdbool.h>

#include "isotherm/landmark.h"
#include "sim/base/random.h"
#include "sim/world/face/ict.h"
#include "sim/world/face/person.h"
#include "sim/world/view/view.h"

/* The person's stance before the camera at one moment. With all angles 0 the face looks along
 * the optical axis. */
struct sim_stance {
    double expression[SIM_EXPRESSION_SHAPES_MAX];
    double yaw_rad, pitch_rad,
        roll_rad;        /* > 0: yaw to the subject's left, pitch up, roll to the subject's right */
    double body_yaw_rad; /* yaw of the whole person, added to the head's own */
    struct iso_vec3 nose_mm; /* the face frame's origin in the camera frame */
};

/* Ground truth of a drawn face. */
struct sim_truth {
    struct iso_rigid camera_from_face;
    struct iso_vec3 landmark_mm[ISO_LANDMARKS]; /* camera frame */
    struct iso_vec3 ibug_mm[ISO_LANDMARKS_IBUG];
};

struct sim_sitter_options {
    bool hair, torso;
    bool keeps_hair; /* hair that stays between visits (sim_hair_kept), not drawn anew each day */
    bool blank;      /* the whole head has one albedo, like a mask without markings */
};

struct sim_sitter;

/* Makes a person with hair and clothes of the day, which are drawn from `random`. The head model
 * must outlive the sitter. -ENOMEM. */
int sim_sitter_new(const struct sim_ict *ict, const struct sim_person *person,
                   const struct sim_sitter_options *options, struct sim_random *random,
                   struct sim_sitter **out) __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void sim_sitter_free(struct sim_sitter *sitter);

/* The pose of the face frame in the camera frame. */
struct iso_rigid sim_stance_camera_from_face(const struct sim_stance *stance);

/* Draws the sitter, and fills in *truth unless it is NULL. -ENOMEM. */
int sim_sitter_draw(struct sim_sitter *sitter, const struct sim_stance *stance,
                    struct sim_view *view, struct sim_truth *truth)
    __attribute__((warn_unused_result));

#endif
