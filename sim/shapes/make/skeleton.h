/* Skeletons of creatures: limbs of a table become bones, bones carry flesh and bend at their
 * joints.
 *
 * Coordinates of a creature: x to its left, y up, z forward, about 200 mm from end to end. */
#ifndef SIM_SHAPES_MAKE_SKELETON_H
#define SIM_SHAPES_MAKE_SKELETON_H

#include <stdbool.h>

#include "isotherm/vec.h"
#include "sim/base/random.h"

enum { SIM_LIMB_JOINTS_MAX = 12, SIM_BONES_MAX = 96, SIM_LIMBS_MAX = 24 };

/* A point of a limb and how thick the limb is there. */
struct sim_limb_joint {
    struct iso_vec3 at_mm;
    double radius_mm;
};

/* A row of a species' table: a chain of bones from joint to joint. */
struct sim_limb {
    const char *name;
    int parent;    /* limb it grows from, of a row above; -1: the first one */
    int at;        /* joint of the parent that it moves with */
    bool paired;   /* there is another one at -x */
    double bend;   /* how far each joint may bend in a pose, rad */
    double follow; /* 0: joints bend independently .. 1: the chain curls as a whole */
    struct sim_limb_joint joint[SIM_LIMB_JOINTS_MAX]; /* ends with a radius of 0 */
};

struct sim_bone {
    int parent; /* index of a bone before this one; -1: none */
    struct iso_vec3 from_mm, to_mm;
    double radius_from_mm, radius_to_mm; /* of a long limb's flesh */
    double bend, follow;
};

struct sim_skeleton {
    int n_bones;
    struct sim_bone bone[SIM_BONES_MAX];
};

/* How a body differs from its table: every limb is longer or shorter by a factor of up to
 * exp(amount), and thicker or thinner by its root, each by numbers of its own that `variant` draws.
 * amount 0: not at all. */
struct sim_growth {
    uint64_t variant;
    double amount;
};

/* Bones of a table of limbs. */
void sim_skeleton_grow(const struct sim_limb *limbs, int n_limbs, const struct sim_growth *how,
                       struct sim_skeleton *out);

/* Where the bones go in a random pose: posed_from_rest[n_bones]. Every joint turns by at most its
 * `bend` times `strength` about an axis of its own; chains that follow turn alike from joint to
 * joint. */
void sim_skeleton_pose(const struct sim_skeleton *skeleton, double strength,
                       struct sim_random *random, struct iso_rigid *posed_from_rest);

/* Turns a skeleton about the origin. */
void sim_skeleton_turn(struct sim_skeleton *skeleton, const struct iso_mat3 *rotation);

#endif
