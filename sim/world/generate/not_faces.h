/* The preset `not-faces`: scenes that must not be taken for a face.
 *
 * Rows of the manifest: recording none-KIND-NNNN, subject none, role probe, one frame, note KIND:
 * back, profile, ear, hood, hand, wall, ball, chair, coat, plant, cushion; per_kind of each. The
 * column `expression` is the variant: turned+95, two-palm, corner, balloon-r104, slats, hanger, ...
 */
#ifndef SIM_WORLD_GENERATE_NOT_FACES_H
#define SIM_WORLD_GENERATE_NOT_FACES_H

#include "sim/world/generate/studio.h"

/* The number of recordings. */
int sim_not_faces_count(int per_kind);

/* per_kind is at least 1. Errors of sim_studio_record. */
int sim_not_faces_record(struct sim_studio *studio, const struct sim_ict *ict,
                         const struct sim_sensor *sensor, uint64_t seed, int per_kind,
                         struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
