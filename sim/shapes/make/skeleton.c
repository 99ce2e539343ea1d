#include "sim/shapes/make/skeleton.h"

#include <math.h>
#include <string.h>

/* ---- limbs to bones ------------------------------------------------------------ */

/* A finished limb: its joints, and the bone that ends (or starts) at each joint, on both sides. */
struct grown {
    struct iso_vec3 joint_mm[SIM_LIMB_JOINTS_MAX];
    int bone[2][SIM_LIMB_JOINTS_MAX];
};

static int count_joints(const struct sim_limb *limb)
{
    int n = 0;
    while (n < SIM_LIMB_JOINTS_MAX && limb->joint[n].radius_mm > 0.0) {
        n++;
    }
    return n;
}

static struct iso_vec3 mirrored(struct iso_vec3 p, int side)
{
    return iso_vec3(side ? -p.x : p.x, p.y, p.z);
}

/* The factors of length and thickness of a variant's limb. */
static void growth(const struct sim_growth *how, int limb, double *length, double *thickness)
{
    struct sim_random random = sim_random_seeded(how->variant, 0x6772, (uint64_t)limb);
    *length = exp(how->amount * sim_random_between(&random, -1.0, 1.0));
    *thickness = exp(0.5 * how->amount * sim_random_between(&random, -1.0, 1.0));
}

static void place_joints(const struct sim_limb *limbs, int l, double length, struct grown *grown)
{
    const struct sim_limb *limb = &limbs[l];
    struct iso_vec3 first = limb->joint[0].at_mm, base = first;
    if (limb->parent >= 0) { /* moves with its parent */
        struct iso_vec3 there = limbs[limb->parent].joint[limb->at].at_mm;
        base = iso_add(first, iso_sub(grown[limb->parent].joint_mm[limb->at], there));
    }
    for (int j = 0; j < count_joints(limb); j++) {
        grown[l].joint_mm[j] = iso_madd(base, length, iso_sub(limb->joint[j].at_mm, first));
    }
}

static void add_bones(const struct sim_limb *limbs, int l, int side, double thickness,
                      struct grown *grown, struct sim_skeleton *out)
{
    const struct sim_limb *limb = &limbs[l];
    int parent = -1;
    if (limb->parent >= 0) {
        parent = grown[limb->parent].bone[limbs[limb->parent].paired ? side : 0][limb->at];
    }
    const int n = count_joints(limb);
    grown[l].bone[side][0] = out->n_bones;
    for (int j = 0; j + 1 < n && out->n_bones < SIM_BONES_MAX; j++) {
        grown[l].bone[side][j + 1] = out->n_bones;
        out->bone[out->n_bones] = (struct sim_bone){
            .parent = parent,
            .from_mm = mirrored(grown[l].joint_mm[j], side),
            .to_mm = mirrored(grown[l].joint_mm[j + 1], side),
            .radius_from_mm = thickness * limb->joint[j].radius_mm,
            .radius_to_mm = thickness * limb->joint[j + 1].radius_mm,
            .bend = limb->bend,
            .follow = j > 0 ? limb->follow : 0.0,
        };
        parent = out->n_bones++;
    }
}

void sim_skeleton_grow(const struct sim_limb *limbs, int n_limbs, const struct sim_growth *how,
                       struct sim_skeleton *out)
{
    struct grown grown[SIM_LIMBS_MAX];
    memset(grown, 0, sizeof grown);
    out->n_bones = 0;
    for (int l = 0; l < n_limbs && l < SIM_LIMBS_MAX; l++) {
        double length, thickness;
        growth(how, l, &length, &thickness);
        place_joints(limbs, l, length, grown);
        for (int side = 0; side <= (limbs[l].paired ? 1 : 0); side++) {
            add_bones(limbs, l, side, thickness, grown, out);
        }
    }
}

/* ---- poses --------------------------------------------------------------------- */

/* Uniform in the unit ball. */
static struct iso_vec3 random_in_ball(struct sim_random *random)
{
    struct iso_vec3 p;
    do {
        p.x = sim_random_between(random, -1.0, 1.0);
        p.y = sim_random_between(random, -1.0, 1.0);
        p.z = sim_random_between(random, -1.0, 1.0);
    } while (iso_dot(p, p) > 1.0);
    return p;
}

void sim_skeleton_pose(const struct sim_skeleton *skeleton, double strength,
                       struct sim_random *random, struct iso_rigid *posed_from_rest)
{
    struct iso_vec3 bend[SIM_BONES_MAX]; /* in units of each joint's own limit */
    for (int b = 0; b < skeleton->n_bones; b++) {
        const struct sim_bone *bone = &skeleton->bone[b];
        bend[b] = iso_scale(1.0 - bone->follow, random_in_ball(random));
        if (bone->parent >= 0) {
            bend[b] = iso_madd(bend[b], bone->follow, bend[bone->parent]);
        }
        struct iso_mat3 turn = iso_mat3_rotation(iso_scale(strength * bone->bend, bend[b]));
        struct iso_rigid joint = {turn,
                                  iso_sub(bone->from_mm, iso_mat3_apply(&turn, bone->from_mm))};
        posed_from_rest[b] = bone->parent >= 0
                                 ? iso_rigid_mul(&posed_from_rest[bone->parent], &joint)
                                 : joint;
    }
}

void sim_skeleton_turn(struct sim_skeleton *skeleton, const struct iso_mat3 *rotation)
{
    for (int b = 0; b < skeleton->n_bones; b++) {
        struct sim_bone *bone = &skeleton->bone[b];
        bone->from_mm = iso_mat3_apply(rotation, bone->from_mm);
        bone->to_mm = iso_mat3_apply(rotation, bone->to_mm);
    }
}
