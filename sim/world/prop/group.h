/* Several solids that belong together: a hand, a chair, a photograph with the person who holds it.
 */
#ifndef SIM_WORLD_PROP_GROUP_H
#define SIM_WORLD_PROP_GROUP_H

#include <stddef.h>

#include "sim/world/prop/solid.h"

struct sim_group {
    size_t n_solids, capacity;
    struct sim_solid **solids;
    /* Moves all parts that are added from now on; initially the identity. */
    struct iso_rigid placed;
    int error; /* error of the first addition that failed; nothing is added after it */
    struct iso_vec3 *scratch_mm;
    size_t scratch_size;
};

/* An empty group. -ENOMEM. */
int sim_group_new(struct sim_group **out) __attribute__((warn_unused_result));

/* Frees it and what it holds. NULL is accepted. */
void sim_group_free(struct sim_group *group);

/* Takes ownership of a solid whose construction returned `made` (0 or a negative errno, for
 * which `solid` is ignored). A failure is kept in group->error, so that a caller can add part
 * after part and check once. */
void sim_group_add(struct sim_group *group, int made, struct sim_solid *solid);

/* A box of the given size about a point; sim_solid_box. */
void sim_group_add_box(struct sim_group *group, struct iso_vec3 size_mm, struct iso_vec3 at_mm,
                       enum sim_material material);

/* A tube along a polyline; sim_solid_tube. */
void sim_group_add_tube(struct sim_group *group, const struct sim_joint *joints, size_t n_joints,
                        enum sim_material material);

/* An ellipsoid or something between it and a box about a point; sim_solid_superellipsoid. */
void sim_group_add_ellipsoid(struct sim_group *group, struct iso_vec3 half_mm, double roundness,
                             struct iso_vec3 at_mm, enum sim_material material);

/* Draws all parts in the camera frame. Returns group->error if it is set, or -ENOMEM. */
int sim_group_draw(struct sim_group *group, const struct iso_rigid *camera_from_group,
                   struct sim_view *view) __attribute__((warn_unused_result));

#endif
