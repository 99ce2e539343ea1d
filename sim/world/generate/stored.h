/* The corpus that is committed with the project (sim/stored). The demo and the tests replay it. */
#ifndef SIM_WORLD_GENERATE_STORED_H
#define SIM_WORLD_GENERATE_STORED_H

#include "sim/world/generate/studio.h"

/* The number of recordings. */
int sim_stored_count(void);

/* 24 people to enrol (a gallery session of 5 frames and two visits of 3 frames each), 12
 * strangers (two visits of 3 frames), and scenes without a usable face: an empty room,
 * furniture, the back of a head, a face cut by the image border, and a photograph held up flat
 * and bent. Errors of sim_studio_record. */
int sim_stored_record(struct sim_studio *studio, const struct sim_ict *ict,
                      const struct sim_sensor *sensor, uint64_t seed, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
