/* The presets `attacks` and `attacks-turned`: presentation attacks, and living people for
 * comparison. In `attacks-turned` every instrument is turned away from the camera. A person who
 * wears an instrument is turned by the same angle. Living people without an instrument are the
 * same in both presets.
 *
 * Rows of the manifest:
 *   subject  role      note        frames
 *   pNNNN    gallery   O           1       the people who are enrolled, one neutral session each
 *   pNNNN    probe     O bona-fide 1       the same people, mild (every third one strong), once
 *   pNNNN    probe     O bona-fide F       and for F frames, standing more or less still
 *   none     impostor  photo-flat, photo-bent, screen, mask-small, mask-large, print-eyes-cut   1
 *   none     impostor  mask-still  F       a print of true size on a stand
 *   none     impostor  frozen      F       one frame of an enrolled person, repeated bit by bit
 *
 * O is the origin of the people, POPULATION-SEED (sim/corpus/corpus.h). There are per_kind rows of
 * each kind, the bona fide ones per_kind of either length. Recordings of
 * instruments are called none-KIND-NNNN; the one with number N impersonates the enrolled person
 * N modulo n_people. The column `expression` of an instrument is its variant: a4-paper,
 * rolled-r120, s-hollow-r80, creased-25deg, tablet-lost60-behind12, head-x0.613, worn-gap14, empty,
 * ... */
#ifndef SIM_WORLD_GENERATE_ATTACKS_H
#define SIM_WORLD_GENERATE_ATTACKS_H

#include "sim/world/generate/staging.h"

struct sim_attacks_plan {
    const char *population; /* of the people who are enrolled */
    uint64_t seed;
    double identity_variance;
    int n_people, per_kind; /* at least 1 */
    int frames;             /* F, at least 2 */
    struct sim_turn turn;   /* of the instruments */
};

/* The number of recordings that a plan makes. */
int sim_attacks_count(const struct sim_attacks_plan *plan);

/* Errors of sim_studio_record. */
int sim_attacks_record(struct sim_studio *studio, const struct sim_ict *ict,
                       const struct sim_sensor *sensor, const struct sim_attacks_plan *plan,
                       struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
