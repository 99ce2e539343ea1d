/* Corpora of synthetic people, by preset. */
#ifndef SIM_WORLD_GENERATE_GENERATE_H
#define SIM_WORLD_GENERATE_GENERATE_H

#include "core/base/fault.h"
#include "sim/world/sensor/sensor.h"

struct sim_generate_options {
    const char *ict_directory, *directory;
    const char *preset;              /* "mild", "strong", "crowd", "pairs", "texas", "hard", "pose",
                                      * "bowed", "far", "landmarks", "training", "attacks",
                                      * "attacks-turned", "not-faces", "stored" */
    const struct sim_sensor *sensor; /* NULL: the preset's own */
    const char *population;
    uint64_t seed;
    int n_people, n_strangers, n_probes; /* the preset's own if < 0; n_probes counts the probes of
                                            all enrolled people together */
    int frames_per_visit;                /* the preset's own if < 1 */
    int n_sessions; /* for each person of "landmarks" and "training"; the preset's own if < 0 */
    int n_per_kind; /* rows for each kind of "attacks" and "not-faces"; the preset's own if < 0 */
    double pose_limit_rad;  /* greatest yaw of "landmarks" and "training" */
    double pitch_limit_rad; /* greatest pitch of the same; 0: 0.7 of the yaw */
    /* Distance of the nose tip, except in gallery sessions; both 0: the preset's own. */
    double near_mm, far_mm;
    double noise_scale;       /* factor on the sensor's random errors; the preset's own if < 0 */
    double identity_variance; /* 1: the head model's; 0.36: people who look alike; the preset's own
                                 if < 0 */
    bool keeps_hair; /* the people of visits and of "landmarks" and "training" have hair that
                        stays between sessions, more fringes and more long hair */
    bool marks;      /* landmarks.csv has 25 points instead of twelve */
    bool infrared;   /* recordings have an infrared image for each depth frame */
};

/* Preset "mild", population "test", seed 1, a pose limit of 35 degrees; the preset's own values for
 * all other options. The caller sets the directories. */
struct sim_generate_options sim_generate_options_default(void);

/* Renders the corpus: the same options make the same bytes. -EINVAL with *fault for an unknown
 * preset, counts out of range (1..9999 people, sessions and rows of a kind, at most 9999 strangers,
 * 99999 probes, 999 frames for a visit), a noise scale or a variance above 100, a pose limit
 * or a pitch limit outside 0..90 degrees, distances outside 100..10000 mm or in falling order, or a
 * preset with instruments for a sensor that sees nothing but skin. Otherwise the errors of the head
 * model and of writing. */
int sim_generate(const struct sim_generate_options *options, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
