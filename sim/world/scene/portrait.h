/* A photograph of a person from straight ahead, given as albedos of the printed paper. */
#ifndef SIM_WORLD_SCENE_PORTRAIT_H
#define SIM_WORLD_SCENE_PORTRAIT_H

#include "sim/world/scene/sitter.h"

enum { SIM_PORTRAIT_COLUMNS = 190, SIM_PORTRAIT_ROWS = 260 };

/* Takes the photograph in life size, one pixel a millimetre, the nose tip 10 mm below the middle.
 * The face is neutral. `albedo` has
 * [SIM_PORTRAIT_ROWS][SIM_PORTRAIT_COLUMNS] values, rows from the top. -ENOMEM. */
int sim_portrait(struct sim_sitter *sitter, float *albedo) __attribute__((warn_unused_result));

#endif
