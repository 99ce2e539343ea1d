/* The back end v4l2 when the caller wants few pictures (set_interval), with a simulated camera. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/drivers/sensor/v4l2_rig.h"

/* Pictures that are not wanted are passed over and leave no gap; a lost one still does. */
static void pictures_that_are_not_wanted_are_passed_over(void **state)
{
    struct iso_sensor *sensor = v4l2_started(false);
    const struct iso_frame *frame = NULL;
    uint64_t last = 0;
    (void)state;
    for (int i = 0; i < 10; i++) {
        v4l2_at(33 * i);
        v4l2_shoot_depth(i, 33 * i, i == 4 ? FAKE_LOST : FAKE_GOOD);
        const int error = v4l2_look(sensor, &frame, NULL);
        assert_int_equal(error, i == 0 || i == 3 || i == 6 || i == 9 ? 0 : -ETIMEDOUT);
        last = error ? last : frame->sequence;
        if (i == 0) {
            iso_sensor_set_interval(sensor, 80000000);
        }
    }
    assert_int_equal(last, 4);
    assert_int_equal(iso_sensor_health(sensor).lost, 1);
    iso_sensor_close(sensor);
}

/* The caller comes every 90 ms, and the camera takes a picture every 10 ms: the kernel has buffers
 * for four, and the others are lost. Nobody wanted them, so they are no gaps. A picture that is
 * lost while the caller comes in time is one. */
static void pictures_that_the_caller_let_go_by_are_no_gaps(void **state)
{
    struct iso_sensor *sensor = v4l2_started(false);
    const struct iso_frame *frame = NULL;
    uint64_t last = 0;
    int shot = 0;
    (void)state;
    v4l2_at(0);
    v4l2_shoot_depth(shot++, 0, FAKE_GOOD);
    assert_int_equal(v4l2_look(sensor, &frame, NULL), 0);
    iso_sensor_set_interval(sensor, 80000000);
    for (int round = 0; round < 5; round++) {
        for (int i = 1; i <= 9; i++) {
            v4l2_shoot_depth(shot++, 100 * round + 10 * i, i <= 4 ? FAKE_GOOD : FAKE_LOST);
        }
        v4l2_at(100 * round + 90);
        (void)v4l2_look(sensor, &frame, NULL);
        v4l2_at(100 * round + 100);
        v4l2_shoot_depth(shot++, 100 * round + 100, FAKE_GOOD);
        assert_int_equal(v4l2_look(sensor, &frame, NULL), 0);
        assert_int_equal(frame->sequence, last + 1);
        last = frame->sequence;
    }
    assert_int_equal(iso_sensor_health(sensor).lost, 0);
    assert_int_equal(iso_sensor_health(sensor).device.dropped, 0);
    v4l2_at(510);
    v4l2_shoot_depth(shot++, 510, FAKE_LOST);
    assert_int_equal(v4l2_look(sensor, &frame, NULL), -ETIMEDOUT);
    iso_sensor_set_interval(sensor, 0);
    v4l2_at(520);
    v4l2_shoot_depth(shot++, 520, FAKE_GOOD);
    assert_int_equal(v4l2_look(sensor, &frame, NULL), 0);
    assert_int_equal(iso_sensor_health(sensor).lost, 1);
    iso_sensor_close(sensor);
}

#define ON_FAKE(test) cmocka_unit_test_setup_teardown(test, v4l2_set_up, v4l2_tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        ON_FAKE(pictures_that_are_not_wanted_are_passed_over),
        ON_FAKE(pictures_that_the_caller_let_go_by_are_no_gaps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
