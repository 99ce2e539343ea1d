/* A clothed trunk under the neck: shoulders and chest. */
#ifndef SIM_WORLD_PROP_TORSO_H
#define SIM_WORLD_PROP_TORSO_H

#include <stdint.h>

#include "sim/world/prop/solid.h"

/* The trunk in the face frame of a person who looks straight ahead. `key` determines breadth and
 * folds. -ENOMEM. */
int sim_torso_new(uint64_t key, struct sim_solid **out) __attribute__((warn_unused_result));

#endif
