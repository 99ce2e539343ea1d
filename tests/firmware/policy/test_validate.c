/* What iso_policy_validate() refuses, one fault at a time, and the line that names it. */
#include <errno.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/policy/validate.h"
#include "tests/firmware/policy/policy_rig.h"

static struct policy_rig rig;

/* Each case changes a policy that is right. */
static void zone_without_name(void)
{
    rig.zone.name[0] = '\0';
}
static void office_ends_early(void)
{
    rig.schedules[RIG_OFFICE].weekly[1].periods[0] = (struct iso_period){17 * 60, 9 * 60};
}
static void office_is_empty(void)
{
    rig.schedules[RIG_OFFICE].weekly[2].periods[0] = (struct iso_period){540, 540};
}
static void office_passes_midnight(void)
{
    rig.schedules[RIG_OFFICE].weekly[5].periods[0].to_min = 1441;
}
static void periods_overlap(void)
{
    rig.schedules[RIG_OFFICE].weekly[3] = (struct iso_day_hours){
        .n = 2, .periods = {{480, 720}, {719, 900}}};
}
static void too_many_periods(void)
{
    rig.schedules[RIG_OFFICE].weekly[0].n = ISO_PERIODS_MAX + 1;
}
static void no_zone(void)
{
    rig.schedules[RIG_NEVER].zone = 1;
}
static void special_hours_inverted(void)
{
    rig.schedules[RIG_OFFICE].n_special = 1;
    rig.schedules[RIG_OFFICE].special[0] = (struct iso_special_hours){
        .hours = {.n = 1, .periods = {{2, 1}}}};
}
static void no_group(void)
{
    rig.schedules[RIG_OFFICE].n_special = 1;
    rig.schedules[RIG_OFFICE].special[0].group = 1;
}
static void group_twice(void)
{
    rig.schedules[RIG_OFFICE].n_special = 2;
}
static void too_many_groups(void)
{
    rig.schedules[RIG_OFFICE].n_special = ISO_SPECIAL_SCHEDULES_MAX + 1;
}
static void days_not_ascending(void)
{
    rig.group.n = 2;
    rig.group.days[1] = rig.group.days[0];
}
static void too_many_days(void)
{
    rig.group.n = ISO_SPECIAL_DAYS_MAX + 1;
}
static void area_without_token(void)
{
    rig.areas[1].token[0] = '\0';
}
static void endless_token(void)
{
    memset(rig.access_points[RIG_EXIT].token, 'x', ISO_TOKEN_SIZE);
}
static void same_priority(void)
{
    rig.levels[RIG_CARD_PIN].priority = 1;
}
static void open_with_groups(void)
{
    rig.levels[RIG_OPEN].n_groups = 1;
    rig.levels[RIG_OPEN].groups[0] = ISO_RECOGNITION_FACE;
}
static void empty_group(void)
{
    rig.levels[RIG_FACE].groups[0] = 0;
}
static void unknown_method(void)
{
    rig.levels[RIG_FACE].groups[0] = 8;
}
static void too_many_recognition_groups(void)
{
    rig.levels[RIG_FACE].n_groups = ISO_RECOGNITION_GROUPS_MAX + 1;
}
static void no_default_level(void)
{
    rig.authentication.default_level = ISO_INDEX_NONE;
}
static void no_level(void)
{
    policy_rig_ask(&rig, RIG_ALWAYS, RIG_LEVELS, false);
}
static void no_schedule_of_level(void)
{
    policy_rig_ask(&rig, RIG_SCHEDULES, RIG_FACE, false);
}
static void too_many_authentication_policies(void)
{
    rig.authentication.n_policies = ISO_AUTHENTICATION_POLICIES_MAX + 1;
}
static void no_area(void)
{
    rig.access_points[RIG_LAB_DOOR].to = RIG_AREAS;
}
static void no_authentication(void)
{
    rig.access_points[RIG_LAB_DOOR].authentication_profile = 1;
}
static void passback_to_nowhere(void)
{
    rig.access_points[RIG_EXIT].to = ISO_INDEX_NONE;
    rig.access_points[RIG_EXIT].antipassback = ISO_ANTIPASSBACK_SOFT;
}
static void timed_without_time(void)
{
    rig.access_points[RIG_EXIT].antipassback = ISO_ANTIPASSBACK_TIMED;
}
static void time_without_timed(void)
{
    rig.access_points[RIG_EXIT].antipassback_s = 5;
}
static void unknown_passback(void)
{
    rig.access_points[RIG_EXIT].antipassback = ISO_ANTIPASSBACK_TIMED + 1;
}
static void circle(void)
{
    rig.access_points[RIG_EXIT].to = RIG_INSIDE;
}
static void no_access_point(void)
{
    rig.access_profiles[RIG_STAFF].policies[1].access_point = 7;
}
static void no_schedule(void)
{
    rig.access_profiles[RIG_STAFF].policies[2].schedule = RIG_SCHEDULES;
}
static void too_many_access_policies(void)
{
    rig.access_profiles[RIG_STAFF].n_policies = ISO_ACCESS_POLICIES_MAX + 1;
}
static void no_profile(void)
{
    rig.credentials[RIG_BEN].profiles[0] = 1;
}
static void too_many_profiles(void)
{
    rig.credentials[RIG_BEN].n_profiles = ISO_CREDENTIAL_PROFILES_MAX + 1;
}
static void no_identifiers(void)
{
    rig.credentials[RIG_BEN].identifiers = 0;
}
static void unknown_identifier(void)
{
    rig.credentials[RIG_BEN].identifiers = 0x17;
}
static void pin_missing(void)
{
    rig.credentials[RIG_BEN].pin = 0;
}
static void pin_of_nobody(void)
{
    rig.credentials[RIG_BEN].identifiers = ISO_RECOGNITION_FACE;
}
static void short_pin(void)
{
    rig.credentials[RIG_BEN].pin = 1999;
}
static void pin_without_its_one(void)
{
    rig.credentials[RIG_BEN].pin = 20000;
}
static void duress_alone(void)
{
    rig.credentials[RIG_BEN].identifiers = ISO_RECOGNITION_FACE;
    rig.credentials[RIG_BEN].pin = 0;
}
static void duress_is_pin(void)
{
    rig.credentials[RIG_BEN].duress_pin = RIG_PIN;
}
static void long_duress(void)
{
    rig.credentials[RIG_BEN].duress_pin = 2000000000;
}
static void validity_ends_early(void)
{
    rig.credentials[RIG_BEN].valid_from_s = 100;
    rig.credentials[RIG_BEN].valid_to_s = 100;
}
static void validity_before_1970(void)
{
    rig.credentials[RIG_BEN].valid_from_s = -1;
}
static void endless_reason(void)
{
    memset(rig.credentials[RIG_BEN].disabled_reason, 'x', 32);
}

static const struct {
    void (*change)(void);
    const char *line;
} cases[] = {
    {zone_without_name, "zone number 0: is damaged"},
    {office_ends_early,
     "schedule \"office\": Monday: the period 17:00 to 09:00 ends before it begins"},
    {office_is_empty,
     "schedule \"office\": Tuesday: the period 09:00 to 09:00 ends before it begins"},
    {office_passes_midnight,
     "schedule \"office\": Friday: the period 08:00 to 24:01 ends after midnight"},
    {periods_overlap, "schedule \"office\": Wednesday: the period 11:59 to 15:00 begins too early: "
                      "periods ascend and do not overlap"},
    {too_many_periods, "schedule \"office\": Sunday: 9 periods, at most 8"},
    {no_zone, "schedule \"never\": names zone 1, and there are 1"},
    {special_hours_inverted,
     "schedule \"office\": holidays: the period 00:02 to 00:01 ends before it begins"},
    {no_group, "schedule \"office\": names special day group 1, and there are 1"},
    {group_twice, "schedule \"office\": names \"holidays\" twice"},
    {too_many_groups, "schedule \"office\": has 9 special day groups, at most 8"},
    {days_not_ascending, "special day group \"holidays\": its days are not ascending"},
    {too_many_days, "special day group \"holidays\": has 65 days, at most 64"},
    {area_without_token, "area number 1: has no token"},
    {endless_token, "access point number 1: the token has more than 64 bytes"},
    {same_priority, "security level \"card-pin\": has the same priority as \"face\""},
    {open_with_groups, "security level \"open\": is open and has recognition groups"},
    {empty_group, "security level \"face\": has a recognition group without methods"},
    {unknown_method, "security level \"face\": has a recognition method that does not exist"},
    {too_many_recognition_groups, "security level \"face\": has 5 groups, at most 4"},
    {no_default_level,
     "authentication profile \"doors\": names security level 65535, and there are 5"},
    {no_level, "authentication profile \"doors\": names security level 5, and there are 5"},
    {no_schedule_of_level, "authentication profile \"doors\": names schedule 3, and there are 3"},
    {too_many_authentication_policies,
     "authentication profile \"doors\": has 9 policies, at most 8"},
    {no_area, "access point \"lab-door\": names area 3, and there are 3"},
    {no_authentication,
     "access point \"lab-door\": names authentication profile 1, and there are 1"},
    {passback_to_nowhere, "access point \"exit\": has antipassback and leads to no area"},
    {timed_without_time,
     "access point \"exit\": has a time of antipassback that does not fit its kind"},
    {time_without_timed,
     "access point \"exit\": has a time of antipassback that does not fit its kind"},
    {unknown_passback, "access point \"exit\": has a kind of antipassback that does not exist"},
    {circle, "access point \"exit\": leads from an area to the same one"},
    {no_access_point, "access profile \"staff\": names access point 7, and there are 3"},
    {no_schedule, "access profile \"staff\": names schedule 3, and there are 3"},
    {too_many_access_policies, "access profile \"staff\": has 65 access policies, at most 64"},
    {no_profile, "credential \"ben\": names access profile 1, and there are 1"},
    {too_many_profiles, "credential \"ben\": has 9 access profiles, at most 8"},
    {no_identifiers, "credential \"ben\": has no identifiers"},
    {unknown_identifier, "credential \"ben\": has an identifier of a kind that does not exist"},
    {pin_missing, "credential \"ben\": is said to have a PIN and has none"},
    {pin_of_nobody, "credential \"ben\": has a PIN and is said to have none"},
    {short_pin, "credential \"ben\": has a PIN that is not of 4 to 9 digits"},
    {pin_without_its_one, "credential \"ben\": has a PIN that is not of 4 to 9 digits"},
    {duress_alone, "credential \"ben\": has a duress PIN and no PIN"},
    {duress_is_pin, "credential \"ben\": has its PIN as duress PIN"},
    {long_duress, "credential \"ben\": has a duress PIN that is not of 4 to 9 digits"},
    {validity_ends_early, "credential \"ben\": has a validity that ends before it begins"},
    {validity_before_1970, "credential \"ben\": has a validity before 1970"},
    {endless_reason, "credential \"ben\": has a reason without an end"},
};

static void test_each_fault(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        policy_rig_init(&rig);
        struct iso_fault fault = {0};
        assert_int_equal(iso_policy_validate(&rig.policy, &fault), 0);
        assert_string_equal(fault.text, "");
        cases[i].change();
        assert_int_equal(iso_policy_validate(&rig.policy, &fault), -EINVAL);
        assert_string_equal(fault.text, cases[i].line);
        assert_int_equal(iso_policy_validate(&rig.policy, NULL), -EINVAL);
    }
}

/* The shortest and the longest PIN, and the bounds of periods, are fine. */
static void test_bounds(void **state)
{
    (void)state;
    policy_rig_init(&rig);
    rig.credentials[RIG_ANNA].pin = 10000;
    rig.credentials[RIG_ANNA].duress_pin = 1999999999;
    rig.schedules[RIG_OFFICE].weekly[0] = (struct iso_day_hours){
        .n = 2, .periods = {{0, 720}, {720, 1440}}};
    assert_int_equal(iso_policy_validate(&rig.policy, NULL), 0);
    const struct iso_policy empty = {0};
    assert_int_equal(iso_policy_validate(&empty, NULL), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_each_fault),
        cmocka_unit_test(test_bounds),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
