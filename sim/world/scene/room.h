/* The background behind a person: a wall, and sometimes furniture. */
#ifndef SIM_WORLD_SCENE_ROOM_H
#define SIM_WORLD_SCENE_ROOM_H

#include <stdbool.h>

#include "sim/base/random.h"
#include "sim/world/view/view.h"

struct sim_room;

/* A slightly slanted wall 1.3 to 2.6 m away. With `furniture`, boxes of the size of a chair and a
 * cupboard stand in front of it. -ENOMEM. */
int sim_room_new(bool furniture, struct sim_random *random, struct sim_room **out)
    __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void sim_room_free(struct sim_room *room);

/* Draws the wall and the furniture. -ENOMEM. */
int sim_room_draw(struct sim_room *room, struct sim_view *view) __attribute__((warn_unused_result));

#endif
