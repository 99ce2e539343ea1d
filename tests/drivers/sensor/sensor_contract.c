#include "tests/drivers/sensor/sensor_contract.h"

#include <errno.h>
#include <math.h>
#include <time.h>

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/support/devices/manual_clock.h"
#include "tests/support/scratch.h"
#include "tests/support/stored_frames.h"

#define MS INT64_C(1000000)

int stage_open(struct sensor_set *set, struct iso_fault *fault)
{
    struct iso_clock clock = manual_clock(&set->scene.now_ns);
    return iso_sensor_open(set->stage->back_end, set->scene.options, set->scene.n_options, &clock,
                           &set->sensor, fault);
}

void stage_start(struct sensor_set *set)
{
    struct iso_fault fault = {.text = ""};
    if (iso_sensor_start(set->sensor, &fault)) {
        fail_msg("%s: %s", set->stage->name, fault.text);
    }
}

/* The stage in use. The tear-down needs it after a failed test. */
static struct sensor_set current;

int stage_clear_away(void **state)
{
    void *scratch = (void *)(uintptr_t)current.scene.scratch;
    (void)state;
    iso_sensor_close(current.sensor);
    current.sensor = NULL;
    if (!scratch) {
        return 0;
    }
    if (current.stage->tear_down) {
        current.stage->tear_down(&current.scene);
    }
    current.scene.scratch = NULL;
    return scratch_teardown(&scratch);
}

/* Runs a test on every stage for which `fits` returns true (NULL: on all). */
void on_every_stage(void (*test)(struct sensor_set *set),
                    bool (*fits)(const struct sensor_stage *stage))
{
    int ran = 0, left_out = 0;
    for (int i = 0; sensor_stages[i]; i++) {
        struct iso_fault fault = {.text = ""};
        void *scratch = NULL;
        if (fits && !fits(sensor_stages[i])) {
            left_out++;
            continue;
        }
        current = (struct sensor_set){.stage = sensor_stages[i], .scene = {.shutter_fd = -1}};
        assert_int_equal(scratch_setup(&scratch), 0);
        current.scene.scratch = scratch;
        current.scene.now_ns = INT64_C(3600) * 1000 * MS;
        current.stage->set_up(&current.scene);
        if (stage_open(&current, &fault)) {
            fail_msg("%s: %s", current.stage->name, fault.text);
        }
        test(&current);
        assert_int_equal(stage_clear_away(NULL), 0);
        ran++;
    }
    if (left_out > 0) {
        print_message("  ran on %d stages; %d cannot run this test\n", ran, left_out);
    }
    if (ran == 0) {
        skip();
    }
}

void stage_offer(struct sensor_set *set)
{
    if (set->stage->offer) {
        set->stage->offer(&set->scene);
    }
}

/* Waits for a frame that was offered, or that is due by the clock. Returns 0, or an error other
 * than a time-out. */
int stage_fetch(struct sensor_set *set, const struct iso_frame **frame, struct iso_fault *fault)
{
    for (int tries = 0; tries < 1000; tries++) {
        int64_t due_ns;
        const int error = iso_sensor_wait(set->sensor, set->scene.now_ns + 10000 * MS, frame,
                                          fault);
        if (error != -ETIMEDOUT) {
            return error;
        }
        if (iso_sensor_next_due_ns(set->sensor, &due_ns)) {
            break; /* the wait was long enough */
        }
        set->scene.now_ns = due_ns > set->scene.now_ns ? due_ns : set->scene.now_ns;
    }
    fail_msg("%s: no frame", set->stage->name);
    return -ETIMEDOUT;
}

const struct iso_frame *stage_next(struct sensor_set *set)
{
    const struct iso_frame *frame = NULL;
    struct iso_fault fault = {.text = ""};
    stage_offer(set);
    if (stage_fetch(set, &frame, &fault)) {
        fail_msg("%s: %s", set->stage->name, fault.text);
    }
    return frame;
}

/* Asserts that the frame equals frame number `stored` of the recording bit by bit. */
void stage_expect_frame(const struct sensor_set *set, const struct iso_frame *frame, int stored)
{
    struct iso_fault flaw = {.text = ""};
    const int bad = iso_frame_check(frame, &flaw);
    assert_string_equal(flaw.text, "");
    assert_int_equal(bad, 0);
    if (set->stage->expect) {
        set->stage->expect(&set->scene, frame, stored);
        return;
    }
    assert_int_equal(frame->width_px, STORED_WIDTH);
    assert_int_equal(frame->height_px, STORED_HEIGHT);
    assert_int_equal(frame->crop_x_px, 0);
    assert_int_equal(frame->crop_y_px, 0);
    assert_int_equal(frame->intensity != NULL, set->scene.intensity);
    for (int row = 0; row < STORED_HEIGHT; row++) {
        for (int column = 0; column < STORED_WIDTH; column++) {
            const int pixel = row * STORED_WIDTH + column;
            const int count = pixel == 0 ? 0 : 1000 + 100 * stored + 10 * row + column;
            const int grey = 3000 + 500 * stored + 70 * row + column;
            assert_true(frame->depth_mm[pixel] == (float)(count * set->scene.unit_mm));
            if (frame->intensity) {
                assert_int_equal(lround((double)frame->intensity[pixel] * 65535.0), grey);
                assert_true(fabs((double)frame->intensity[pixel] - grey / 65535.0) < 1e-7);
            }
        }
    }
}

int64_t stage_real_ns(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec * INT64_C(1000000000) + now.tv_nsec;
}

/* Opens the sensor as soon as the system has noticed that the camera is plugged in again. */
void stage_open_when_there(struct sensor_set *set)
{
    const int64_t end_ns = stage_real_ns() + 10000 * MS;
    struct iso_fault fault = {.text = ""};
    int error = -ENODEV;
    while (error == -ENODEV && stage_real_ns() < end_ns) {
        error = stage_open(set, &fault);
    }
    if (error) {
        fail_msg("%s: %s", set->stage->name, fault.text);
    }
}
