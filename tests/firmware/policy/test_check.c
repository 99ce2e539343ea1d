/* What iso_policy_check() finds. */
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/policy/check.h"
#include "tests/firmware/policy/policy_rig.h"

static struct policy_rig rig;
static struct iso_policy_finding findings[16];

static int setup(void **state)
{
    (void)state;
    policy_rig_init(&rig);
    /* The rig has a schedule that is never active, which every test would find. */
    rig.schedules[RIG_NEVER].weekly[0] = (struct iso_day_hours){.n = 1, .periods = {{0, 1}}};
    return 0;
}

static size_t check_at(int64_t now_s)
{
    return iso_policy_check(&rig.policy, now_s, findings, 16);
}

static void expect(size_t at, const char *line)
{
    char text[ISO_POLICY_FINDING_TEXT_SIZE];
    assert_string_equal(iso_policy_finding_text(&rig.policy, &findings[at], text), line);
}

static void test_nothing(void **state)
{
    (void)state;
    assert_int_equal(check_at(RIG_NOON_S), 0);
}

static void test_a_schedule_that_is_never_active(void **state)
{
    (void)state;
    struct iso_schedule *never = &rig.schedules[RIG_NEVER];
    never->weekly[0].n = 0;
    assert_int_equal(check_at(RIG_NOON_S), 1);
    expect(0, "schedule \"never\" is never active");
    /* Hours on Christmas, until Christmas is over. */
    never->n_special = 1;
    assert_int_equal(check_at(RIG_NOON_S), 1); /* no hours yet */
    never->special[0].hours = (struct iso_day_hours){.n = 1, .periods = {{600, 660}}};
    assert_int_equal(check_at(RIG_NOON_S), 0);
    assert_int_equal(check_at(RIG_NOON_S + INT64_C(30) * 86400 + 43199), 0);
    assert_int_equal(check_at(RIG_NOON_S + INT64_C(30) * 86400 + 43200), 1);
    rig.group.n = 0;
    assert_int_equal(check_at(RIG_NOON_S), 1);
}

static void test_a_person_whom_nobody_lets_in(void **state)
{
    (void)state;
    struct iso_credential *ben = &rig.credentials[RIG_BEN];
    ben->n_profiles = 0;
    assert_int_equal(check_at(RIG_NOON_S), 1);
    expect(0, "credential \"ben\" is enabled, and no access policy ever lets it in");
    ben->enabled = false; /* meant to be let in nowhere */
    assert_int_equal(check_at(RIG_NOON_S), 0);
    ben->enabled = true;
    ben->valid_to_s = RIG_NOON_S;
    assert_int_equal(check_at(RIG_NOON_S), 0);
    assert_int_equal(check_at(RIG_NOON_S - 1), 1);
    ben->valid_to_s = 0;
    ben->n_profiles = 1;
    ben->identifiers = ISO_RECOGNITION_CARD; /* no level asks for a card alone */
    ben->pin = ben->duress_pin = 0;
    assert_int_equal(check_at(RIG_NOON_S), 1);
    policy_rig_ask(&rig, RIG_OFFICE, RIG_CARD_PIN, false);
    assert_int_equal(check_at(RIG_NOON_S), 1);                 /* nor does this one */
    rig.levels[RIG_CARD_PIN].groups[0] = ISO_RECOGNITION_CARD; /* some level does now */
    assert_int_equal(check_at(RIG_NOON_S), 0);
}

static void test_people_whose_doors_are_out_of_service(void **state)
{
    (void)state;
    for (int i = 0; i < RIG_ACCESS_POINTS; i++) {
        assert_int_equal(check_at(RIG_NOON_S), 0);
        rig.access_points[i].enabled = false;
    }
    assert_int_equal(check_at(RIG_NOON_S), RIG_CREDENTIALS);
    expect(2, "credential \"carl\" is enabled, and no access policy ever lets it in");
}

static void test_an_access_point_without_a_way(void **state)
{
    (void)state;
    rig.access_profiles[RIG_STAFF].n_policies = 2; /* without the door of the lab */
    assert_int_equal(check_at(RIG_NOON_S), 1);
    expect(0, "access point \"lab-door\" lets nobody in at any time");
    rig.access_points[RIG_LAB_DOOR].enabled = false;
    assert_int_equal(check_at(RIG_NOON_S), 0);
    rig.access_points[RIG_LAB_DOOR].enabled = true;
    policy_rig_ask(&rig, RIG_OFFICE, RIG_OPEN, false); /* open to everybody */
    assert_int_equal(check_at(RIG_NOON_S), 0);
    rig.authentication.n_policies = 0;
    rig.authentication.default_level = RIG_CLOSED; /* and with it everything else */
    assert_int_equal(check_at(RIG_NOON_S), RIG_CREDENTIALS + RIG_ACCESS_POINTS);
    expect(0, "credential \"anna\" is enabled, and no access policy ever lets it in");
    expect(RIG_CREDENTIALS, "access point \"entry\" lets nobody in at any time");
}

/* A schedule that is never active leads nowhere, and all findings are counted. */
static void test_all_are_counted(void **state)
{
    (void)state;
    memset(rig.schedules[RIG_ALWAYS].weekly, 0, sizeof rig.schedules[RIG_ALWAYS].weekly);
    findings[2].index = 4711;
    assert_int_equal(iso_policy_check(&rig.policy, RIG_NOON_S, findings, 2),
                     1 + RIG_CREDENTIALS + RIG_ACCESS_POINTS);
    assert_int_equal(findings[2].index, 4711);
    expect(0, "schedule \"always\" is never active");
    assert_int_equal(iso_policy_check(&rig.policy, RIG_NOON_S, NULL, 0),
                     1 + RIG_CREDENTIALS + RIG_ACCESS_POINTS);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(test_nothing, setup),
        cmocka_unit_test_setup(test_a_schedule_that_is_never_active, setup),
        cmocka_unit_test_setup(test_a_person_whom_nobody_lets_in, setup),
        cmocka_unit_test_setup(test_people_whose_doors_are_out_of_service, setup),
        cmocka_unit_test_setup(test_an_access_point_without_a_way, setup),
        cmocka_unit_test_setup(test_all_are_counted, setup),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
