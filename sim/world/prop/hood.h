/* A hood over a head: cloth that stands off the skull and is open before the face. */
#ifndef SIM_WORLD_PROP_HOOD_H
#define SIM_WORLD_PROP_HOOD_H

#include "sim/base/random.h"
#include "sim/world/prop/solid.h"

/* A hood in the face frame of its wearer's head. Its looseness and how far it reaches round the
 * face are drawn at random. -ENOMEM. */
int sim_hood_new(struct sim_random *random, struct sim_solid **out)
    __attribute__((warn_unused_result));

#endif
