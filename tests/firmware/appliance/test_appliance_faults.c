/* The appliance when the log, a frame or the sensor fails, and how it stops. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/door/door_null.h"
#include "tests/firmware/rigs/rig.h"
#include "tests/support/scratch.h"

/* ---- a full disk ---- */

static void a_grant_that_cannot_be_logged_does_not_open(void **state)
{
    struct rig *rig = *state;
    rig_enrol(rig, "anna", 50);
    rig_start(rig);
    rig_show(rig, 50, 2);
    rig_fill_disk();
    rig_run(rig, 2500);
    rig_free_disk();
    assert_string_equal(rig_news(rig), "visit deny anna unlogged 2");
    assert_false(rig_relay(rig));
    rig_show(rig, 50, 2);
    rig_run(rig, 200);
    assert_string_equal(rig_news(rig), "door unlocked grant; visit allow anna match 2");
}

static void a_person_inside_gets_out_with_a_full_disk(void **state)
{
    struct rig *rig = *state;
    rig_start(rig);
    rig_fill_disk();
    assert_int_equal(iso_door_null_set_input(rig->door_io, ISO_DOOR_EXIT_BUTTON, true), 0);
    rig_run(rig, 100);
    rig_free_disk();
    assert_string_equal(rig_news(rig), "door unlocked exit-button");
    assert_true(rig_relay(rig));
}

/* ---- frames that cannot be processed ---- */

static void goes_on_after_a_frame_that_fails(void **state)
{
    struct rig *rig = *state;
    rig_enrol(rig, "anna", 50);
    rig_start(rig);
    rig_show(rig, 50, 4);
    rig->puppet.extract_error = -EDOM;
    rig_run(rig, 40);
    rig->puppet.extract_error = 0;
    rig->puppet.search_error = -ENOMEM;
    rig_run(rig, 33);
    rig->puppet.search_error = 0;
    rig_run(rig, 100);
    assert_string_equal(rig_news(rig), "door unlocked grant; visit allow anna match 2");
}

static void a_face_with_too_few_points_is_none(void **state)
{
    struct rig *rig = *state;
    rig_enrol(rig, "anna", 50);
    rig_start(rig);
    rig->puppet.search_error = -ENODATA;
    rig_show(rig, 50, 6);
    rig_run(rig, 5000);
    assert_string_equal(rig_news(rig), "hint too-few-points");
}

/* ---- the sensor ---- */

static void a_lost_sensor_is_a_fault_of_the_door(void **state)
{
    struct rig *rig = *state;
    rig_enrol(rig, "anna", 50);
    rig_start(rig);
    rig_show(rig, 50, 1);
    rig_run(rig, 100);
    rig->sensor.wait_error = rig->sensor.open_error = -ENODEV;
    rig_run(rig, 2000);
    assert_string_equal(rig_news(rig), "door fault fault"); /* and the visit is forgotten */
    assert_non_null(strstr(rig_record(rig, "sensor"), "\"reason\":\"lost\""));
    assert_string_equal(iso_appliance_status(rig->appliance).sensor_state, "lost");
    assert_string_equal(iso_appliance_status(rig->appliance).sensor_fault, "puppet: will not open");
    rig->sensor.wait_error = rig->sensor.open_error = 0;
    rig_run(rig, 30000);
    assert_string_equal(rig_news(rig), "door locked recovered");
    rig_show(rig, 50, 2);
    rig_run(rig, 100);
    assert_string_equal(rig_news(rig), "door unlocked grant; visit allow anna match 2");
}

static void starts_without_a_sensor(void **state)
{
    struct rig *rig = *state;
    rig->sensor.open_error = -ENODEV;
    assert_int_equal(iso_appliance_start(rig->appliance, NULL), 0);
    assert_string_equal(rig_news(rig), "door locked start; door fault fault");
    rig->sensor.open_error = 0;
    rig_run(rig, 1000);
    assert_string_equal(rig_news(rig), "door locked recovered");
}

static void does_not_start_with_an_impossible_sensor(void **state)
{
    struct rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    rig->sensor.open_error = -EINVAL;
    assert_int_equal(iso_appliance_start(rig->appliance, &fault), -EINVAL);
    assert_string_equal(fault.text, "puppet: will not open");
}

static void a_damaged_frame_is_no_fault_of_the_door(void **state)
{
    struct rig *rig = *state;
    rig_start(rig);
    rig->sensor.wait_error = -EBADMSG;
    (void)iso_appliance_step(rig->appliance);
    assert_string_equal(rig_news(rig), "");
    rig->sensor.wait_error = 0;
    rig_run(rig, 100);
    assert_string_equal(iso_appliance_status(rig->appliance).sensor_state, "started");
}

/* The camera delivers nothing for little more than a second. Frames from before this pause admit
 * nobody, and the sensor is not opened again. */
static void a_silent_sensor_is_a_fault_of_the_door_within_a_second(void **state)
{
    struct rig *rig = *state;
    rig->sensor.streams = true;
    rig_enrol(rig, "anna", 50);
    rig_start(rig);
    rig_show(rig, 50, 1);
    rig_run(rig, 33 + 890);
    assert_string_equal(rig_news(rig), "");
    rig_run(rig, 100);
    assert_string_equal(rig_news(rig), "door fault fault");
    assert_false(rig_relay(rig));
    assert_string_equal(iso_appliance_status(rig->appliance).sensor_state, "silent");
    assert_non_null(strstr(rig_record(rig, "sensor"), "\"reason\":\"silent\""));
    assert_non_null(strstr(rig_record(rig, "sensor"), "nothing seen for 9"));
    rig_run(rig, 200);
    rig_show(rig, 50, 1); /* the first of two frames that would agree */
    rig_run(rig, 50);
    assert_string_equal(rig_news(rig), "door locked recovered");
    assert_string_equal(iso_appliance_status(rig->appliance).sensor_state, "started");
    assert_int_equal(rig->sensor.opened, 1);
    rig_show(rig, 50, 1);
    rig_run(rig, 50);
    assert_string_equal(rig_news(rig), "door unlocked grant; visit allow anna match 2");
}

/* An enrolment by a client continues while the sensor is silent. */
static void an_action_goes_on_during_a_pause(void **state)
{
    struct rig *rig = *state;
    const struct iso_enroll_request anna = {.person = "anna"};
    rig->sensor.streams = true;
    rig_start(rig);
    assert_int_equal(iso_appliance_claim(rig->appliance), 0);
    assert_int_equal(iso_appliance_enroll(rig->appliance, &anna, NULL), 0);
    rig_run(rig, 1200);
    assert_string_equal(rig_news(rig), "door fault fault");
    assert_int_equal(iso_appliance_status(rig->appliance).mode, ISO_APPLIANCE_ENROLL);
    rig_run(rig, 5000); /* and ends when the sensor is lost */
    assert_string_equal(rig_news(rig), "enroll disconnected 0/3 done");
}

static void a_dead_sensor_makes_no_progress_for_the_watchdog(void **state)
{
    struct rig *rig = *state;
    rig->sensor.streams = true;
    rig->config.sensor.silence_ms = 600000;
    rig_start(rig);
    const uint64_t dead = iso_appliance_progress(rig->appliance);
    rig_run(rig, 60000);
    assert_int_equal(iso_appliance_progress(rig->appliance), dead);
    rig_show(rig, 50, 1);
    rig_run(rig, 100);
    assert_int_equal(iso_appliance_progress(rig->appliance), dead + 1);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, rig_setup, rig_teardown)
    const struct CMUnitTest tests[] = {
        TEST(a_grant_that_cannot_be_logged_does_not_open),
        TEST(a_person_inside_gets_out_with_a_full_disk),
        TEST(goes_on_after_a_frame_that_fails),
        TEST(a_face_with_too_few_points_is_none),
        TEST(a_lost_sensor_is_a_fault_of_the_door),
        TEST(starts_without_a_sensor),
        TEST(does_not_start_with_an_impossible_sensor),
        TEST(a_damaged_frame_is_no_fault_of_the_door),
        TEST(a_silent_sensor_is_a_fault_of_the_door_within_a_second),
        TEST(an_action_goes_on_during_a_pause),
        TEST(a_dead_sensor_makes_no_progress_for_the_watchdog),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
