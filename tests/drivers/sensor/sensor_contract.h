/* A stage is a set-up in which the contract suite of the sensor class (test_sensor_contract.c)
 * tests one back end. On a stage the sensor delivers the frames of stored_frames_write_plain() one
 * after the other, and begins with the first one at each start.
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

/* A stage in use. */
struct sensor_scene {
    const char *scratch; /* a directory of its own */
    int64_t now_ns;      /* the time of the injected clock */
    struct iso_option options[SENSOR_STAGE_OPTIONS];
    size_t n_options;
    double unit_mm;
    bool intensity; /* the sensor is opened so that its frames have an intensity image */
    int shutter_fd; /* takes the requests for frames; -1: a stage without a camera */
    void *world;    /* data of the stage */
};

struct sensor_stage {
    const char *name;     /* the name of the stage */
    const char *back_end; /* the back end that it tests */

    /* REQUIRED. Prepares the stage and fills in options, unit_mm and intensity. */
    void (*set_up)(struct sensor_scene *scene);

    /* OPTIONAL. Undoes what is outside the scratch directory. */
    void (*tear_down)(struct sensor_scene *scene);

    /* OPTIONAL. Makes the camera deliver the next frame; without it the frames come by the clock.
     * The first frame follows the last one. */
    void (*offer)(struct sensor_scene *scene);

    /* OPTIONAL. Loses frame number `stored` between the camera and the back end. On a stage with
     * `offer` the suite calls it in place of an offer, on another stage before the start. */
    void (*lose)(struct sensor_scene *scene, int stored);

    /* OPTIONAL. Unplugs the camera, or plugs it in again. */
    void (*plug)(struct sensor_scene *scene, bool in);

    /* OPTIONAL, for a stage with frames of its own: asserts that a frame equals frame number
     * `stored` bit by bit. */
    void (*expect)(const struct sensor_scene *scene, const struct iso_frame *frame, int stored);
};

/* A stage and its open sensor, for one test. */
struct sensor_set {
    const struct sensor_stage *stage;
    struct sensor_scene scene;
    struct iso_sensor *sensor;
};

/* Runs a test on every stage for which `fits` returns true (NULL: on all), and prints the number of
 * the other stages. It skips the test if no stage fits. */
void on_every_stage(void (*test)(struct sensor_set *set),
                    bool (*fits)(const struct sensor_stage *stage));

/* cmocka tear-down: removes what a failed test has left. */
int stage_clear_away(void **state);

/* Opens the sensor of the stage, also again after it was closed. Returns the error of
 * iso_sensor_open. */
int stage_open(struct sensor_set *set, struct iso_fault *fault);
/* Starts the open sensor. An error fails the test. */
void stage_start(struct sensor_set *set);

/* Opens the sensor as soon as the system has noticed that the camera is plugged in again. */
void stage_open_when_there(struct sensor_set *set);

/* Returns the real time in ns (CLOCK_MONOTONIC), which is not the time of the injected clock. */
int64_t stage_real_ns(void);

/* Makes the camera deliver a frame. It does nothing on a stage whose frames come by the clock. */
void stage_offer(struct sensor_set *set);

/* Waits for a frame that was offered, or that is due by the clock. Returns 0, or an error other
 * than a time-out. */
int stage_fetch(struct sensor_set *set, const struct iso_frame **frame, struct iso_fault *fault);

/* Offers a frame and fetches it. The frame is valid until the next call. No frame fails the test.
 */
const struct iso_frame *stage_next(struct sensor_set *set);

/* Asserts that the frame equals frame number `stored` of the recording bit by bit. */
void stage_expect_frame(const struct sensor_set *set, const struct iso_frame *frame, int stored);

/* The stages of this program, NULL at the end. */
extern const struct sensor_stage *const sensor_stages[];

/* The back ends whose stages are in another program, NULL at the end. Back ends that need the
 * cameras of a kernel have their stages in the program of the virtual machine (tests/vm). */
extern const char *const sensor_stages_elsewhere[];

extern const struct sensor_stage sensor_stage_replay;
extern const struct sensor_stage sensor_stage_replay_intensity;
extern const struct sensor_stage sensor_stage_openni2_1mm;
extern const struct sensor_stage sensor_stage_openni2_100um;
extern const struct sensor_stage sensor_stage_openni2_ir;
extern const struct sensor_stage sensor_stage_oni;
extern const struct sensor_stage sensor_stage_oni_ir;

#endif
