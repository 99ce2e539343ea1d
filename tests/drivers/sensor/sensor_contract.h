/* What the contract suite of the sensor class (test_sensor_contract.c) has to know of a back end: a
 * stage, on which its sensor sees the frames of stored_frames_write_plain() one after the other,
 * from the first one at each start.
 *
 * A new back end adds a stage to the table in sensor_stages.c. */
#ifndef TESTS_DRIVERS_SENSOR_SENSOR_CONTRACT_H
#define TESTS_DRIVERS_SENSOR_SENSOR_CONTRACT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "drivers/base/option.h"
#include "drivers/sensor/contract/sensor.h"

enum { SENSOR_STAGE_FRAMES = 5, SENSOR_STAGE_OPTIONS = 8 };

/* A stage that is set up. */
struct sensor_scene {
    const char *scratch; /* a directory of its own */
    int64_t now_ns;      /* what the injected clock shows */
    struct iso_option options[SENSOR_STAGE_OPTIONS];
    size_t n_options;
    double unit_mm;
    bool intensity; /* the sensor is opened so that frames carry one */
    int shutter_fd; /* of stages with a camera */
    void *world;    /* the stage's own */
};

struct sensor_stage {
    const char *name;     /* of the stage */
    const char *back_end; /* that it is for */

    /* REQUIRED. Prepares the stage and fills in options, unit_mm and intensity. */
    void (*set_up)(struct sensor_scene *scene);

    /* OPTIONAL. Undoes what is outside the scratch directory. */
    void (*tear_down)(struct sensor_scene *scene);

    /* OPTIONAL. Has the camera make the next frame; without it they come by the clock. After the
     * last frame there is it begins again with the first. */
    void (*offer)(struct sensor_scene *scene);

    /* OPTIONAL. Has frame number `stored` be lost on its way. Called before the start, and again by
     * a camera's stage in place of the offer. */
    void (*lose)(struct sensor_scene *scene, int stored);

    /* OPTIONAL. Pulls the cable, or puts it in again. */
    void (*plug)(struct sensor_scene *scene, bool in);

    /* OPTIONAL, of a stage with frames of its own: asserts that one is number `stored` of them, bit
     * by bit. */
    void (*expect)(const struct sensor_scene *scene, const struct iso_frame *frame, int stored);
};

/* The stages of this program, NULL at the end. */
extern const struct sensor_stage *const sensor_stages[];

/* The back ends whose stages are in another program: those that need a kernel's cameras in that of
 * the virtual machine (tests/vm), NULL at the end. */
extern const char *const sensor_stages_elsewhere[];

extern const struct sensor_stage sensor_stage_replay;
extern const struct sensor_stage sensor_stage_replay_intensity;
extern const struct sensor_stage sensor_stage_openni2_1mm;
extern const struct sensor_stage sensor_stage_openni2_100um;
extern const struct sensor_stage sensor_stage_openni2_ir;
extern const struct sensor_stage sensor_stage_oni;
extern const struct sensor_stage sensor_stage_oni_ir;

#endif
