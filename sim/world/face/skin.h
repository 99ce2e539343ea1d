/* How much near-infrared light each part of a head scatters back: a map of albedo over the head
 * model's triangles, drawn about the curves of its landmarks.
 *
 * At 850 nm, skin of every tone scatters back about 0.5 to 0.65 of the light (Anderson and
 * Parrish, "The optics of human skin", J. Invest. Dermatol. 77, 1981); melanin has hardly any
 * effect. The other values are assumed: brows 0.15 to 0.35, lips and lids a little darker than
 * skin, lashes, iris and nostrils dark, pupils black. Beards, glasses and the texture of the
 * skin are not modelled. */
#ifndef SIM_WORLD_FACE_SKIN_H
#define SIM_WORLD_FACE_SKIN_H

#include "sim/world/face/ict.h"
#include "sim/world/face/person.h"

/* Fills facet_albedo[ict->n_triangles]. The same person always has the same map. -ENOMEM. */
int sim_skin_albedo(const struct sim_ict *ict, const struct sim_person *person, float *facet_albedo)
    __attribute__((warn_unused_result));

#endif
