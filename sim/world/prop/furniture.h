/* Objects of the size of a head or larger that are found near a door. All are added to a group,
 * in a frame with x right, y down, z away from the viewer. Failures are kept in the group. */
#ifndef SIM_WORLD_PROP_FURNITURE_H
#define SIM_WORLD_PROP_FURNITURE_H

#include <stdbool.h>

#include "sim/base/random.h"
#include "sim/world/prop/group.h"

enum sim_chair_back {
    SIM_CHAIR_SLATS = 0, /* upright bars between two posts */
    SIM_CHAIR_LADDER,    /* horizontal boards */
    SIM_CHAIR_SHELL,     /* bent plywood */
    SIM_CHAIR_PADDED,
    SIM_CHAIR_BACKS
};

/* A chair; the middle of its back rest is at the origin. Posts of slats and ladders end in knobs.
 */
void sim_furniture_add_chair(struct sim_group *group, enum sim_chair_back back,
                             struct sim_random *random);

/* A plant in a pot; the middle of its leaves is at the origin. */
void sim_furniture_add_plant(struct sim_group *group, struct sim_random *random);

/* An upright cushion with uneven surfaces; its middle is at the origin. */
void sim_furniture_add_cushion(struct sim_group *group, struct sim_random *random);

/* A ball of the given radius about the origin; or a balloon, longer than broad, with its neck. */
void sim_furniture_add_ball(struct sim_group *group, double radius_mm, bool balloon,
                            struct sim_random *random);

/* The trunk of a coat or a dummy, its collar at the origin: flat on a hanger with a hook, or
 * full with the stump of a neck. -ENOMEM is kept in the group as well. */
void sim_furniture_add_coat(struct sim_group *group, bool hanger, struct sim_random *random);

#endif
