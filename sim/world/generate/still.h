/* A scene in which nothing moves: a wall, things, and perhaps a person. */
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

/* An empty scene, with a wall in it or not. -ENOMEM. */
int sim_still_init(struct sim_still *still, bool wall, struct sim_random *random)
    __attribute__((warn_unused_result));
void sim_still_done(struct sim_still *still);

/* Puts somebody of another population (`crowd`: its name) into the scene, with a resting face,
 * clothes, and hair or a shorn head. The stance but for the expression is the caller's. -ENOMEM. */
int sim_still_add_person(struct sim_still *still, const struct sim_ict *ict, const char *crowd,
                         bool hair, const struct sim_stance *stance, struct sim_random *random)
    __attribute__((warn_unused_result));

/* Draws it; `scene` is a struct sim_still. No ground truth. */
sim_draw_frame sim_still_draw;

#endif
