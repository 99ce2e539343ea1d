/* A telephone, tablet or laptop that shows a face.
 *
 * A depth sensor sees the device and not the picture: a case with a rim, and glass that reflects
 * most of the emitter's light away. Part of the glass is not measured at all. The rest is measured
 * badly, and too far away where light comes back from the layers below or by way of other objects.
 * The share of each depends on the device, its angle and the room. No distribution of it is
 * published, so the caller draws it.
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
    double patch_mm;  /* approximate size of measured and of unmeasured patches */
    double behind_mm; /* greatest distance of a measured point behind the glass */
    bool keyboard;    /* a laptop's lower half, opened by 110 degrees */
    uint64_t key;     /* of the patches */
};

/* Adds the device's parts to the group. Failures are kept in the group. */
void sim_screen_add(struct sim_group *group, const struct sim_screen *screen);

#endif
