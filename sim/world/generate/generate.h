/* Corpora of synthetic people, by preset. */
#ifndef SIM_WORLD_GENERATE_GENERATE_H
#define SIM_WORLD_GENERATE_GENERATE_H

#include "core/base/fault.h"
#include "sim/world/sensor/sensor.h"

struct sim_generate_options {
    const char *ict_directory, *directory;
    const char *preset;              /* "mild", "strong", "crowd", "pairs", "texas", "hard", "pose",
                                      * "far", "landmarks", "training", "attacks", "not-faces",
                                      * "stored" */
    const struct sim_sensor *sensor; /* NULL: the preset's own */
    const char *population;
    uint64_t seed;
    int n_people, n_strangers,
        n_probes;         /* the preset's own if < 0; probes of enrolled people, in all */
    int frames_per_visit; /* the preset's own if < 1 */
    int n_sessions; /* of every person of "landmarks" and "training"; the preset's own if < 0 */
    int n_per_kind; /* of "attacks", "not-faces"; the preset's own if < 0 */
    double pose_limit_rad;    /* of "landmarks" and "training" */
    double near_mm, far_mm;   /* where all but the gallery stand, nose tip; both 0: as the preset
                                 has it */
    double noise_scale;       /* of the sensor's random errors; the preset's own if < 0 */
    double identity_variance; /* 1: the head model's; 0.36: people who look alike; the preset's own
                                 if < 0 */
    bool marks;               /* 25 points in landmarks.csv, not only the twelve */
    bool infrared;            /* recordings have an infrared image beside the depth */
};

struct sim_generate_options sim_generate_options_default(void);

/* Renders the corpus: the same options make the same bytes. -EINVAL with *fault for an unknown
 * preset, counts out of range (1..9999 people, sessions and rows a kind, at most 999 frames a
 * visit), distances outside 100..10000 mm or falling, or a sensor that sees nothing but skin and a
 * preset with instruments; or errors of the head model and of writing. */
int sim_generate(const struct sim_generate_options *options, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
