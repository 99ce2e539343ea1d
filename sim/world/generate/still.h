/* A scene in which nothing moves: a wall, objects, and perhaps a person. */
#ifndef SIM_WORLD_GENERATE_STILL_H
#define SIM_WORLD_GENERATE_STILL_H

#include "sim/world/generate/studio.h"
#include "sim/world/prop/group.h"
#include "sim/world/scene/room.h"

struct sim_still {
    struct sim_room *room;     /* or NULL: no wall within the sensor's range */
    struct sim_group *things;  /* camera frame */
    struct sim_sitter *person; /* or NULL */
    struct sim_stance stance;
};

/* A scene that is empty or has only a wall. -ENOMEM. */
int sim_still_init(struct sim_still *still, bool wall, struct sim_random *random)
    __attribute__((warn_unused_result));

/* Releases what it holds. */
void sim_still_done(struct sim_still *still);

/* Puts a person of another population (named by `crowd`) into the scene, with a resting face,
 * clothes, and hair or a shaved head. The caller sets the stance except for the expression.
 * -ENOMEM. */
int sim_still_add_person(struct sim_still *still, const struct sim_ict *ict, const char *crowd,
                         bool hair, const struct sim_stance *stance, struct sim_random *random)
    __attribute__((warn_unused_result));

/* Draws the scene, a struct sim_still. There is no ground truth. */
sim_draw_frame sim_still_draw;

#endif
