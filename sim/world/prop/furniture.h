/* Things of the size of a head or larger that stand about where a door is. All are added to a
 * group, in a frame with x right, y down, z away from the viewer; failures stay in the group. */
#ifndef SIM_WORLD_PROP_FURNITURE_H
#define SIM_WORLD_PROP_FURNITURE_H

#include <stdbool.h>

#include "sim/base/random.h"
#include "sim/world/prop/group.h"

enum sim_chair_back {
    SIM_CHAIR_SLATS = 0, /* upright bars between two posts */
    SIM_CHAIR_LADDER,    /* lying boards */
    SIM_CHAIR_SHELL,     /* bent plywood */
    SIM_CHAIR_PADDED,
    SIM_CHAIR_BACKS
};

/* A chair, the middle of its back rest at the origin; posts of slats and ladders end in knobs. */
void sim_furniture_add_chair(struct sim_group *group, enum sim_chair_back back,
                             struct sim_random *random);

/* A plant in a pot, the middle of its leaves at the origin. */
void sim_furniture_add_plant(struct sim_group *group, struct sim_random *random);

/* A cushion about the origin, standing, uneven as cushions are. */
void sim_furniture_add_cushion(struct sim_group *group, struct sim_random *random);

/* A ball of the given radius about the origin; or a balloon, longer than broad, with its neck. */
void sim_furniture_add_ball(struct sim_group *group, double radius_mm, bool balloon,
                            struct sim_random *random);

/* A coat's or dummy's trunk, its collar at the origin: flat on a hanger with a hook, or full with a
 * stump of a neck. -ENOMEM stays in the group as well. */
void sim_furniture_add_coat(struct sim_group *group, bool hanger, struct sim_random *random);

#endif
