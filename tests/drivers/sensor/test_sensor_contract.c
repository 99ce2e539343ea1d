/* What every back end of the sensor class owes its user (drivers/sensor/contract/sensor.h), on
 * every stage (sensor_contract.h). What a stage cannot show is counted and printed. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <cmocka.h>

#include "drivers/sensor/contract/sensor.h"
#include "tests/drivers/sensor/sensor_contract.h"
#include "tests/support/devices/manual_clock.h"
#include "tests/support/scratch.h"
#include "tests/support/stored_frames.h"

#define MS INT64_C(1000000)

/* What a test runs on. */
struct set {
    const struct sensor_stage *stage;
    struct sensor_scene scene;
    struct iso_sensor *sensor;
};

static int open_again(struct set *set, struct iso_fault *fault)
{
    struct iso_clock clock = manual_clock(&set->scene.now_ns);
    return iso_sensor_open(set->stage->back_end, set->scene.options, set->scene.n_options, &clock,
                           &set->sensor, fault);
}

static void start(struct set *set)
{
    struct iso_fault fault = {.text = ""};
    if (iso_sensor_start(set->sensor, &fault)) {
        fail_msg("%s: %s", set->stage->name, fault.text);
    }
}

/* The one that is set up, so that a test that fails leaves nothing behind. */
static struct set current;

static int clear_away(void **state)
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

/* Runs a test on every stage that `fits` (NULL: on all). */
static void on_every_stage(void (*test)(struct set *set),
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
        current = (struct set){.stage = sensor_stages[i], .scene = {.shutter_fd = -1}};
        assert_int_equal(scratch_setup(&scratch), 0);
        current.scene.scratch = scratch;
        current.scene.now_ns = INT64_C(3600) * 1000 * MS;
        current.stage->set_up(&current.scene);
        if (open_again(&current, &fault)) {
            fail_msg("%s: %s", current.stage->name, fault.text);
        }
        test(&current);
        assert_int_equal(clear_away(NULL), 0);
        ran++;
    }
    if (left_out > 0) {
        print_message("  %d stages, and %d that cannot show it\n", ran, left_out);
    }
    if (ran == 0) {
        skip();
    }
}

/* ---- frames ---- */

static void offer(struct set *set)
{
    if (set->stage->offer) {
        set->stage->offer(&set->scene);
    }
}

/* Waits for what has been offered, or is due by the clock: 0 or an error other than a time-out. */
static int fetch(struct set *set, const struct iso_frame **frame, struct iso_fault *fault)
{
    for (int tries = 0; tries < 1000; tries++) {
        int64_t due_ns;
        const int error = iso_sensor_wait(set->sensor, set->scene.now_ns + 10000 * MS, frame,
                                          fault);
        if (error != -ETIMEDOUT) {
            return error;
        }
        if (iso_sensor_next_due_ns(set->sensor, &due_ns)) {
            break; /* it has waited long enough */
        }
        set->scene.now_ns = due_ns > set->scene.now_ns ? due_ns : set->scene.now_ns;
    }
    fail_msg("%s: no frame", set->stage->name);
    return -ETIMEDOUT;
}

static const struct iso_frame *next(struct set *set)
{
    const struct iso_frame *frame = NULL;
    struct iso_fault fault = {.text = ""};
    offer(set);
    if (fetch(set, &frame, &fault)) {
        fail_msg("%s: %s", set->stage->name, fault.text);
    }
    return frame;
}

/* The frame is number `stored` of the recording, bit by bit. */
static void expect_frame(const struct set *set, const struct iso_frame *frame, int stored)
{
    const char *flaw = "";
    const int bad = iso_frame_check(frame, &flaw);
    assert_string_equal(flaw, "");
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

static void deliver(struct set *set)
{
    uint64_t sequence = 0;
    int64_t t_ns = 0;
    start(set);
    for (int i = 0; i < SENSOR_STAGE_FRAMES; i++) {
        const struct iso_frame *frame = next(set);
        expect_frame(set, frame, i);
        assert_true(i == 0 || frame->sequence == sequence + 1);
        assert_true(i == 0 || frame->t_ns > t_ns);
        assert_true(frame->t_ns <= set->scene.now_ns);
        sequence = frame->sequence;
        t_ns = frame->t_ns;
    }
    const struct iso_sensor_health health = iso_sensor_health(set->sensor);
    assert_int_equal(health.frames, SENSOR_STAGE_FRAMES);
    assert_int_equal(health.lost, 0);
    assert_int_equal(health.faults, 0);
    assert_int_equal(health.refused, 0);
    assert_int_equal(health.device.dropped, 0);
    assert_string_equal(health.device.state, "");
    assert_int_equal(health.last_frame_ns, set->scene.now_ns);
}

static void delivers_every_frame_bit_by_bit_and_in_order(void **state)
{
    (void)state;
    on_every_stage(deliver, NULL);
}

/* The camera of a field of view is one of 32 bits. */
static void see(struct set *set)
{
    start(set);
    const struct iso_camera *camera = &next(set)->camera;
    assert_int_equal(camera->projection, ISO_PINHOLE);
    assert_int_equal(camera->width_px, STORED_WIDTH);
    assert_int_equal(camera->height_px, STORED_HEIGHT);
    assert_true(fabs(camera->fx_px - 570.5) < 1e-3);
    assert_true(fabs(camera->fy_px - 571.25) < 1e-3);
    assert_true(camera->cx_px == (STORED_WIDTH - 1) / 2.0);
    assert_true(camera->cy_px == (STORED_HEIGHT - 1) / 2.0);
}

static bool has_the_plain_camera(const struct sensor_stage *stage)
{
    return stage->expect == NULL;
}

static void frames_carry_the_camera(void **state)
{
    (void)state;
    on_every_stage(see, has_the_plain_camera);
}

static void reuse(struct set *set)
{
    start(set);
    const float *plane = next(set)->depth_mm;
    (void)next(set);
    assert_ptr_equal(next(set)->depth_mm, plane);
}

static void uses_its_buffer_again(void **state)
{
    (void)state;
    on_every_stage(reuse, NULL);
}

/* ---- waiting ---- */

static int64_t real_ns(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec * INT64_C(1000000000) + now.tv_nsec;
}

/* With nothing to come: not a moment of a deadline in the past, all of one in the future by a back
 * end that blocks, and none of it by one that does not. */
static void run_out(struct set *set)
{
    const struct iso_frame *frame = NULL;
    int64_t due_ns = 0;
    start(set);
    for (int i = 0; !set->stage->offer && i < SENSOR_STAGE_FRAMES; i++) {
        (void)next(set);
    }
    const bool blocks = iso_sensor_next_due_ns(set->sensor, &due_ns) != 0;
    assert_int_equal(iso_sensor_wait(set->sensor, set->scene.now_ns, &frame, NULL), -ETIMEDOUT);
    assert_int_equal(iso_sensor_wait(set->sensor, 0, &frame, NULL), -ETIMEDOUT);
    const int64_t before_ns = real_ns();
    assert_int_equal(iso_sensor_wait(set->sensor, set->scene.now_ns + 70 * MS, &frame, NULL),
                     -ETIMEDOUT);
    assert_true(!blocks || real_ns() - before_ns >= 69 * MS);
    assert_null(frame);
    assert_int_equal(iso_sensor_health(set->sensor).faults, 0);
    if (blocks) {
        expect_frame(set, next(set), 0); /* and is none the worse for it */
    } else {
        assert_int_equal(iso_sensor_next_due_ns(set->sensor, &due_ns), 0);
        assert_true(due_ns > set->scene.now_ns); /* nobody is kept busy by an end */
    }
}

static void keeps_deadlines(void **state)
{
    (void)state;
    on_every_stage(run_out, NULL);
}

static void tell(struct set *set)
{
    struct iso_sensor_description description = {.unit_mm = -1.0};
    const int error = iso_sensor_describe(set->sensor, &description);
    assert_true(error == 0 || error == -ENODATA || error == -ENOSYS);
    start(set);
    const struct iso_frame *frame = next(set);
    if (iso_sensor_describe(set->sensor, &description) != -ENOSYS) {
        assert_int_equal(description.width_px, frame->width_px);
        assert_int_equal(description.height_px, frame->height_px);
        assert_int_equal(description.intensity, frame->intensity != NULL);
        assert_true(strlen(description.model) > 0);
        assert_true(description.unit_mm == 0.0 || description.unit_mm == set->scene.unit_mm);
        assert_true(description.rate_hz >= 0.0);
    }
}

static void describes_what_it_delivers(void **state)
{
    (void)state;
    on_every_stage(tell, NULL);
}

/* ---- states ---- */

static void stop_and_go(struct set *set)
{
    const struct iso_frame *frame = NULL;
    uint64_t sequence = 0;
    int64_t t_ns = 0;
    for (int i = 0; i < 3; i++) {
        start(set);
        assert_int_equal(iso_sensor_start(set->sensor, NULL), -EBADFD);
        for (int f = 0; f <= i; f++) {
            const struct iso_frame *fresh = next(set);
            expect_frame(set, fresh, f); /* from the first one at each start */
            assert_true((i == 0 && f == 0) || fresh->sequence > sequence);
            assert_true((i == 0 && f == 0) || fresh->t_ns > t_ns);
            sequence = fresh->sequence;
            t_ns = fresh->t_ns;
        }
        assert_int_equal(iso_sensor_stop(set->sensor, NULL), 0);
        assert_int_equal(iso_sensor_stop(set->sensor, NULL), -EBADFD);
        assert_int_equal(iso_sensor_wait(set->sensor, set->scene.now_ns, &frame, NULL), -EBADFD);
        set->scene.now_ns += 1000 * MS;
    }
}

static void starts_and_stops_again_and_again(void **state)
{
    (void)state;
    on_every_stage(stop_and_go, NULL);
}

static void close_open(struct set *set)
{
    assert_int_equal(iso_sensor_health(set->sensor).state, ISO_SENSOR_OPEN);
}

static void close_started(struct set *set)
{
    start(set);
}

static void close_streaming(struct set *set)
{
    start(set);
    (void)next(set);
    offer(set); /* and does not fetch it */
}

static void close_stopped(struct set *set)
{
    start(set);
    (void)next(set);
    assert_int_equal(iso_sensor_stop(set->sensor, NULL), 0);
}

static void may_be_closed_at_any_time(void **state)
{
    (void)state;
    on_every_stage(close_open, NULL);
    on_every_stage(close_started, NULL);
    on_every_stage(close_streaming, NULL);
    on_every_stage(close_stopped, NULL);
}

/* ---- what goes wrong ---- */

static bool can_lose(const struct sensor_stage *stage)
{
    return stage->lose != NULL;
}

static void lose_one(struct set *set)
{
    const struct iso_frame *frame = NULL;
    if (!set->stage->offer) {
        set->stage->lose(&set->scene, 2);
    }
    start(set);
    (void)next(set);
    const uint64_t before = next(set)->sequence;
    if (set->stage->offer) {
        set->stage->lose(&set->scene, 2);
    }
    offer(set);
    struct iso_fault fault = {.text = ""};
    int error = fetch(set, &frame, &fault);
    if (error) { /* a back end may say that a frame is damaged, once */
        assert_int_equal(error, -EBADMSG);
        assert_true(strlen(fault.text) > 0);
        error = fetch(set, &frame, &fault);
    }
    assert_int_equal(error, 0);
    expect_frame(set, frame, 3);
    assert_int_equal(frame->sequence, before + 2);
    assert_int_equal(iso_sensor_health(set->sensor).lost, 1);
    assert_int_equal(iso_sensor_health(set->sensor).state, ISO_SENSOR_STARTED);
    expect_frame(set, next(set), 4);
    assert_int_equal(iso_sensor_health(set->sensor).lost, 1);
    /* For longer than a device has buffers, in one of which the lost frame was. */
    for (uint64_t i = 0; set->stage->offer && i < 2 * (uint64_t)SENSOR_STAGE_FRAMES; i++) {
        frame = next(set);
        expect_frame(set, frame, (int)(i % SENSOR_STAGE_FRAMES));
        assert_int_equal(frame->sequence, before + 4 + i);
    }
    assert_int_equal(iso_sensor_health(set->sensor).lost, 1);
}

static void a_lost_frame_is_a_gap(void **state)
{
    (void)state;
    on_every_stage(lose_one, can_lose);
}

static bool can_unplug(const struct sensor_stage *stage)
{
    return stage->plug != NULL;
}

static void expect_lost(struct set *set)
{
    const struct iso_frame *frame = NULL;
    struct iso_fault fault = {.text = ""};
    assert_int_equal(fetch(set, &frame, &fault), -ENODEV);
    assert_true(strlen(fault.text) > 0);
    assert_null(frame);
    assert_int_equal(iso_sensor_health(set->sensor).state, ISO_SENSOR_LOST);
    assert_int_equal(iso_sensor_wait(set->sensor, set->scene.now_ns, &frame, NULL), -ENODEV);
    assert_int_equal(iso_sensor_stop(set->sensor, NULL), -ENODEV);
    assert_int_equal(iso_sensor_start(set->sensor, NULL), -ENODEV);
}

/* Opens it as soon as the system has noticed that it is there again. */
static void open_when_there(struct set *set)
{
    const int64_t end_ns = real_ns() + 10000 * MS;
    struct iso_fault fault = {.text = ""};
    int error = -ENODEV;
    while (error == -ENODEV && real_ns() < end_ns) {
        error = open_again(set, &fault);
    }
    if (error) {
        fail_msg("%s: %s", set->stage->name, fault.text);
    }
}

static void pull_the_cable(struct set *set)
{
    struct iso_fault fault = {.text = ""};
    start(set);
    expect_frame(set, next(set), 0);
    for (int i = 0; i < 3; i++) {
        set->stage->plug(&set->scene, false);
        expect_lost(set);
        iso_sensor_close(set->sensor);
        set->sensor = NULL;
        assert_int_equal(open_again(set, &fault), -ENODEV);
        assert_true(strlen(fault.text) > 0);
        assert_null(set->sensor);
        set->stage->plug(&set->scene, true);
        open_when_there(set);
        start(set);
        expect_frame(set, next(set), 0);
        expect_frame(set, next(set), 1);
    }
}

static void pull_it_before_the_start(struct set *set)
{
    const struct iso_frame *frame = NULL;
    set->stage->plug(&set->scene, false);
    const int64_t end_ns = real_ns() + 10000 * MS;
    int error = iso_sensor_start(set->sensor, NULL);
    while (error == -EIO && real_ns() < end_ns) { /* a library may hear of it a little later */
        error = iso_sensor_start(set->sensor, NULL);
    }
    if (!error) {
        error = fetch(set, &frame, NULL); /* as soon as it is noticed */
    }
    assert_int_equal(error, -ENODEV);
    assert_int_equal(iso_sensor_health(set->sensor).state, ISO_SENSOR_LOST);
}

static void is_lost_and_found(void **state)
{
    (void)state;
    on_every_stage(pull_the_cable, can_unplug);
    on_every_stage(pull_it_before_the_start, can_unplug);
}

static void refuses_unknown_options(void **state)
{
    (void)state;
    for (int i = 0; sensor_stages[i]; i++) {
        int64_t now_ns = 0;
        struct iso_clock clock = manual_clock(&now_ns);
        const struct iso_option option = {"no-such-option", "1"};
        struct iso_sensor *sensor = NULL;
        struct iso_fault fault = {.text = ""};
        assert_int_equal(
            iso_sensor_open(sensor_stages[i]->back_end, &option, 1, &clock, &sensor, &fault),
            -EINVAL);
        assert_non_null(strstr(fault.text, sensor_stages[i]->back_end));
        assert_non_null(strstr(fault.text, "no-such-option"));
        assert_null(sensor);
    }
}

static bool has_a_stage(const char *back_end)
{
    for (int i = 0; sensor_stages_elsewhere[i]; i++) {
        if (strcmp(sensor_stages_elsewhere[i], back_end) == 0) {
            return true;
        }
    }
    for (int i = 0; sensor_stages[i]; i++) {
        if (strcmp(sensor_stages[i]->back_end, back_end) == 0) {
            return true;
        }
    }
    return false;
}

static void no_back_end_is_left_out(void **state)
{
    (void)state;
    for (size_t r = 0; iso_sensor_registered(r); r++) {
        if (!has_a_stage(iso_sensor_registered(r))) {
            fail_msg("%s has no stage", iso_sensor_registered(r));
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_teardown(delivers_every_frame_bit_by_bit_and_in_order, clear_away),
        cmocka_unit_test_teardown(frames_carry_the_camera, clear_away),
        cmocka_unit_test_teardown(uses_its_buffer_again, clear_away),
        cmocka_unit_test_teardown(keeps_deadlines, clear_away),
        cmocka_unit_test_teardown(describes_what_it_delivers, clear_away),
        cmocka_unit_test_teardown(starts_and_stops_again_and_again, clear_away),
        cmocka_unit_test_teardown(may_be_closed_at_any_time, clear_away),
        cmocka_unit_test_teardown(a_lost_frame_is_a_gap, clear_away),
        cmocka_unit_test_teardown(is_lost_and_found, clear_away),
        cmocka_unit_test_teardown(refuses_unknown_options, clear_away),
        cmocka_unit_test_teardown(no_back_end_is_left_out, clear_away),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
