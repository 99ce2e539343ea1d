/* Still scenes drawn at random, one function for each kind: attacks (attack_scenes.h) and scenes
 * without a face (not_face_scenes.h). */
#ifndef SIM_WORLD_GENERATE_STAGING_H
#define SIM_WORLD_GENERATE_STAGING_H

#include "sim/world/generate/still.h"

/* How far instruments are turned away from the camera. */
struct sim_turn {
    bool away; /* false: every kind has its own small angles, and the other fields are not used */
    double yaw_least_deg, yaw_most_deg; /* to the left or to the right, at random */
    double pitch_most_deg;              /* down or up, from 0 */
};

struct sim_staging {
    const struct sim_ict *ict;
    const struct sim_sensor *sensor; /* objects are shown where people stand before it */
    struct sim_person target;        /* the person whom an attack impersonates */
    struct sim_turn turn;            /* of attacks */
    struct sim_random *random;       /* source of all random draws */
    struct sim_still *still;         /* the scene to fill: empty, or with a wall in it */
    char variant[32];                /* name of the drawn variant: "a4-paper", "rolled-r120", ... */
};

/* Fills staging->still and staging->variant. Returns 0 or a negative errno. A failure may also
 * be kept in the scene's group. */
typedef int sim_staging_build(struct sim_staging *staging);

struct sim_staged_kind {
    const char *name; /* the row's note */
    sim_staging_build *build;
    bool lasting; /* shown for several frames, otherwise for one */
    bool bare;    /* the scene has no wall */
};

/* Settings shared by all scenes of a corpus. */
struct sim_staging_plan {
    const struct sim_ict *ict;
    const struct sim_sensor *sensor;
    enum sim_role role;
    uint64_t seed;
    int frames;           /* of lasting kinds */
    struct sim_turn turn; /* of attacks */
};

/* Records scene number `number` of a kind, single or lasting, as none-KIND-NNNN, with the variant
 * as the row's expression. `target` NULL: the mean person. Errors of building and of
 * sim_studio_record. */
int sim_staging_record(struct sim_studio *studio, const struct sim_staging_plan *plan,
                       const struct sim_staged_kind *kind, int number,
                       const struct sim_person *target, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* A random position for an object: at the distance of a visitor, and slightly off the centre like
 * a visitor. */
struct iso_vec3 sim_staging_place(const struct sim_staging *staging);

/* Random yaw and pitch of an instrument, in rad: within the kind's own limit on either side, or
 * turned away as staging->turn says. Each takes one random number. */
double sim_staging_yaw(const struct sim_staging *staging, double limit_deg);
double sim_staging_pitch(const struct sim_staging *staging, double limit_deg);

/* True with the given probability. */
bool sim_staging_chance(const struct sim_staging *staging, double share);

/* Adds a pole from a point downwards, out of the picture. */
void sim_staging_add_pole(struct sim_staging *staging, struct iso_vec3 top_mm, double radius_mm);

#endif
