/* How much near-infrared light the parts of a head scatter back: a map of albedo over the head
 * model's triangles, drawn about the curves of its landmarks.
 *
 * At 850 nm skin of every tone scatters back some 0.5 to 0.65 (Anderson and Parrish, "The optics of
 * human skin", J. Invest. Dermatol. 77, 1981), and melanin hardly shows. The rest is assumed: brows
 * 0.15 to 0.35, lips and lids a little darker than skin, lashes, iris and nostrils dark, pupils
 * black. No beard, no glasses, no texture of the skin. */
#ifndef SIM_WORLD_FACE_SKIN_H
#define SIM_WORLD_FACE_SKIN_H

#include "sim/world/face/ict.h"
#include "sim/world/face/person.h"

/* Fills facet_albedo[ict->n_triangles] for a person: the same person, the same map. -ENOMEM. */
int sim_skin_albedo(const struct sim_ict *ict, const struct sim_person *person, float *facet_albedo)
    __attribute__((warn_unused_result));

#endif
