/* Scenes with a presentation attack instrument (ISO/IEC 30107-3), one function a kind. */
#ifndef SIM_GENERATE_ATTACK_SCENE_H
#define SIM_GENERATE_ATTACK_SCENE_H

#include "sim/generate/still.h"

struct sim_attack {
    const struct sim_ict *ict;
    const struct sim_sensor *sensor; /* where people stand before it, instruments are shown */
    struct sim_person target;        /* who is impersonated */
    struct sim_random *random;       /* everything that is drawn */
    struct sim_still *still;         /* where the instrument is put */
    char variant[32];                /* what was drawn, in a word: "a4", "rolled-r120", ... */
};

/* Fills attack->still, which is a scene with at most a wall, and attack->variant. Returns 0 or a
 * negative errno; a failure may also stay in the scene's group. */
typedef int sim_attack_build(struct sim_attack *attack);

/* A print on paper or board: A5 to A3, or cut along the face's outline. */
sim_attack_build sim_attack_photo_flat;

/* A print on paper, rolled to a radius of 60 to 300 mm, bent to an S, or folded. */
sim_attack_build sim_attack_photo_bent;

/* A telephone, tablet or laptop. */
sim_attack_build sim_attack_screen;

/* A print of the target's head or face, exact but for its size: 0.45 to 0.8, and 1.25 to 1.6. */
sim_attack_build sim_attack_mask_small, sim_attack_mask_large;

/* A 2 mm shell with openings for the eyes, worn by somebody or empty. */
sim_attack_build sim_attack_eyes_cut;

/* A print of true size that nobody holds. */
sim_attack_build sim_attack_mask_still;

/* Where the middle of an instrument is: as far away as a visitor. One draw of three numbers. */
struct iso_vec3 sim_attack_place(const struct sim_attack *attack);

/* A pole from a point downwards, out of the picture. */
void sim_attack_add_pole(struct sim_attack *attack, struct iso_vec3 top_mm, double radius_mm);

/* True once in 1 / share calls. */
bool sim_attack_chance(const struct sim_attack *attack, double share);

#endif
