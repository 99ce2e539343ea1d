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

/* What a test runs on. */
struct sensor_set {
    const struct sensor_stage *stage;
    struct sensor_scene scene;
    struct iso_sensor *sensor;
};

/* Runs a test on every stage that `fits` (NULL: on all), and prints how many do not; skips the test
 * if none does. */
void on_every_stage(void (*test)(struct sensor_set *set),
                    bool (*fits)(const struct sensor_stage *stage));

/* cmocka tear-down: a test that fails leaves nothing behind. */
int stage_clear_away(void **state);

/* Opens the sensor of the stage, once more after it was closed. */
int stage_open(struct sensor_set *set, struct iso_fault *fault);
void stage_start(struct sensor_set *set);

/* Opens it as soon as the system has noticed that it is there again. */
void stage_open_when_there(struct sensor_set *set);

/* The real time, which the injected clock does not show. */
int64_t stage_real_ns(void);

/* Has the camera make a frame; nothing where frames come by the clock. */
void stage_offer(struct sensor_set *set);

/* Waits for what has been offered, or is due by the clock: 0 or an error other than a time-out. */
int stage_fetch(struct sensor_set *set, const struct iso_frame **frame, struct iso_fault *fault);

/* Offers a frame and fetches it. */
const struct iso_frame *stage_next(struct sensor_set *set);

/* The frame is number `stored` of the recording, bit by bit. */
void stage_expect_frame(const struct sensor_set *set, const struct iso_frame *frame, int stored);

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
