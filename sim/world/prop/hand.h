/* A hand and a forearm. Phalanges and forearm are tubes, the palm is a rounded box; a depth
 * frame at arm's length shows no more detail. Lengths are those of an adult's hand (length 189
 * mm, breadth 84 mm: the median man of DIN 33402-2). */
#ifndef SIM_WORLD_PROP_HAND_H
#define SIM_WORLD_PROP_HAND_H

#include <stdbool.h>

#include "sim/base/random.h"
#include "sim/world/prop/group.h"

enum sim_hand_pose {
    SIM_HAND_OPEN = 0, /* shows the palm, fingers up and spread */
    SIM_HAND_FIST,
    SIM_HAND_GRIP, /* holds a flat object in the plane z = 0 by its lower edge, which is at y = -70;
                      the thumb is in front of the object, the fingers are behind it */
    SIM_HAND_POSES
};

/* Adds a hand with forearm to the group. Its frame: the wrist at the origin, x right, y down, z
 * away from the viewer; fingers point up. A right hand mirrors a left one. `held_mm` is the
 * thickness behind z = 0 of the object that the hand grips; other poses ignore it. Size, spread
 * and the elbow's position come from `random`. Failures are kept in the group. */
void sim_hand_add(struct sim_group *group, enum sim_hand_pose pose, bool left, double held_mm,
                  struct sim_random *random);

#endif
