/* A hand and a forearm: phalanges and forearm are tubes, the palm is a rounded box; that is what is
 * left of a hand in a depth frame at arm's length. Lengths are those of an adult's hand (length 189
 * mm, breadth 84 mm: the median man of DIN 33402-2). */
#ifndef SIM_WORLD_PROP_HAND_H
#define SIM_WORLD_PROP_HAND_H

#include <stdbool.h>

#include "sim/base/random.h"
#include "sim/world/prop/group.h"

enum sim_hand_pose {
    SIM_HAND_OPEN = 0, /* the palm shown, fingers up and spread */
    SIM_HAND_FIST,
    SIM_HAND_GRIP, /* holds the lower edge of something flat in the plane z = 0: the edge at y =
                      -70, the thumb before it, the fingers behind */
    SIM_HAND_POSES
};

/* Adds a hand with forearm to the group. Its frame: the wrist at the origin, x right, y down, z
 * away from the viewer; fingers go up. A right hand mirrors a left one. `held_mm` is how thick the
 * thing in its grip is behind z = 0; other poses ignore it. Size, spread and where the elbow is
 * come from `random`. Failures stay in the group. */
void sim_hand_add(struct sim_group *group, enum sim_hand_pose pose, bool left, double held_mm,
                  struct sim_random *random);

#endif
