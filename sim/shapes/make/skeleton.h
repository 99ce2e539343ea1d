/* Skeletons of creatures: a table of limbs becomes bones, which carry flesh and bend at their
 * joints.
 *
 * Coordinates of a creature: x to its left, y up, z forward, about 200 mm from end to end. */
#ifndef SIM_SHAPES_MAKE_SKELETON_H
#define SIM_SHAPES_MAKE_SKELETON_H

#include <stdbool.h>

#include "isotherm/vec.h"
#include "sim/base/random.h"

enum { SIM_LIMB_JOINTS_MAX = 12, SIM_BONES_MAX = 96, SIM_LIMBS_MAX = 24 };

/* A point of a limb, and the limb's radius at this point. */
struct sim_limb_joint {
    struct iso_vec3 at_mm;
    double radius_mm;
};

/* A row of a species' table: a chain of bones from joint to joint. */
struct sim_limb {
    const char *name;
    int parent;    /* limb that it grows from, in a row above; -1: the first limb */
    int at;        /* the parent's joint with which it moves */
    bool paired;   /* there is a mirrored limb at -x */
    double bend;   /* greatest bend of each joint in a pose, rad */
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

/* The variation of a body from its table. Each limb's length changes by a factor of up to
 * exp(amount), its thickness by the root of such a factor; `variant` draws separate numbers for
 * each limb. An amount of 0 means no variation. */
struct sim_growth {
    uint64_t variant;
    double amount;
};

/* Makes the bones of a table of limbs. */
void sim_skeleton_grow(const struct sim_limb *limbs, int n_limbs, const struct sim_growth *how,
                       struct sim_skeleton *out);

/* Draws a random pose: posed_from_rest[n_bones]. Every joint turns by at most its `bend` times
 * `strength` about a random axis; in chains that follow, all joints turn similarly. */
void sim_skeleton_pose(const struct sim_skeleton *skeleton, double strength,
                       struct sim_random *random, struct iso_rigid *posed_from_rest);

/* Turns a skeleton about the origin. */
void sim_skeleton_turn(struct sim_skeleton *skeleton, const struct iso_mat3 *rotation);

#endif
