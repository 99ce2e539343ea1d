/* A door of a fleet, with an appliance: who came from the hub is let in while the lease holds, and
 * nobody at the door may change such a person. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/door/door_null.h"
#include "tests/firmware/appliance/access_rig.h"
#include "tests/firmware/fleet/door/door_rig.h"
#include "tests/firmware/rigs/stores.h"

static struct door_rig hub;

enum { ADA = 60, EVE = 80 };

/* Anna and Ben were enrolled at the door; it joins, has one zone and a lease. */
static void begin(struct rig *rig, const char *policy)
{
    struct iso_transfer_keys keys;
    rig_capacity = 0;
    hub = (struct door_rig){.directory = rig->directory};
    access_rig_start(rig, policy);
    iso_transfer_get_keys(rig->borrowed.ring, &keys);
    memcpy(hub.door_signs.public, keys.signs, sizeof keys.signs);
    memcpy(hub.door_receives.public, keys.receives, sizeof keys.receives);
    hub.fleet = iso_appliance_fleet(rig->appliance);
    hub.gallery = rig->gallery;
    door_rig_make_hub(&hub);
    door_rig_join(&hub);
    hub.local_people = true;
    door_rig_begin(&hub, 1);
}

static void put(int person, uint64_t revision, const char *name, int face, bool offline_ok)
{
    assert_int_equal(
        door_rig_give(&hub, door_rig_put(&hub, 0, person, revision, name, face, offline_ok)),
        ISO_FLEET_APPLIED);
}

static void a_person_of_the_hub_comes_and_goes(void **state)
{
    struct rig *rig = *state;
    begin(rig, "");
    access_rig_expect_visit(rig, ADA, "visit deny left");
    put(1, 1, "ada", ADA, false);
    access_rig_expect_visit(rig, ADA, "visit allow ada match");
    access_rig_expect(rig_record(rig, "fleet"), "\"person\":\"ada\"");
    assert_int_equal(door_rig_give(&hub, door_rig_remove(&hub, 0, 1, 2)), ISO_FLEET_APPLIED);
    access_rig_expect_visit(rig, ADA, "visit deny left");
    access_rig_expect(rig_record(rig, "fleet"), "\"reason\":\"removed\"");
}

/* What the door tells the hub of itself has these members. */
static void expect_health(const char *members)
{
    struct iso_fault fault = {.text = ""};
    struct iso_fleet_question question;
    struct iso_fleet_bytes asked = {.bytes = NULL};
    char text[ISO_FLEET_HEALTH_MAX + 1];

    assert_int_equal(iso_fleet_question(hub.fleet, &asked, &fault), 0);
    assert_int_equal(
        iso_fleet_read_question(asked.bytes, asked.size, hub.door_signs.public, &question), 0);
    assert_true(question.health_length < sizeof text);
    memcpy(text, question.health, question.health_length);
    text[question.health_length] = '\0';
    access_rig_expect(text, members);
    iso_fleet_bytes_free(&asked);
}

/* Home Assistant shows these members (enroll/hub/serve/home_text.h). */
static void the_hub_learns_how_the_door_stands(void **state)
{
    struct rig *rig = *state;
    begin(rig, "");
    expect_health("\"door-state\":\"locked\",\"tamper\":0,");
    assert_int_equal(iso_door_null_set_input(rig->door_io, ISO_DOOR_TAMPER, true), 0);
    assert_int_equal(iso_door_null_set_input(rig->door_io, ISO_DOOR_CONTACT, true), 0);
    access_rig_expect_visit(rig, ADA, "visit deny left"); /* time passes */
    expect_health("\"door-state\":\"forced\",\"tamper\":1,");
    assert_int_equal(iso_door_null_set_input(rig->door_io, ISO_DOOR_TAMPER, false), 0);
    assert_int_equal(iso_door_null_set_input(rig->door_io, ISO_DOOR_CONTACT, false), 0);
    access_rig_expect_visit(rig, ADA, "visit deny left");
    expect_health("\"door-state\":\"locked\",\"tamper\":0,");
}

/* It is half past eight in the morning. */
static void an_update_restarts_the_machine_in_its_hours(void **state)
{
    static const struct {
        const char *hours;
        enum iso_fleet_update_state state;
        bool busy;
    } cases[] = {
        {"", ISO_FLEET_UPDATE_INSTALLED, false},     {"1-5", ISO_FLEET_UPDATE_INSTALLED, true},
        {"8-9", ISO_FLEET_UPDATE_INSTALLED, false},  {"9-8", ISO_FLEET_UPDATE_INSTALLED, true},
        {"22-9", ISO_FLEET_UPDATE_INSTALLED, false}, {"1-5", ISO_FLEET_UPDATE_FETCHING, false},
    };
    struct rig *rig = *state;
    assert_int_equal(setenv("TZ", "UTC", 1), 0);
    begin(rig, "");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const struct iso_fleet_update_report report = {.is_known = true, .state = cases[i].state};
        bool busy = !cases[i].busy;
        strcpy(rig->config.fleet.restart_hours, cases[i].hours);
        assert_int_equal(iso_fleet_set_update(hub.fleet, &report, &busy, NULL), 0);
        assert_int_equal(busy, cases[i].busy);
    }
}

/* An hour is over; the door has a clock of its own, and the hub answers again. */
static void without_a_lease_nobody_of_the_hub_enters(void **state)
{
    struct rig *rig = *state;
    begin(rig, "");
    put(1, 1, "ada", ADA, false);
    rig_run(rig, 3600 * 1000);
    access_rig_expect_visit(rig, ADA, "visit deny ada no-lease");
    access_rig_expect(rig_record(rig, "visit"),
                      "no lease: the hub has not answered since 2026-11-21T08:33:2");
    access_rig_expect(rig_record(rig, "fleet"), "\"reason\":\"lease-over\"");
    access_rig_expect_visit(rig, ACCESS_BEN, "visit allow ben match"); /* enrolled here */
    assert_int_equal(door_rig_answer(&hub, 1), ISO_FLEET_APPLIED);
    access_rig_expect_visit(rig, ADA, "visit allow ada match");
    put(1, 2, "ada", ADA, true);
    rig_run(rig, 3600 * 1000);
    access_rig_expect_visit(rig, ADA, "visit allow ada match");
}

static void local_people_enter_if_the_hub_says_so(void **state)
{
    struct rig *rig = *state;
    begin(rig, "");
    access_rig_expect_visit(rig, ACCESS_ANNA, "visit allow anna match");
    hub.local_people = false;
    assert_int_equal(door_rig_answer(&hub, 1), ISO_FLEET_APPLIED);
    access_rig_expect_visit(rig, ACCESS_ANNA, "visit deny anna not-approved");
    assert_int_equal(iso_fleet_leave(hub.fleet, "user 0", NULL), 0);
    access_rig_expect_visit(rig, ACCESS_ANNA, "visit allow anna match");
}

/* Also with a policy, by a card before the face, and over a restart of the daemon. */
static void the_policy_does_not_replace_the_lease(void **state)
{
    struct rig *rig = *state;
    begin(rig, access_rig_always("\"recognition_groups\": [[\"face\"]]", false, ""));
    put(1, 1, "ada", ADA, false);
    access_rig_expect_visit(rig, ADA, "visit allow ada match");
    access_rig_restart(rig);
    hub.fleet = iso_appliance_fleet(rig->appliance);
    access_rig_expect_visit(rig, ADA, "visit allow ada match");
    hub.lease_s = 5;
    assert_int_equal(door_rig_answer(&hub, 1), ISO_FLEET_APPLIED);
    rig_run(rig, 5000);
    access_rig_expect_visit(rig, ADA, "visit deny ada no-lease");
    struct iso_site_access *site = iso_appliance_access(rig->appliance);
    const struct iso_site_request request = {.person = door_rig_person(&hub, "ada"),
                                             .shown = {.matched = ISO_RECOGNITION_CARD},
                                             .time_s = 1795250000,
                                             .time_known = true};
    assert_int_equal(iso_site_access_decide(site, rig->gallery, &request).reason,
                     ISO_ACCESS_NO_LEASE);
    struct iso_site_request pair = {.person = door_rig_person(&hub, "ben"),
                                    .companion = request.person,
                                    .time_s = 1795250000,
                                    .time_known = true};
    assert_int_equal(iso_site_access_decide(site, rig->gallery, &pair).reason, ISO_ACCESS_NO_LEASE);
    assert_true(iso_site_access_decide(site, rig->gallery, &pair).of_companion);
}

static void the_policy_comes_from_the_hub(void **state)
{
    struct rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    uint64_t revision = 0;
    begin(rig, "");
    put(1, 1, "ada", ADA, false);
    const char *json = access_rig_always("\"recognition_groups\": [[\"face\"]]", false, "");
    assert_int_equal(door_rig_give(&hub, door_rig_policy(&hub, 0, json)), ISO_FLEET_APPLIED);
    assert_int_equal(iso_site_access_revision(iso_appliance_access(rig->appliance)), 1);
    access_rig_expect(rig_record(rig, "gallery"), "\"gallery\":");
    access_rig_expect_visit(rig, ADA, "visit allow ada match");
    assert_int_equal(iso_appliance_set_policy(rig->appliance, "", 1, "me", &revision, &fault),
                     -EINVAL);
    assert_string_equal(fault.text, "the policy is managed by the hub HQ");
    /* One that this door cannot use: the earlier one stays in force. */
    assert_int_equal(door_rig_give(&hub, door_rig_policy(&hub, 0, "{\"colour\": 1}")),
                     ISO_FLEET_APPLIED);
    assert_int_equal(iso_site_access_revision(iso_appliance_access(rig->appliance)), 1);
    access_rig_expect(rig_record(rig, "fleet"), "policy-refused");
    access_rig_restart(rig);
    assert_int_equal(iso_site_access_revision(iso_appliance_access(rig->appliance)), 1);
    struct iso_fleet_status status;
    assert_int_equal(iso_fleet_get_status(iso_appliance_fleet(rig->appliance), &status, NULL), 0);
    assert_int_equal(status.places[0].sequence, 3);
}

static void a_lockdown_comes_from_the_hub(void **state)
{
    struct rig *rig = *state;
    begin(rig, "");
    assert_int_equal(door_rig_give(&hub, door_rig_lock(&hub, 0, true)), ISO_FLEET_APPLIED);
    access_rig_expect_visit(rig, ACCESS_ANNA, "visit deny lockdown");
    assert_int_equal(door_rig_give(&hub, door_rig_lock(&hub, 0, false)), ISO_FLEET_APPLIED);
    access_rig_expect_visit(rig, ACCESS_ANNA, "visit allow anna match");
}

static void expect_managed(int error, const struct iso_fault *fault)
{
    assert_int_equal(error, -EINVAL);
    assert_string_equal(fault->text, "ada is managed by the hub HQ");
}

static void nobody_at_the_door_changes_a_person_of_the_hub(void **state)
{
    struct rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    const char *remark = "";
    const struct iso_validity_change limits = {.names_until = true, .limits = {0, 1900000000}};
    const struct iso_enroll_request request = {.person = "ada"};
    begin(rig, "");
    put(1, 1, "ada", ADA, false);
    expect_managed(iso_appliance_remove(rig->appliance, "ada", &fault), &fault);
    expect_managed(iso_appliance_rename(rig->appliance, "ada", "eve", &remark, &fault), &fault);
    expect_managed(iso_appliance_set_validity(rig->appliance, "ada", &limits, &fault), &fault);
    expect_managed(
        iso_appliance_set_credential(rig->appliance, "ada", "{\"enabled\":false}", "me", &fault),
        &fault);
    assert_int_equal(iso_appliance_claim(rig->appliance), 0);
    expect_managed(iso_appliance_enroll(rig->appliance, &request, &fault), &fault);
    iso_appliance_release(rig->appliance);
    access_rig_expect_visit(rig, ADA, "visit allow ada match");
    assert_int_equal(iso_appliance_remove(rig->appliance, "ben", &fault), 0);
}

/* The hub sends Eve while she is being enrolled at the door. */
static void an_enrolment_does_not_add_to_a_person_of_the_hub(void **state)
{
    struct rig *rig = *state;
    const struct iso_enroll_request request = {.person = "eve"};
    begin(rig, "");
    assert_int_equal(iso_appliance_claim(rig->appliance), 0);
    rig_start_enrolling(rig, &request);
    put(1, 1, "eve", ADA, false);
    rig_show(rig, EVE, 12);
    rig_run(rig, 3000);
    access_rig_expect(rig_news(rig), "enroll failed");
    assert_int_equal(iso_gallery_find(rig->gallery, "eve")->templates, 1);
}

static void a_login_needs_a_lease(void **state)
{
    struct rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    rig->config.login.desk = true;
    begin(rig, "");
    put(1, 1, "ada", ADA, false);
    hub.lease_s = 5;
    assert_int_equal(door_rig_answer(&hub, 1), ISO_FLEET_APPLIED);
    assert_int_equal(iso_appliance_verify_login(rig->appliance, "ada", &fault), 0);
    (void)rig_news(rig);
    rig_run(rig, 4950);
    rig_show(rig, ADA, 6); /* it ends while she looks */
    rig_run(rig, 300);
    access_rig_expect(rig_news(rig), "no-match");
    assert_int_equal(iso_appliance_verify_login(rig->appliance, "ada", &fault), -EPERM);
    access_rig_expect(fault.text, "ada: no lease: the hub has not answered since");
    hub.local_people = false;
    assert_int_equal(door_rig_answer(&hub, 1), ISO_FLEET_APPLIED);
    assert_int_equal(iso_appliance_verify_login(rig->appliance, "ben", &fault), -EPERM);
    assert_string_equal(fault.text, "ben: not approved by the hub yet");
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, rig_setup, rig_teardown)
    const struct CMUnitTest tests[] = {
        TEST(a_person_of_the_hub_comes_and_goes),
        TEST(the_hub_learns_how_the_door_stands),
        TEST(an_update_restarts_the_machine_in_its_hours),
        TEST(without_a_lease_nobody_of_the_hub_enters),
        TEST(local_people_enter_if_the_hub_says_so),
        TEST(the_policy_does_not_replace_the_lease),
        TEST(the_policy_comes_from_the_hub),
        TEST(a_lockdown_comes_from_the_hub),
        TEST(nobody_at_the_door_changes_a_person_of_the_hub),
        TEST(an_enrolment_does_not_add_to_a_person_of_the_hub),
        TEST(a_login_needs_a_lease),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
