/* A client enrols a person: stages, hints, limits, and failures of an enrolment. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/firmware/rigs/rig.h"

static void enroll(struct rig *rig, const char *person)
{
    const struct iso_enroll_request request = {.person = person};
    rig_start_enrolling(rig, &request);
}

/* ---- claim ---- */

static void one_action_at_a_time(void **state)
{
    struct rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    rig_start_claimed(rig);
    assert_int_equal(iso_appliance_identify(rig->appliance, NULL), 0);
    assert_int_equal(iso_appliance_identify(rig->appliance, &fault), -EBUSY);
    assert_string_equal(fault.text, "identify goes on, stop it first");
    assert_int_equal(iso_appliance_stop_action(rig->appliance, ISO_APPLIANCE_VERIFY), -ENODATA);
    assert_int_equal(iso_appliance_stop_action(rig->appliance, ISO_APPLIANCE_IDENTIFY), 0);
    assert_int_equal(iso_appliance_stop_action(rig->appliance, ISO_APPLIANCE_IDENTIFY), -ENODATA);
    enroll(rig, "anna");
}

/* ---- enrolling ---- */

static void enrols_with_hints(void **state)
{
    struct rig *rig = *state;
    rig_start_claimed(rig);
    enroll(rig, "anna");
    rig_show_unusable(rig, ISO_CAPTURE_TOO_FAR, 5);
    rig_run(rig, 200);
    rig_show(rig, 50, 1);
    rig_run(rig, 50);
    rig_run(rig, 1000);
    rig_show_unusable(rig, ISO_CAPTURE_TURN_LEFT, 3);
    rig_run(rig, 100);
    rig_show(rig, 90, 1); /* another person looks in */
    rig_run(rig, 50);
    rig_show(rig, 51, 4);
    rig_run(rig, 200);
    assert_string_equal(rig_news(rig), "enroll retry-too-far 0/3; enroll stage-passed 1/3; "
                                       "enroll retry-turn-left 1/3; enroll stage-misfit 1/3; "
                                       "enroll stage-passed 2/3; enroll stage-passed 3/3; "
                                       "enroll completed 3/3 done");
    const struct iso_person *anna = iso_gallery_find(rig->gallery, "anna");
    assert_int_equal(anna->usable, 1);
    assert_in_range(anna->enrolled_s, 1795250000, 1795250001);
    assert_non_null(strstr(rig_record(rig, "enroll"),
                           "\"person\":\"anna\",\"reason\":\"completed\",\"frames\":3}"));
    /* The enrolment has ended by itself. A client may stop it once. */
    assert_int_equal(iso_appliance_stop_action(rig->appliance, ISO_APPLIANCE_ENROLL), 0);
    assert_int_equal(iso_appliance_stop_action(rig->appliance, ISO_APPLIANCE_ENROLL), -ENODATA);
    iso_appliance_release(rig->appliance);
    rig_show(rig, 50, 2);
    rig_run(rig, 100);
    assert_string_equal(rig_news(rig), "door unlocked grant; visit allow anna match 2");
}

static void repeats_a_hint_once_a_second(void **state)
{
    struct rig *rig = *state;
    rig_start_claimed(rig);
    enroll(rig, "anna");
    rig_show_unusable(rig, ISO_CAPTURE_LOOK_UP, 40);
    rig_run(rig, 1400);
    assert_string_equal(rig_news(rig), "enroll retry-look-up 0/3; enroll retry-look-up 0/3");
}

/* Enrolment checks more than recognition: the pose, the covered regions, and the expression. */
static void enrols_good_frames_only(void **state)
{
    struct rig *rig = *state;
    rig_start_claimed(rig);
    rig->config.hint.interval_ms = 0;
    enroll(rig, "anna");
    rig->puppet.yaw_rad = 0.3;
    rig_show(rig, 50, 3);
    rig_run(rig, 110);
    assert_string_equal(rig_news(rig), "enroll retry-turn-right 0/3");
    rig->puppet.yaw_rad = 0;
    rig->puppet.uncovered = 0.2;
    rig_run(rig, 1000);
    rig_show(rig, 50, 6);
    rig_run(rig, 250);
    assert_string_equal(rig_news(rig), "enroll retry-too-few-points 0/3");
    rig->puppet.uncovered = 0;
    rig->puppet.expression = 2;
    rig_run(rig, 2000);
    rig_show(rig, 50, 4);
    rig_run(rig, 200);
    assert_string_equal(rig_news(rig), "enroll retry-expression 0/3");
    rig->puppet.expression = 0.5;
    rig_show(rig, 50, 3);
    rig_run(rig, 200);
    assert_string_equal(rig_news(rig), "enroll stage-passed 1/3; enroll stage-passed 2/3; "
                                       "enroll stage-passed 3/3; enroll completed 3/3 done");
}

static void does_not_enrol_a_face_that_moves(void **state)
{
    struct rig *rig = *state;
    rig_start_claimed(rig);
    enroll(rig, "anna");
    for (int i = 0; i < 5; i++) {
        rig_show_at(rig, 50, 15 * i, 33 * (i + 1)); /* 455 mm/s, except for the first frame */
    }
    rig_run(rig, 200);
    assert_string_equal(rig_news(rig), "enroll stage-passed 1/3; enroll retry-moving 1/3");
}

/* Two attack frames in one stage end the enrolment. One false alarm in each of two stages does not.
 */
static void does_not_enrol_a_picture(void **state)
{
    struct rig *rig = *state;
    rig_start_claimed(rig);
    enroll(rig, "anna");
    for (int i = 0; i < 2; i++) {
        rig_show_unusable(rig, ISO_CAPTURE_BENT, 1);
        rig_run(rig, 50);
        rig_show(rig, 50, 1);
        rig_run(rig, 50);
    }
    assert_string_equal(rig_news(rig), "enroll stage-passed 1/3; enroll stage-passed 2/3");
    rig_show_unusable(rig, ISO_CAPTURE_FLAT, 3);
    rig_run(rig, 200);
    assert_string_equal(rig_news(rig), "enroll attack 2/3 done");
    assert_non_null(strstr(rig_record(rig, "enroll"),
                           "\"reason\":\"attack\",\"frames\":2,\"attack_frames\":2,"
                           "\"note\":\"flat\"}"));
    assert_null(iso_gallery_find(rig->gallery, "anna"));
}

static void enrols_within_limits(void **state)
{
    struct rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    struct iso_enroll_request request = {.person = "anna",
                                         .validity = {true, true, {1795250000, 1795250000}, false}};
    rig_start_claimed(rig);
    assert_int_equal(iso_appliance_enroll(rig->appliance, &request, &fault), -EINVAL);
    assert_string_equal(fault.text, "the time of validity is empty");
    request.validity.limits.until_s++;
    assert_int_equal(iso_appliance_enroll(rig->appliance, &request, NULL), 0);
    rig_show(rig, 50, 3);
    rig_run(rig, 200);
    assert_int_equal(iso_gallery_find(rig->gallery, "anna")->valid_from_s, 1795250000);
    assert_int_equal(iso_gallery_find(rig->gallery, "anna")->valid_until_s, 1795250001);
}

/* Enrols face 50 under this name with these limits. A limit that is not named stays as it is. */
static void enroll_within(struct rig *rig, const char *name,
                          const struct iso_validity_change *validity)
{
    const struct iso_enroll_request request = {.person = name, .validity = *validity};
    rig_start_enrolling(rig, &request);
    rig_show(rig, 50, 3);
    rig_run(rig, 200);
    assert_non_null(strstr(rig_news(rig), "enroll completed"));
}

static void enrolling_again_keeps_the_limits(void **state)
{
    struct rig *rig = *state;
    const struct iso_validity_change nothing = {0};
    const struct iso_validity_change year = {true, true, {1795000000, 1798675199}, false};
    const struct iso_validity_change longer = {false, true, {0, 1800000000}, false};
    rig_start_claimed(rig);
    enroll_within(rig, "anna", &year);
    assert_non_null(strstr(rig_record(rig, "enroll"),
                           "\"frames\":3,\"after\":\"from 2026-11-18T11:06:40Z until "
                           "2026-12-30T23:59:59Z\"}"));
    enroll_within(rig, "ANNA", &nothing);
    const struct iso_person *anna = iso_gallery_find(rig->gallery, "anna");
    assert_string_equal(anna->name, "anna");
    assert_int_equal(anna->templates, 2);
    assert_int_equal(anna->valid_from_s, 1795000000);
    assert_int_equal(anna->valid_until_s, 1798675199);
    assert_null(strstr(rig_record(rig, "enroll"), "\"after\""));
    enroll_within(rig, "anna", &longer);
    assert_int_equal(anna->valid_from_s, 1795000000);
    assert_int_equal(anna->valid_until_s, 1800000000);
    assert_non_null(strstr(rig_record(rig, "enroll"),
                           "\"before\":\"from 2026-11-18T11:06:40Z until 2026-12-30T23:59:59Z\","
                           "\"after\":\"from 2026-11-18T11:06:40Z until 2027-01-15T08:00:00Z\"}"));
}

static void an_end_in_the_past_must_be_confirmed(void **state)
{
    struct rig *rig = *state;
    struct iso_enroll_request request = {.person = "anna",
                                         .validity = {false, true, {0, 1795249999}, false}};
    struct iso_fault fault = {.text = ""};
    rig_start_claimed(rig);
    assert_int_equal(iso_appliance_enroll(rig->appliance, &request, &fault), -EINVAL);
    assert_non_null(strstr(fault.text, "ended in the past, 2026-11-21T08:33:19Z"));
    request.validity.expired = true;
    assert_int_equal(iso_appliance_enroll(rig->appliance, &request, NULL), 0);
}

static void a_second_person_under_a_name_is_refused(void **state)
{
    struct rig *rig = *state;
    rig_enrol(rig, "anna", 90);
    rig_start_claimed(rig);
    enroll(rig, "Anna");
    rig_show(rig, 50, 3);
    rig_run(rig, 200);
    assert_non_null(strstr(rig_news(rig), "enroll other-face 3/3 done"));
    assert_non_null(strstr(rig_record(rig, "enroll"),
                           "\"person\":\"anna\",\"reason\":\"other-face\",\"frames\":3}"));
    assert_int_equal(iso_gallery_find(rig->gallery, "anna")->templates, 1);
}

static void refuses_a_duplicate(void **state)
{
    struct rig *rig = *state;
    struct iso_enroll_request request = {.person = "bob"};
    rig_enrol(rig, "anna", 50);
    rig_start_claimed(rig);
    assert_int_equal(iso_appliance_enroll(rig->appliance, &request, NULL), 0);
    rig_show(rig, 51, 3);
    rig_run(rig, 200);
    assert_string_equal(rig_news(rig), "enroll stage-passed 1/3; enroll stage-passed 2/3; "
                                       "enroll stage-passed 3/3; enroll duplicate 3/3 done anna");
    assert_null(iso_gallery_find(rig->gallery, "bob"));
    assert_non_null(strstr(rig_record(rig, "enroll"), "\"person\":\"bob\",\"reason\":\"duplicate\","
                                                      "\"frames\":3,\"note\":\"anna\"}"));
    request.allow_duplicate = true;
    assert_int_equal(iso_appliance_enroll(rig->appliance, &request, NULL), 0);
    rig_show(rig, 51, 3);
    rig_run(rig, 200);
    assert_non_null(iso_gallery_find(rig->gallery, "bob"));
}

static void an_enrolment_can_fail(void **state)
{
    struct rig *rig = *state;
    rig_start_claimed(rig);
    enroll(rig, "anna");
    rig_show(rig, 50, 1);
    rig_run(rig, 50);
    rig_show(rig, 90, 3);
    rig_run(rig, 150);
    assert_non_null(strstr(rig_news(rig), "enroll failed 1/3 done"));
    assert_null(iso_gallery_find(rig->gallery, "anna"));
}

static void an_enrolment_takes_its_time(void **state)
{
    struct rig *rig = *state;
    rig_start_claimed(rig);
    enroll(rig, "anna");
    rig_run(rig, 59990);
    assert_string_equal(rig_news(rig), "");
    rig_run(rig, 100);
    assert_string_equal(rig_news(rig), "enroll timed-out 0/3 done");
}

static void an_enrolment_that_cannot_be_kept_fails(void **state)
{
    struct rig *rig = *state;
    rig_start_claimed(rig);
    enroll(rig, "anna");
    rig_show(rig, 50, 3);
    rig_fill_disk();
    rig_run(rig, 200);
    rig_free_disk();
    assert_non_null(strstr(rig_news(rig), "enroll not-stored 3/3 done"));
    assert_null(iso_gallery_find(rig->gallery, "anna"));
}

static void refuses_names_and_numbers(void **state)
{
    struct rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    struct iso_enroll_request request = {.person = "an\tna"};
    rig_enrol(rig, "anna", 50);
    rig_enrol(rig, "bob", 70);
    rig_enrol(rig, "eve", 90);
    rig_start_claimed(rig);
    assert_int_equal(iso_appliance_enroll(rig->appliance, &request, &fault), -EINVAL);
    assert_string_equal(fault.text, "the name holds a control character");
    request.person = "zac";
    assert_int_equal(iso_appliance_enroll(rig->appliance, &request, &fault), -EDQUOT);
    assert_string_equal(fault.text, "the gallery is full: 3 people");
    enroll(rig, "anna");
}

static void a_lost_sensor_ends_every_action(void **state)
{
    struct rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    rig_enrol(rig, "anna", 50);
    rig_start_claimed(rig);
    for (int action = 0; action < 3; action++) {
        if (action == 0) {
            enroll(rig, "bob");
        } else if (action == 1) {
            assert_int_equal(iso_appliance_verify(rig->appliance, "anna", NULL), 0);
        } else {
            assert_int_equal(iso_appliance_identify(rig->appliance, NULL), 0);
        }
        rig->sensor.wait_error = rig->sensor.open_error = -ENODEV;
        rig_run(rig, 100);
        rig->sensor.wait_error = rig->sensor.open_error = 0;
        assert_int_equal(iso_appliance_identify(rig->appliance, &fault), -ENODEV);
        rig_run(rig, 35000);
        if (action == 0) {
            assert_string_equal(fault.text, "puppet: will not wait");
            assert_string_equal(rig_news(rig), "door fault fault; enroll disconnected 0/3 done; "
                                               "door locked recovered");
        } else {
            char wanted[128];
            (void)snprintf(wanted, sizeof wanted,
                           "door fault fault; %s disconnected done; door locked recovered",
                           action == 1 ? "verify" : "identify");
            assert_string_equal(rig_news(rig), wanted);
        }
        iso_appliance_release(rig->appliance);
        assert_int_equal(iso_appliance_claim(rig->appliance), 0);
    }
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, rig_setup, rig_teardown)
    const struct CMUnitTest tests[] = {
        TEST(one_action_at_a_time),
        TEST(enrols_with_hints),
        TEST(repeats_a_hint_once_a_second),
        TEST(enrols_good_frames_only),
        TEST(does_not_enrol_a_face_that_moves),
        TEST(does_not_enrol_a_picture),
        TEST(enrols_within_limits),
        TEST(enrolling_again_keeps_the_limits),
        TEST(an_end_in_the_past_must_be_confirmed),
        TEST(a_second_person_under_a_name_is_refused),
        TEST(refuses_a_duplicate),
        TEST(an_enrolment_can_fail),
        TEST(an_enrolment_takes_its_time),
        TEST(an_enrolment_that_cannot_be_kept_fails),
        TEST(refuses_names_and_numbers),
        TEST(a_lost_sensor_ends_every_action),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
