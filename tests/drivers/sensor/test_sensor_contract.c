/* The contract of every back end of the sensor class (drivers/sensor/contract/sensor.h), tested on
 * every stage (sensor_contract.h). For each test, the program prints how many stages cannot run it.
 */
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

/* ---- frames ---- */

static void deliver_frames(struct sensor_set *set)
{
    uint64_t sequence = 0;
    int64_t t_ns = 0;
    stage_start(set);
    for (int i = 0; i < SENSOR_STAGE_FRAMES; i++) {
        const struct iso_frame *frame = stage_next(set);
        stage_expect_frame(set, frame, i);
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
    on_every_stage(deliver_frames, NULL);
}

/* A camera that is calculated from a field of view has the accuracy of 32-bit numbers. */
static void see_camera(struct sensor_set *set)
{
    stage_start(set);
    const struct iso_camera *camera = &stage_next(set)->camera;
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
    on_every_stage(see_camera, has_the_plain_camera);
}

static void reuse_buffer(struct sensor_set *set)
{
    stage_start(set);
    const float *plane = stage_next(set)->depth_mm;
    (void)stage_next(set);
    assert_ptr_equal(stage_next(set)->depth_mm, plane);
}

static void uses_its_buffer_again(void **state)
{
    (void)state;
    on_every_stage(reuse_buffer, NULL);
}

/* ---- waiting ---- */

/* No frame comes. A deadline in the past takes no time. A deadline in the future takes the full
 * time in a back end that blocks, and takes no time in another one. */
static void run_out(struct sensor_set *set)
{
    const struct iso_frame *frame = NULL;
    int64_t due_ns = 0;
    stage_start(set);
    for (int i = 0; !set->stage->offer && i < SENSOR_STAGE_FRAMES; i++) {
        (void)stage_next(set);
    }
    const bool blocks = iso_sensor_next_due_ns(set->sensor, &due_ns) != 0;
    assert_int_equal(iso_sensor_wait(set->sensor, set->scene.now_ns, &frame, NULL), -ETIMEDOUT);
    assert_int_equal(iso_sensor_wait(set->sensor, 0, &frame, NULL), -ETIMEDOUT);
    const int64_t before_ns = stage_real_ns();
    assert_int_equal(iso_sensor_wait(set->sensor, set->scene.now_ns + 70 * MS, &frame, NULL),
                     -ETIMEDOUT);
    assert_true(!blocks || stage_real_ns() - before_ns >= 69 * MS);
    assert_null(frame);
    assert_int_equal(iso_sensor_health(set->sensor).faults, 0);
    if (blocks) {
        stage_expect_frame(set, stage_next(set), 0); /* the next frame is still good */
    } else {
        assert_int_equal(iso_sensor_next_due_ns(set->sensor, &due_ns), 0);
        assert_true(due_ns > set->scene.now_ns); /* the end of the frames keeps no caller busy */
    }
}

static void keeps_deadlines(void **state)
{
    (void)state;
    on_every_stage(run_out, NULL);
}

static void tell_description(struct sensor_set *set)
{
    struct iso_sensor_description description = {.unit_mm = -1.0};
    const int error = iso_sensor_describe(set->sensor, &description);
    assert_true(error == 0 || error == -ENODATA || error == -ENOSYS);
    stage_start(set);
    const struct iso_frame *frame = stage_next(set);
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
    on_every_stage(tell_description, NULL);
}

/* ---- states ---- */

static void stop_and_go(struct sensor_set *set)
{
    const struct iso_frame *frame = NULL;
    uint64_t sequence = 0;
    int64_t t_ns = 0;
    for (int i = 0; i < 3; i++) {
        stage_start(set);
        assert_int_equal(iso_sensor_start(set->sensor, NULL), -EBADFD);
        for (int f = 0; f <= i; f++) {
            const struct iso_frame *fresh = stage_next(set);
            stage_expect_frame(set, fresh, f); /* each start begins with the first frame */
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

static void close_open(struct sensor_set *set)
{
    assert_int_equal(iso_sensor_health(set->sensor).state, ISO_SENSOR_OPEN);
}

static void close_started(struct sensor_set *set)
{
    stage_start(set);
}

static void close_streaming(struct sensor_set *set)
{
    stage_start(set);
    (void)stage_next(set);
    stage_offer(set); /* and does not fetch the frame */
}

static void close_stopped(struct sensor_set *set)
{
    stage_start(set);
    (void)stage_next(set);
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

static void lose_one(struct sensor_set *set)
{
    const struct iso_frame *frame = NULL;
    if (!set->stage->offer) {
        set->stage->lose(&set->scene, 2);
    }
    stage_start(set);
    (void)stage_next(set);
    const uint64_t before = stage_next(set)->sequence;
    if (set->stage->offer) {
        set->stage->lose(&set->scene, 2);
    }
    stage_offer(set);
    struct iso_fault fault = {.text = ""};
    int error = stage_fetch(set, &frame, &fault);
    if (error) { /* a back end may report a damaged frame once */
        assert_int_equal(error, -EBADMSG);
        assert_true(strlen(fault.text) > 0);
        error = stage_fetch(set, &frame, &fault);
    }
    assert_int_equal(error, 0);
    stage_expect_frame(set, frame, 3);
    assert_int_equal(frame->sequence, before + 2);
    assert_int_equal(iso_sensor_health(set->sensor).lost, 1);
    assert_int_equal(iso_sensor_health(set->sensor).state, ISO_SENSOR_STARTED);
    stage_expect_frame(set, stage_next(set), 4);
    assert_int_equal(iso_sensor_health(set->sensor).lost, 1);
    /* More frames than a device has buffers; the lost frame was in one of them. */
    for (uint64_t i = 0; set->stage->offer && i < 2 * (uint64_t)SENSOR_STAGE_FRAMES; i++) {
        frame = stage_next(set);
        stage_expect_frame(set, frame, (int)(i % SENSOR_STAGE_FRAMES));
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

static void expect_lost(struct sensor_set *set)
{
    const struct iso_frame *frame = NULL;
    struct iso_fault fault = {.text = ""};
    assert_int_equal(stage_fetch(set, &frame, &fault), -ENODEV);
    assert_true(strlen(fault.text) > 0);
    assert_null(frame);
    assert_int_equal(iso_sensor_health(set->sensor).state, ISO_SENSOR_LOST);
    assert_int_equal(iso_sensor_wait(set->sensor, set->scene.now_ns, &frame, NULL), -ENODEV);
    assert_int_equal(iso_sensor_stop(set->sensor, NULL), -ENODEV);
    assert_int_equal(iso_sensor_start(set->sensor, NULL), -ENODEV);
}

static void pull_the_cable(struct sensor_set *set)
{
    struct iso_fault fault = {.text = ""};
    stage_start(set);
    stage_expect_frame(set, stage_next(set), 0);
    for (int i = 0; i < 3; i++) {
        set->stage->plug(&set->scene, false);
        expect_lost(set);
        iso_sensor_close(set->sensor);
        set->sensor = NULL;
        assert_int_equal(stage_open(set, &fault), -ENODEV);
        assert_true(strlen(fault.text) > 0);
        assert_null(set->sensor);
        set->stage->plug(&set->scene, true);
        stage_open_when_there(set);
        stage_start(set);
        stage_expect_frame(set, stage_next(set), 0);
        stage_expect_frame(set, stage_next(set), 1);
    }
}

static void pull_it_before_the_start(struct sensor_set *set)
{
    const struct iso_frame *frame = NULL;
    set->stage->plug(&set->scene, false);
    const int64_t end_ns = stage_real_ns() + 10000 * MS;
    int error = iso_sensor_start(set->sensor, NULL);
    while (error == -EIO && stage_real_ns() < end_ns) { /* a library may notice it a little later */
        error = iso_sensor_start(set->sensor, NULL);
    }
    if (!error) {
        error = stage_fetch(set, &frame, NULL); /* as soon as it is noticed */
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
        cmocka_unit_test_teardown(delivers_every_frame_bit_by_bit_and_in_order, stage_clear_away),
        cmocka_unit_test_teardown(frames_carry_the_camera, stage_clear_away),
        cmocka_unit_test_teardown(uses_its_buffer_again, stage_clear_away),
        cmocka_unit_test_teardown(keeps_deadlines, stage_clear_away),
        cmocka_unit_test_teardown(describes_what_it_delivers, stage_clear_away),
        cmocka_unit_test_teardown(starts_and_stops_again_and_again, stage_clear_away),
        cmocka_unit_test_teardown(may_be_closed_at_any_time, stage_clear_away),
        cmocka_unit_test_teardown(a_lost_frame_is_a_gap, stage_clear_away),
        cmocka_unit_test_teardown(is_lost_and_found, stage_clear_away),
        cmocka_unit_test_teardown(refuses_unknown_options, stage_clear_away),
        cmocka_unit_test_teardown(no_back_end_is_left_out, stage_clear_away),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
