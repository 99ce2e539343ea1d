/* The actions of a client: claim, enrol, verify, identify, delete. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/firmware/rigs/rig.h"

/* ---- claim ---- */

static void a_claim_keeps_the_door_shut(void **state)
{
    struct rig *rig = *state;
    rig_enrol(rig, "anna", 50);
    rig_start_claimed(rig);
    assert_int_equal(iso_appliance_claim(rig->appliance), -EBUSY);
    rig_show(rig, 50, 4);
    rig_run(rig, 1000);
    assert_string_equal(rig_news(rig), "");
    iso_appliance_release(rig->appliance);
    iso_appliance_release(rig->appliance); /* a second release does no harm */
    rig_show(rig, 50, 2);
    rig_run(rig, 1000);
    assert_string_equal(rig_news(rig), "door unlocked grant; visit allow anna match 2");
}

static void a_claim_ends_a_visit_without_a_verdict(void **state)
{
    struct rig *rig = *state;
    rig_enrol(rig, "anna", 50);
    rig_start(rig);
    rig_show(rig, 50, 1);
    rig_run(rig, 100);
    assert_int_equal(iso_appliance_claim(rig->appliance), 0);
    iso_appliance_release(rig->appliance);
    rig_show(rig, 50, 1);
    rig_run(rig, 100);
    assert_string_equal(rig_news(rig), "");
}

static void an_idle_claim_runs_out(void **state)
{
    struct rig *rig = *state;
    rig_start_claimed(rig);
    rig_run(rig, 59000);
    assert_string_equal(rig_news(rig), "");
    rig_run(rig, 2000);
    assert_string_equal(rig_news(rig), "claim lost");
    assert_int_equal(iso_appliance_claim(rig->appliance), 0);
}

static void nothing_goes_without_a_claim(void **state)
{
    struct rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    const struct iso_enroll_request request = {.person = "anna"};
    rig_enrol(rig, "anna", 50);
    rig_start(rig);
    assert_int_equal(iso_appliance_enroll(rig->appliance, &request, &fault), -EACCES);
    assert_string_equal(fault.text, "claim the camera first");
    assert_int_equal(iso_appliance_verify(rig->appliance, "anna", NULL), -EACCES);
    assert_int_equal(iso_appliance_identify(rig->appliance, NULL), -EACCES);
    assert_int_equal(iso_appliance_stop_action(rig->appliance, ISO_APPLIANCE_ENROLL), -ENODATA);
}

/* ---- verifying and identifying ---- */

static void verifies(void **state)
{
    struct rig *rig = *state;
    rig_enrol(rig, "anna", 50);
    rig_enrol(rig, "bob", 80);
    rig_start_claimed(rig);
    assert_int_equal(iso_appliance_verify(rig->appliance, "anna", NULL), 0);
    rig_show(rig, 52, 2);
    rig_run(rig, 100);
    assert_string_equal(rig_news(rig), "verify match anna done");
    assert_false(rig_relay(rig)); /* no action of a client opens the door */
    assert_non_null(strstr(rig_record(rig, "verify"), "\"person\":\"anna\",\"reason\":\"match\","));
    assert_int_equal(iso_appliance_verify(rig->appliance, "anna", NULL), 0);
    rig_show(rig, 80, 6);
    rig_run(rig, 300);
    assert_string_equal(rig_news(rig), "verify no-match anna done");
    struct iso_fault fault = {.text = ""};
    assert_int_equal(iso_appliance_verify(rig->appliance, "zac", &fault), -ENOENT);
    assert_string_equal(fault.text, "zac: no such person");
}

/* An empty scene gives no hint to a waiting client, and does not count as a failure. */
static void an_empty_scene_gives_no_hint(void **state)
{
    struct rig *rig = *state;
    rig_start(rig);
    rig_show_unusable(rig, ISO_CAPTURE_NOBODY, 40);
    rig_run(rig, 2000);
    assert_string_equal(rig_news(rig), "");
    assert_int_equal(iso_appliance_claim(rig->appliance), 0);
    assert_int_equal(iso_appliance_identify(rig->appliance, NULL), 0);
    rig_show_unusable(rig, ISO_CAPTURE_NOBODY, 40);
    rig_run(rig, 2000);
    assert_string_equal(rig_news(rig), "");
    assert_int_equal(iso_appliance_status(rig->appliance).view->capture, ISO_CAPTURE_NOBODY);
    assert_int_equal(iso_appliance_status(rig->appliance).counts.denied, 0);
}

static void identifies(void **state)
{
    struct rig *rig = *state;
    rig_enrol(rig, "anna", 50);
    rig_enrol(rig, "bob", 80);
    rig_start_claimed(rig);
    assert_int_equal(iso_appliance_identify(rig->appliance, NULL), 0);
    rig_show_unusable(rig, ISO_CAPTURE_NO_FACE, 3);
    rig_run(rig, 110);
    rig_show(rig, 81, 2);
    rig_run(rig, 100);
    assert_string_equal(rig_news(rig), "identify retry-no-face; identify match bob done");
    assert_int_equal(iso_appliance_identify(rig->appliance, NULL), 0);
    rig_show(rig, 65, 1); /* and the person leaves again */
    rig_run(rig, 2000);
    assert_string_equal(rig_news(rig), "identify no-match done");
    assert_false(rig_relay(rig));
}

static void a_picture_is_not_recognised(void **state)
{
    struct rig *rig = *state;
    rig_enrol(rig, "anna", 50);
    rig_start_claimed(rig);
    assert_int_equal(iso_appliance_verify(rig->appliance, "anna", NULL), 0);
    rig_show(rig, 50, 1);
    rig_run(rig, 50);
    rig_show_unusable(rig, ISO_CAPTURE_EYES_CUT, 2);
    rig_run(rig, 100);
    assert_string_equal(rig_news(rig), "verify attack anna done");
    assert_non_null(strstr(rig_record(rig, "verify"),
                           "\"person\":\"anna\",\"reason\":\"attack\",\"score\":10,\"threshold\":6,"
                           "\"frames\":1,\"attack_frames\":2,\"note\":\"eyes-cut\"}"));
    assert_int_equal(iso_appliance_status(rig->appliance).counts.denied, 0); /* it was no visit */
}

/* Another face before the camera does not end the action of a client: the appliance compares that
 * face instead. */
static void an_identification_goes_on_with_another_face(void **state)
{
    struct rig *rig = *state;
    rig_enrol(rig, "anna", 50);
    rig_start_claimed(rig);
    assert_int_equal(iso_appliance_identify(rig->appliance, NULL), 0);
    rig_show_at(rig, 50, -200, 33);
    rig_show_at(rig, 50, 200, 66);
    rig_run(rig, 80);
    assert_string_equal(rig_news(rig), "");
    rig_show_at(rig, 50, 200, 20);
    rig_run(rig, 80);
    assert_string_equal(rig_news(rig), "identify match anna done");
}

static void a_person_outside_the_dates_is_still_recognised(void **state)
{
    struct rig *rig = *state;
    const struct iso_person anna = {.name = "anna", .valid_until_s = 1795240000};
    const struct iso_template tmpl = puppet_template(50, PUPPET_ALGORITHM);
    assert_int_equal(iso_gallery_add(rig->gallery, &anna, &tmpl, NULL), 0);
    rig_start_claimed(rig);
    assert_int_equal(iso_appliance_identify(rig->appliance, NULL), 0);
    rig_show(rig, 50, 2);
    rig_run(rig, 100);
    assert_string_equal(rig_news(rig), "identify match anna done");
}

static void gives_up_after_a_time(void **state)
{
    struct rig *rig = *state;
    rig_enrol(rig, "anna", 50);
    rig_start_claimed(rig);
    assert_int_equal(iso_appliance_verify(rig->appliance, "anna", NULL), 0);
    rig_run(rig, 29900);
    assert_string_equal(rig_news(rig), "");
    rig_run(rig, 200);
    assert_string_equal(rig_news(rig), "verify timed-out done");
}

/* ---- deleting ---- */

static void deletes_on_record(void **state)
{
    struct rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    rig_enrol(rig, "anna", 50);
    rig_start(rig);
    assert_int_equal(iso_appliance_remove(rig->appliance, "zac", &fault), -ENOENT);
    assert_string_equal(fault.text, "zac: no such person");
    rig_fill_disk();
    assert_int_equal(iso_appliance_remove(rig->appliance, "anna", &fault), -ENOSPC);
    rig_free_disk();
    assert_non_null(iso_gallery_find(rig->gallery, "anna"));
    assert_int_equal(iso_appliance_remove(rig->appliance, "anna", NULL), 0);
    assert_null(iso_gallery_find(rig->gallery, "anna"));
    assert_non_null(strstr(rig_record(rig, "delete"), "\"person\":\"anna\"}"));
    rig_show(rig, 50, 6);
    rig_run(rig, 300);
    assert_string_equal(rig_news(rig), "visit deny unknown 6");
}

static void a_person_deleted_during_a_verification_does_not_match(void **state)
{
    struct rig *rig = *state;
    rig_enrol(rig, "anna", 50);
    rig_start_claimed(rig);
    assert_int_equal(iso_appliance_verify(rig->appliance, "anna", NULL), 0);
    assert_int_equal(iso_appliance_remove(rig->appliance, "anna", NULL), 0);
    rig_show(rig, 50, 6);
    rig_run(rig, 300);
    assert_string_equal(rig_news(rig), "verify no-match anna done");
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, rig_setup, rig_teardown)
    const struct CMUnitTest tests[] = {
        TEST(a_claim_keeps_the_door_shut),
        TEST(a_claim_ends_a_visit_without_a_verdict),
        TEST(an_idle_claim_runs_out),
        TEST(nothing_goes_without_a_claim),
        TEST(verifies),
        TEST(identifies),
        TEST(an_empty_scene_gives_no_hint),
        TEST(a_picture_is_not_recognised),
        TEST(an_identification_goes_on_with_another_face),
        TEST(a_person_outside_the_dates_is_still_recognised),
        TEST(gives_up_after_a_time),
        TEST(deletes_on_record),
        TEST(a_person_deleted_during_a_verification_does_not_match),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
