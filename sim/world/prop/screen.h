/* A telephone, tablet or laptop that shows a face.
 *
 * Whatever the picture, a depth sensor sees the device: a case with a rim, and glass that sends
 * most of the emitter's light somewhere else. Part of the glass is not measured at all; the rest is
 * measured badly and, where light comes back from the layers below or by way of other things, too
 * far away. How much of each depends on the device, its angle and the room; no distribution of it
 * is published, so that it is the caller's draw.
 *
 * Frame: x right, y down, z away from the viewer, the middle of the glass at the origin. */
#ifndef SIM_WORLD_PROP_SCREEN_H
#define SIM_WORLD_PROP_SCREEN_H

#include <stdbool.h>

#include "sim/world/prop/group.h"

struct sim_screen {
    double width_mm, height_mm; /* of the glass */
    double rim_mm, thickness_mm;
    double lost;      /* share of the glass that is not measured, 0..1 */
    double patch_mm;  /* about how large the patches are that are measured or not */
    double behind_mm; /* how far behind the glass what is measured lies at most */
    bool keyboard;    /* a laptop's lower half, opened by 110 degrees */
    uint64_t key;     /* of the patches */
};

/* Adds the device's parts to the group; failures stay in the group. */
void sim_screen_add(struct sim_group *group, const struct sim_screen *screen);

#endif
