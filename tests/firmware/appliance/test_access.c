/* The policy of a site at the door: who is let in, and what is on record. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/firmware/appliance/access_rig.h"

/* Saturday morning for staff, Sunday for guests; a face is enough at the door "front". */
static const char weekend[] =
    "{\"schedules\": ["
    "  {\"token\": \"saturday\", \"zone\": \"Etc/UTC\", \"weekly\": {\"saturday\": "
    "[\"08:00-12:00\"]}},"
    "  {\"token\": \"sunday\", \"zone\": \"Etc/UTC\", \"weekly\": {\"sunday\": "
    "[\"00:00-24:00\"]}}],"
    " \"access_points\": [{\"token\": \"front\"}],"
    " \"access_profiles\": ["
    "  {\"token\": \"staff\", \"policies\": [{\"access_point\": \"front\", \"schedule\": "
    "\"saturday\"}]},"
    "  {\"token\": \"guests\", \"policies\": [{\"access_point\": \"front\", \"schedule\": "
    "\"sunday\"}]},"
    "  {\"token\": \"nobody\", \"policies\": []}],"
    " \"default_profile\": \"staff\"}";

/* ---- a schedule ---- */

static void without_a_policy_whoever_is_known_may_enter(void **state)
{
    struct rig *rig = *state;
    access_rig_start(rig, "");
    access_rig_expect_visit(rig, ACCESS_ANNA, "visit allow anna match");
    access_rig_expect_visit(rig, ACCESS_STRANGER, "visit deny");
    access_rig_set_credential(rig, "anna", "{\"enabled\": false}");
    access_rig_expect_visit(rig, ACCESS_ANNA, "visit deny anna disabled");
    access_rig_set_credential(rig, "anna", "{\"enabled\": null}");
    access_rig_expect_visit(rig, ACCESS_ANNA, "visit allow anna match");
}

static void a_schedule_decides(void **state)
{
    struct rig *rig = *state;
    access_rig_start(rig, weekend);
    access_rig_set_credential(rig, "ben", "{\"profiles\": [\"guests\"]}");
    access_rig_expect_visit(rig, ACCESS_ANNA, "visit allow anna match");
    access_rig_expect_visit(rig, ACCESS_BEN, "visit deny ben not-now");
    access_rig_expect(rig_record(rig, "visit"), "\"reason\":\"not-now\"");
    assert_false(rig_relay(rig));
    access_rig_set_credential(rig, "ben", "{\"profiles\": [\"nobody\"]}");
    access_rig_expect_visit(rig, ACCESS_BEN, "visit deny ben not-here");
    access_rig_set_credential(rig, "ben", "{\"profiles\": [\"gone\"]}");
    access_rig_expect_visit(rig, ACCESS_BEN, "visit deny ben not-here");
    rig->wall_ns += 4 * 3600 * ISO_NS_PER_S; /* half past twelve */
    access_rig_expect_visit(rig, ACCESS_ANNA, "visit deny anna not-now");
    (void)access_rig_set_policy(rig, "");
    access_rig_expect_visit(rig, ACCESS_BEN, "visit allow ben match");
}

static void a_policy_needs_a_clock(void **state)
{
    struct rig *rig = *state;
    access_rig_start(rig, weekend);
    rig->wall_ns = 1000 * ISO_NS_PER_S; /* 1970 */
    access_rig_expect_visit(rig, ACCESS_ANNA, "visit deny anna no-policy");
}

static void a_policy_outlasts_a_restart(void **state)
{
    struct rig *rig = *state;
    access_rig_start(rig, weekend);
    access_rig_set_credential(rig, "ben", "{\"profiles\": [\"guests\"]}");
    access_rig_restart(rig);
    assert_int_equal(iso_site_access_revision(iso_appliance_access(rig->appliance)), 1);
    access_rig_expect_visit(rig, ACCESS_BEN, "visit deny ben not-now");
    access_rig_expect_visit(rig, ACCESS_ANNA, "visit allow anna match");
}

static void a_policy_without_this_door_lets_nobody_in(void **state)
{
    struct rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    uint64_t revision = 0;
    access_rig_start(rig, weekend);
    assert_int_equal(iso_appliance_set_policy(rig->appliance,
                                              "{\"access_points\": [{\"token\": \"a\"}, "
                                              "{\"token\": \"b\"}]}",
                                              1, "me", &revision, &fault),
                     -EINVAL);
    access_rig_expect(fault.text, "2 access points");
    access_rig_expect_visit(rig, ACCESS_ANNA,
                            "visit allow anna match"); /* the earlier one is still used */
    (void)snprintf(rig->config.policy.access_point, sizeof rig->config.policy.access_point, "back");
    access_rig_restart(rig);
    access_rig_expect(iso_site_access_fault(iso_appliance_access(rig->appliance))->text,
                      "\"back\"");
    access_rig_expect_visit(rig, ACCESS_ANNA, "visit deny anna no-policy");
}

/* ---- records ---- */

static void each_change_is_on_record(void **state)
{
    struct rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    uint64_t revision = 0;
    access_rig_start(rig, weekend);
    access_rig_expect(rig_record(rig, "policy"),
                      "\"before\":\"revision 0\",\"after\":\"revision 1\"");
    access_rig_expect(rig_record(rig, "policy"), "asked by user 7");
    assert_int_equal(iso_appliance_set_policy(rig->appliance, weekend, 0, "me", &revision, &fault),
                     -ECANCELED);
    access_rig_expect(fault.text, "changed meanwhile: revision 1");
    access_rig_set_credential(rig, "anna", "{\"cards\": [\"17/4711\"], \"pin\": \"1234\"}");
    const char *record = rig_record(rig, "credential");
    access_rig_expect(record, "\"person\":\"anna\"");
    access_rig_expect(record, "17/4711");
    access_rig_expect(record, "\\\"pin\\\":true");
    assert_null(strstr(record, "1234"));
    assert_int_equal(iso_appliance_set_credential(rig->appliance, "ben",
                                                  "{\"cards\": [\"17/4711\"]}", "me", &fault),
                     -EEXIST);
    access_rig_expect(fault.text, "belongs to anna");
    assert_int_equal(iso_appliance_set_credential(rig->appliance, "carl", "{}", "me", &fault),
                     -ENOENT);
    assert_int_equal(
        iso_appliance_set_credential(rig->appliance, "ben", "{\"colour\": 1}", "me", &fault),
        -EINVAL);
    access_rig_expect(fault.text, "colour");
}

/* ---- areas, and open doors ---- */

static void nobody_enters_twice_with_hard_antipassback(void **state)
{
    struct rig *rig = *state;
    access_rig_start(
        rig, access_rig_always("\"recognition_groups\": [[\"face\"]]", false,
                               ", \"from\": \"out\", \"to\": \"in\", \"antipassback\": \"hard\""));
    access_rig_expect_visit(rig, ACCESS_ANNA, "visit allow anna match");
    access_rig_expect_visit(rig, ACCESS_ANNA, "visit deny anna antipassback");
    access_rig_expect_visit(rig, ACCESS_BEN, "visit allow ben match");
    access_rig_set_credential(rig, "anna", "{\"no_antipassback\": true}");
    access_rig_expect_visit(rig, ACCESS_ANNA, "visit allow anna match");
}

static void a_soft_violation_is_recorded(void **state)
{
    struct rig *rig = *state;
    access_rig_start(
        rig, access_rig_always("\"recognition_groups\": [[\"face\"]]", false,
                               ", \"from\": \"out\", \"to\": \"in\", \"antipassback\": \"soft\""));
    access_rig_expect_visit(rig, ACCESS_ANNA, "visit allow anna match");
    access_rig_expect_visit(rig, ACCESS_ANNA, "visit allow anna match");
    access_rig_expect(rig_record(rig, "grant"), "soft violation");
}

static void an_open_door_lets_strangers_in(void **state)
{
    struct rig *rig = *state;
    access_rig_start(rig, access_rig_always("\"open\": true", false, ""));
    access_rig_expect_visit(rig, ACCESS_STRANGER, "visit allow open");
    access_rig_expect_visit(rig, ACCESS_ANNA, "visit allow anna match");
    assert_int_equal(iso_appliance_lockdown(rig->appliance, true, NULL), 0);
    (void)rig_news(rig);
    access_rig_look(rig, ACCESS_STRANGER);
    assert_null(strstr(rig_news(rig), "allow"));
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, rig_setup, rig_teardown)
    const struct CMUnitTest tests[] = {
        TEST(without_a_policy_whoever_is_known_may_enter),
        TEST(a_schedule_decides),
        TEST(a_policy_needs_a_clock),
        TEST(a_policy_outlasts_a_restart),
        TEST(a_policy_without_this_door_lets_nobody_in),
        TEST(each_change_is_on_record),
        TEST(nobody_enters_twice_with_hard_antipassback),
        TEST(a_soft_violation_is_recorded),
        TEST(an_open_door_lets_strangers_in),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
