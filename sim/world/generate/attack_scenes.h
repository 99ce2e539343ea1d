/* Scenes with a presentation attack instrument (ISO/IEC 30107-3), one function for each kind. */
#ifndef SIM_WORLD_GENERATE_ATTACK_SCENES_H
#define SIM_WORLD_GENERATE_ATTACK_SCENES_H

#include "sim/world/generate/staging.h"

/* A print on paper or board: A5 to A3, or cut along the face's outline. */
sim_staging_build sim_attack_photo_flat;

/* A print on paper, rolled to a radius of 60 to 300 mm, bent to an S, or folded. */
sim_staging_build sim_attack_photo_bent;

/* A telephone, tablet or laptop. */
sim_staging_build sim_attack_screen;

/* An exact print of the target's head or face in a wrong size: 0.45 to 0.8, or 1.25 to 1.6. */
sim_staging_build sim_attack_mask_small, sim_attack_mask_large;

/* A 2 mm shell with openings for the eyes, worn by a person or empty. */
sim_staging_build sim_attack_eyes_cut;

/* A print of true size on a stand. */
sim_staging_build sim_attack_mask_still;

#endif
