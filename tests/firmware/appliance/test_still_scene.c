/* An object that stands still before the camera, such as furniture, causes no report; and the
 * appliance rests before it. */
#include <errno.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/sensor/rest.h"
#include "tests/firmware/rigs/rig.h"

/* A chair is no face. It gets no hint, because it does not move. */
static void only_a_moving_object_gets_the_hint_not_a_face(void **state)
{
    struct rig *rig = *state;
    rig_start(rig);
    rig_show_unusable(rig, ISO_CAPTURE_NOT_A_FACE, 60);
    rig_run(rig, 2100);
    assert_string_equal(rig_news(rig), "");
    assert_int_equal(iso_appliance_status(rig->appliance).view->capture, ISO_CAPTURE_NOBODY);
    rig->sensor.scene_moves = true;
    rig_show_unusable(rig, ISO_CAPTURE_NOT_A_FACE, 60);
    rig_run(rig, 2100);
    assert_string_equal(rig_news(rig), "hint not-a-face");
    assert_int_equal(iso_appliance_status(rig->appliance).view->capture, ISO_CAPTURE_NOT_A_FACE);
    rig->sensor.scene_moves = false;
    rig_show_unusable(rig, ISO_CAPTURE_NOT_A_FACE, 120);
    rig_run(rig, 4000);
    assert_int_equal(iso_appliance_status(rig->appliance).view->capture, ISO_CAPTURE_NOBODY);
}

/* Shows 120 frames of furniture, for 4 s. Returns how many were examined. */
static int show_furniture(struct rig *rig)
{
    const int before = rig->puppet.extracted;
    rig_show_unusable(rig, ISO_CAPTURE_NOT_A_FACE, 120);
    rig_run(rig, 4000);
    return rig->puppet.extracted - before;
}

/* Starts the appliance and leaves it alone until it rests. */
static void rest(struct rig *rig)
{
    rig->sensor.has_room = true;
    rig_enrol(rig, "Ada", 1);
    rig_start(rig);
    assert_int_equal(show_furniture(rig), 120);
    assert_int_equal(show_furniture(rig), 120);
    assert_int_equal(rig->sensor.interval_ns, 0);
    assert_in_range(show_furniture(rig), 60, 90);
    assert_int_equal(rig->sensor.interval_ns, ISO_REST_INTERVAL_NS);
    assert_in_range(show_furniture(rig), 3, 5);
}

static void at_rest_one_frame_a_second_is_examined(void **state)
{
    struct rig *rig = *state;
    rest(rig);
    rig->config.sensor.rest_s = 0;
    assert_in_range(show_furniture(rig), 90, 120);
    assert_int_equal(rig->sensor.interval_ns, 0);
}

static void a_visitor_is_examined_from_the_first_frame_on(void **state)
{
    struct rig *rig = *state;
    rest(rig);
    (void)rig_news(rig);
    const int before = rig->puppet.extracted;
    rig_show(rig, 1, 10);
    rig_run(rig, 340);
    assert_int_equal(rig->puppet.extracted - before, 10);
    assert_int_equal(rig->sensor.interval_ns, 0);
    assert_true(rig_relay(rig));
}

static void a_client_ends_the_rest(void **state)
{
    struct rig *rig = *state;
    rest(rig);
    iso_appliance_aim(rig->appliance, true);
    rig_run(rig, 200);
    /* Nor does rest begin while the client waits before an empty scene. */
    for (int i = 0; i < 5; i++) {
        assert_int_equal(show_furniture(rig), 120);
        assert_int_equal(rig->sensor.interval_ns, 0);
    }
}

/* A client with a claim may watch, although no frame is examined for it. */
static void a_claim_ends_the_rest(void **state)
{
    struct rig *rig = *state;
    rest(rig);
    assert_int_equal(iso_appliance_claim(rig->appliance), 0);
    (void)show_furniture(rig);
    assert_int_equal(rig->sensor.interval_ns, 0);
}

static void a_sensor_that_was_opened_again_gives_all_frames(void **state)
{
    struct rig *rig = *state;
    rest(rig);
    rig->sensor.wait_error = -ENODEV;
    rig_run(rig, 100);
    rig->sensor.wait_error = 0;
    rig_run(rig, 2000);
    assert_int_equal(show_furniture(rig), 120);
}

/* A pause of 100 ms is a fault of this door, so the sensor must not be asked for fewer frames. */
static void a_short_pause_leaves_no_room_for_rest(void **state)
{
    struct rig *rig = *state;
    rig->sensor.has_room = true;
    rig->config.sensor.pause_ms = 100;
    rig_start(rig);
    for (int i = 0; i < 5; i++) {
        assert_int_equal(show_furniture(rig), 120);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(only_a_moving_object_gets_the_hint_not_a_face, rig_setup,
                                        rig_teardown),
        cmocka_unit_test_setup_teardown(at_rest_one_frame_a_second_is_examined, rig_setup,
                                        rig_teardown),
        cmocka_unit_test_setup_teardown(a_visitor_is_examined_from_the_first_frame_on, rig_setup,
                                        rig_teardown),
        cmocka_unit_test_setup_teardown(a_client_ends_the_rest, rig_setup, rig_teardown),
        cmocka_unit_test_setup_teardown(a_claim_ends_the_rest, rig_setup, rig_teardown),
        cmocka_unit_test_setup_teardown(a_sensor_that_was_opened_again_gives_all_frames, rig_setup,
                                        rig_teardown),
        cmocka_unit_test_setup_teardown(a_short_pause_leaves_no_room_for_rest, rig_setup,
                                        rig_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
