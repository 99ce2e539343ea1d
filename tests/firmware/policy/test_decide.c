/* Decisions in tables: security levels, what was shown, antipassback, two people, duress. What
 * happens when several rules apply: test_decide_pairs.c. */
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/policy/occupancy.h"
#include "tests/firmware/policy/policy_rig.h"

static struct policy_rig rig;
static struct iso_access_request request;

static int setup(void **state)
{
    (void)state;
    policy_rig_init(&rig);
    request = policy_rig_request();
    return 0;
}

static struct iso_access decide(void)
{
    return policy_rig_decide(&rig, &request);
}

enum { F = ISO_RECOGNITION_FACE, C = ISO_RECOGNITION_CARD, P = ISO_RECOGNITION_PIN };

static void test_all_zero_is_deny(void **state)
{
    (void)state;
    const struct iso_access zero = {0};
    assert_int_equal(zero.outcome, ISO_ACCESS_DENY);
    assert_int_equal(zero.reason, ISO_ACCESS_OTHER);
    /* A level of zeros is closed, and a presence of zeros is unknown. */
    const struct iso_security_level level = {0};
    assert_false(iso_security_level_can_pass(&level, ISO_RECOGNITION_ALL));
}

static void test_indices_of_the_request_may_be_anything(void **state)
{
    (void)state;
    request.access_point = RIG_ACCESS_POINTS;
    assert_int_equal(decide().outcome, ISO_ACCESS_DENY);
    request.access_point = ISO_INDEX_NONE;
    assert_int_equal(decide().reason, ISO_ACCESS_OTHER);
    assert_false(decide().has_level);
    request = policy_rig_request();
    request.credential = RIG_CREDENTIALS;
    assert_int_equal(decide().reason, ISO_ACCESS_NOT_FOUND);
    request = policy_rig_request();
    policy_rig_ask(&rig, RIG_ALWAYS, RIG_FACE, true);
    request.companion = RIG_CREDENTIALS;
    assert_int_equal(decide().reason, ISO_ACCESS_NOT_FOUND);
    assert_true(decide().of_companion);
}

/* What each level asks of whom. */
static void test_what_is_shown(void **state)
{
    (void)state;
    static const struct {
        int level, identifiers, matched;
        iso_pin pin;
        enum iso_access_outcome outcome;
        enum iso_access_reason reason;
        int wanted;
    } rows[] = {
        {RIG_FACE, F | C | P, 0, 0, ISO_ACCESS_WANT, 0, F},
        {RIG_FACE, F | C | P, C, 0, ISO_ACCESS_WANT, 0, F},
        {RIG_FACE, F | C | P, F, 0, ISO_ACCESS_ALLOW, 0, 0},
        {RIG_FACE, F, F, 0, ISO_ACCESS_ALLOW, 0, 0},
        {RIG_FACE, C | P, C, RIG_PIN, ISO_ACCESS_DENY, ISO_ACCESS_UNAUTHORIZED, 0},
        {RIG_FACE, C | P, F, 0, ISO_ACCESS_DENY, ISO_ACCESS_INVALID_IDENTIFIER, 0},
        {RIG_FACE, F, F, RIG_PIN, ISO_ACCESS_DENY, ISO_ACCESS_INVALID_PIN, 0},
        {RIG_FACE, F | C | P, F, RIG_PIN, ISO_ACCESS_ALLOW, 0, 0},
        {RIG_FACE, F | C | P, F, RIG_PIN + 4, ISO_ACCESS_DENY, ISO_ACCESS_INVALID_PIN, 0},
        {RIG_CARD_PIN, F | C | P, F, 0, ISO_ACCESS_WANT, 0, C | P},
        {RIG_CARD_PIN, F | C | P, C, 0, ISO_ACCESS_WANT, 0, P},
        {RIG_CARD_PIN, F | C | P, 0, RIG_PIN, ISO_ACCESS_WANT, 0, C},
        {RIG_CARD_PIN, F | C | P, C, RIG_PIN, ISO_ACCESS_ALLOW, 0, 0},
        {RIG_CARD_PIN, F | C | P, C | P, 0, ISO_ACCESS_WANT, 0, P}, /* a PIN counts by its digits */
        {RIG_CARD_PIN, F | C, C, 0, ISO_ACCESS_DENY, ISO_ACCESS_UNAUTHORIZED, 0},
        {RIG_FACE_OR_CARD, F | C | P, 0, 0, ISO_ACCESS_WANT, 0, F},
        {RIG_FACE_OR_CARD, C | P, 0, 0, ISO_ACCESS_WANT, 0, C | P},
        {RIG_FACE_OR_CARD, C | P, C, 0, ISO_ACCESS_WANT, 0, P},
        {RIG_FACE_OR_CARD, F, F, 0, ISO_ACCESS_ALLOW, 0, 0},
        {RIG_CLOSED, F | C | P, F | C, RIG_PIN, ISO_ACCESS_DENY, ISO_ACCESS_NOT_AT_THIS_TIME, 0},
        {RIG_OPEN, F, 0, 0, ISO_ACCESS_ALLOW, 0, 0},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        (void)setup(NULL);
        rig.authentication.default_level = (uint16_t)rows[i].level;
        rig.credentials[RIG_ANNA].identifiers = (uint8_t)rows[i].identifiers;
        request.shown = (struct iso_shown){.matched = (uint8_t)rows[i].matched, .pin = rows[i].pin};
        const struct iso_access access = decide();
        if (access.outcome != rows[i].outcome || access.reason != rows[i].reason ||
            access.wanted != rows[i].wanted || access.level != rows[i].level) {
            fail_msg("row %zu: outcome %d, reason %s, wanted %d", i, access.outcome,
                     iso_access_reason_name(access.reason), access.wanted);
        }
    }
}

/* The example of ONVIF's Authentication Behavior: four states of one schedule, each with a level.
 */
static void test_levels_by_schedule(void **state)
{
    (void)state;
    rig.schedules[RIG_OFFICE].n_special = 1;
    rig.schedules[RIG_OFFICE].special[0] = (struct iso_special_hours){
        .hours = {.n = 1, .periods = {{9 * 60, 13 * 60}}}};
    rig.authentication.default_level = RIG_OPEN; /* never reached */
    rig.authentication.n_policies = 1;
    rig.authentication.policies[0] = (struct iso_authentication_policy){
        .schedule = RIG_OFFICE,
        .constraints = {[ISO_SCHEDULE_INACTIVE] = {RIG_CARD_PIN, false},
                        [ISO_SCHEDULE_ACTIVE] = {RIG_FACE, false},
                        [ISO_SCHEDULE_SPECIAL] = {RIG_CLOSED, false},
                        [ISO_SCHEDULE_SPECIAL_ACTIVE] = {RIG_FACE, true}}};
    const int64_t christmas_s = RIG_NOON_S + INT64_C(30) * 86400;
    const struct {
        int64_t time_s;
        int level;
        bool dual;
    } rows[] = {{RIG_NOON_S, RIG_FACE, false},
                {RIG_NOON_S + 6 * 3600, RIG_CARD_PIN, false},
                {RIG_NOON_S + 3 * 86400, RIG_CARD_PIN, false}, /* Saturday */
                {christmas_s, RIG_FACE, true},
                {christmas_s + 3600, RIG_CLOSED, false}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        const struct iso_level_constraint asked = iso_access_level_at(
            &rig.policy, &rig.access_points[RIG_ENTRY], rows[i].time_s);
        assert_int_equal(asked.level, rows[i].level);
        assert_int_equal(asked.dual, rows[i].dual);
    }
}

static void test_the_highest_priority_wins(void **state)
{
    (void)state;
    policy_rig_ask(&rig, RIG_ALWAYS, RIG_FACE_OR_CARD, false);
    policy_rig_ask(&rig, RIG_ALWAYS, RIG_CARD_PIN, false);
    policy_rig_ask(&rig, RIG_ALWAYS, RIG_FACE, true);
    policy_rig_ask(&rig, RIG_NEVER, RIG_CLOSED, false);
    assert_int_equal(decide().level, RIG_CARD_PIN);
    rig.levels[RIG_CARD_PIN].priority = 2; /* below RIG_FACE_OR_CARD */
    assert_int_equal(decide().level, RIG_FACE_OR_CARD);
    assert_int_equal(decide().outcome, ISO_ACCESS_ALLOW);
    policy_rig_ask(&rig, RIG_ALWAYS, RIG_FACE_OR_CARD, true); /* the same level, two people */
    assert_int_equal(decide().outcome, ISO_ACCESS_WANT);
    assert_true(decide().companion_wanted);
}

/* Access policies of one profile, and of several, count together. */
static void test_access_policies_are_a_union(void **state)
{
    (void)state;
    rig.access_profiles[RIG_STAFF].policies[RIG_ENTRY].schedule = RIG_NEVER;
    assert_int_equal(decide().reason, ISO_ACCESS_NOT_AT_THIS_TIME);
    rig.access_profiles[RIG_STAFF].policies[3] = (struct iso_access_policy){
        .access_point = RIG_ENTRY, .schedule = RIG_OFFICE};
    rig.access_profiles[RIG_STAFF].n_policies = 4;
    assert_int_equal(decide().outcome, ISO_ACCESS_ALLOW);
    request.time_s += 5 * 3600; /* 17:00 */
    assert_int_equal(decide().reason, ISO_ACCESS_NOT_AT_THIS_TIME);
    request.access_point = RIG_EXIT;
    assert_int_equal(decide().outcome, ISO_ACCESS_ALLOW);
}

static void test_validity_ends_before_its_end(void **state)
{
    (void)state;
    rig.credentials[RIG_ANNA].valid_from_s = RIG_NOON_S;
    rig.credentials[RIG_ANNA].valid_to_s = RIG_NOON_S + 10;
    assert_int_equal(decide().outcome, ISO_ACCESS_ALLOW);
    request.time_s = RIG_NOON_S - 1;
    assert_int_equal(decide().reason, ISO_ACCESS_NOT_ACTIVE);
    request.time_s = RIG_NOON_S + 9;
    assert_int_equal(decide().outcome, ISO_ACCESS_ALLOW);
    request.time_s = RIG_NOON_S + 10;
    assert_int_equal(decide().reason, ISO_ACCESS_EXPIRED);
}

static void test_antipassback(void **state)
{
    (void)state;
    enum { UNKNOWN = -1 };
    static const struct {
        int access_point, mode, area, seconds_ago;
        bool violation;
    } rows[] = {
        /* The entry leads from outside to inside. */
        {RIG_ENTRY, ISO_ANTIPASSBACK_NONE, RIG_INSIDE, 5, false},
        {RIG_ENTRY, ISO_ANTIPASSBACK_HARD, UNKNOWN, 5, false},
        {RIG_ENTRY, ISO_ANTIPASSBACK_HARD, RIG_OUTSIDE, 5, false},
        {RIG_ENTRY, ISO_ANTIPASSBACK_HARD, RIG_INSIDE, 5, true},
        {RIG_ENTRY, ISO_ANTIPASSBACK_HARD, RIG_LAB, 5, true},
        {RIG_ENTRY, ISO_ANTIPASSBACK_SOFT, RIG_INSIDE, 5, true},
        {RIG_ENTRY, ISO_ANTIPASSBACK_SOFT, RIG_OUTSIDE, 5, false},
        /* The door of the lab leads from no area. */
        {RIG_LAB_DOOR, ISO_ANTIPASSBACK_HARD, RIG_LAB, 5, true},
        {RIG_LAB_DOOR, ISO_ANTIPASSBACK_HARD, RIG_INSIDE, 5, false},
        /* Timed: 60 seconds. */
        {RIG_ENTRY, ISO_ANTIPASSBACK_TIMED, RIG_INSIDE, 59, true},
        {RIG_ENTRY, ISO_ANTIPASSBACK_TIMED, RIG_INSIDE, 60, false},
        {RIG_ENTRY, ISO_ANTIPASSBACK_TIMED, RIG_LAB, 5, false},
        {RIG_ENTRY, ISO_ANTIPASSBACK_TIMED, UNKNOWN, 5, false},
        {RIG_ENTRY, ISO_ANTIPASSBACK_TIMED, RIG_INSIDE, -3600, true}, /* the clock was set back */
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        (void)setup(NULL);
        request.access_point = (uint16_t)rows[i].access_point;
        struct iso_access_point *point = &rig.access_points[rows[i].access_point];
        point->antipassback = (uint8_t)rows[i].mode;
        point->antipassback_s = rows[i].mode == ISO_ANTIPASSBACK_TIMED ? 60 : 0;
        rig.presences[RIG_ANNA] = (struct iso_presence){.known = rows[i].area != UNKNOWN,
                                                        .area = (uint16_t)rows[i].area,
                                                        .since_s = RIG_NOON_S -
                                                                   rows[i].seconds_ago};
        const bool soft = rows[i].mode == ISO_ANTIPASSBACK_SOFT;
        const struct iso_access access = decide();
        if ((access.outcome == ISO_ACCESS_DENY) != (rows[i].violation && !soft) ||
            (access.reason == ISO_ACCESS_ANTIPASSBACK) != (rows[i].violation && !soft) ||
            access.passback != (rows[i].violation && soft)) {
            fail_msg("row %zu: outcome %d, passback %d", i, access.outcome, access.passback);
        }
        rig.credentials[RIG_ANNA].no_antipassback = true;
        assert_int_equal(decide().outcome, ISO_ACCESS_ALLOW);
        assert_false(decide().passback);
        rig.credentials[RIG_ANNA].no_antipassback = false;
        rig.occupancy.n = 0;
        assert_int_equal(decide().outcome, ISO_ACCESS_ALLOW);
    }
}

/* In, in again, out, in. */
static void test_a_walk_through_the_areas(void **state)
{
    (void)state;
    rig.access_points[RIG_ENTRY].antipassback = ISO_ANTIPASSBACK_HARD;
    rig.access_points[RIG_EXIT].antipassback = ISO_ANTIPASSBACK_HARD;
    struct iso_presence *anna = &rig.presences[RIG_ANNA];
    assert_int_equal(decide().outcome, ISO_ACCESS_ALLOW);
    iso_presence_enter(anna, &rig.access_points[RIG_ENTRY], RIG_NOON_S);
    assert_true(anna->known);
    assert_int_equal(anna->area, RIG_INSIDE);
    assert_int_equal(anna->since_s, RIG_NOON_S);
    assert_int_equal(decide().reason, ISO_ACCESS_ANTIPASSBACK);
    request.access_point = RIG_EXIT;
    assert_int_equal(decide().outcome, ISO_ACCESS_ALLOW);
    iso_presence_enter(anna, &rig.access_points[RIG_EXIT], RIG_NOON_S + 60);
    assert_int_equal(decide().reason, ISO_ACCESS_ANTIPASSBACK);
    iso_presence_forget(anna);
    assert_int_equal(decide().outcome, ISO_ACCESS_ALLOW);
    rig.access_points[RIG_EXIT].to = ISO_INDEX_NONE;
    iso_presence_enter(anna, &rig.access_points[RIG_EXIT], RIG_NOON_S + 60);
    assert_false(anna->known);
}

static void with_ben(void)
{
    request.companion = RIG_BEN;
    request.companion_shown = (struct iso_shown){.matched = ISO_RECOGNITION_FACE};
}

static void test_two_people(void **state)
{
    (void)state;
    policy_rig_ask(&rig, RIG_ALWAYS, RIG_FACE, true);
    with_ben();
    static const struct {
        int class_anna, class_ben;
        bool guest_anna, guest_ben, pair;
    } rows[] = {
        {0, 0, false, false, true}, {1, 0, false, false, true},  {0, 1, false, false, true},
        {1, 2, false, false, true}, {2, 2, false, false, false}, {0, 0, true, false, true},
        {0, 0, false, true, true},  {0, 0, true, true, false},   {1, 2, true, true, false},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        rig.credentials[RIG_ANNA].two_person_class = (uint8_t)rows[i].class_anna;
        rig.credentials[RIG_BEN].two_person_class = (uint8_t)rows[i].class_ben;
        rig.credentials[RIG_ANNA].needs_escort = rows[i].guest_anna;
        rig.credentials[RIG_BEN].needs_escort = rows[i].guest_ben;
        const struct iso_access access = decide();
        assert_int_equal(access.outcome, rows[i].pair ? ISO_ACCESS_ALLOW : ISO_ACCESS_DENY);
        assert_int_equal(access.reason, rows[i].pair ? ISO_ACCESS_OTHER : ISO_ACCESS_NO_PAIR);
    }
}

/* An escort is examined; a companion whom nobody needs is not. The classes are for two people only.
 */
static void test_escort(void **state)
{
    (void)state;
    rig.credentials[RIG_ANNA].needs_escort = true;
    assert_true(decide().companion_wanted);
    with_ben();
    assert_int_equal(decide().outcome, ISO_ACCESS_ALLOW);
    rig.credentials[RIG_ANNA].two_person_class = rig.credentials[RIG_BEN].two_person_class = 1;
    assert_int_equal(decide().outcome, ISO_ACCESS_ALLOW);
    rig.credentials[RIG_BEN].enabled = false;
    assert_int_equal(decide().reason, ISO_ACCESS_NOT_ENABLED);
    assert_true(decide().of_companion);
    rig.credentials[RIG_ANNA].needs_escort = false;
    assert_int_equal(decide().outcome, ISO_ACCESS_ALLOW);
}

static void test_soft_passback_of_two(void **state)
{
    (void)state;
    policy_rig_ask(&rig, RIG_ALWAYS, RIG_FACE, true);
    rig.access_points[RIG_ENTRY].antipassback = ISO_ANTIPASSBACK_SOFT;
    rig.presences[RIG_BEN] = (struct iso_presence){.known = true, .area = RIG_LAB};
    with_ben();
    assert_false(decide().passback);
    assert_true(decide().companion_passback);
    rig.presences[RIG_ANNA] = rig.presences[RIG_BEN];
    assert_true(decide().passback);
    rig.credentials[RIG_BEN].enabled = false; /* refused: nothing happened in spite of anything */
    assert_false(decide().passback || decide().companion_passback);
    rig.access_points[RIG_ENTRY].antipassback = ISO_ANTIPASSBACK_HARD;
    rig.credentials[RIG_BEN].enabled = true;
    rig.presences[RIG_ANNA].known = false;
    assert_int_equal(decide().reason, ISO_ACCESS_ANTIPASSBACK);
    assert_true(decide().of_companion);
}

/* The duress PIN opens like the PIN, and is reported whatever happens. */
static void test_duress(void **state)
{
    (void)state;
    rig.authentication.default_level = RIG_CARD_PIN;
    request.shown = (struct iso_shown){.matched = C, .pin = RIG_DURESS_PIN};
    assert_int_equal(decide().outcome, ISO_ACCESS_ALLOW);
    assert_true(decide().duress);
    request.shown.matched = 0;
    assert_int_equal(decide().outcome, ISO_ACCESS_WANT);
    assert_true(decide().duress);
    rig.credentials[RIG_ANNA].enabled = false;
    assert_true(decide().duress);
    rig.access_points[RIG_ENTRY].enabled = false;
    assert_true(decide().duress);
    request.shown.pin = RIG_PIN;
    assert_false(decide().duress);
    rig.credentials[RIG_ANNA].duress_pin = 0; /* no duress PIN, and no PIN entered */
    request.shown.pin = 0;
    assert_false(decide().duress);
    with_ben();
    request.companion_shown.pin = RIG_DURESS_PIN;
    assert_true(decide().duress);
}

static void test_names_of_reasons(void **state)
{
    (void)state;
    for (int r = 0; r < ISO_ACCESS_REASONS; r++) {
        assert_non_null(iso_access_reason_name((enum iso_access_reason)r));
        for (int k = 0; k < r; k++) {
            assert_string_not_equal(iso_access_reason_name((enum iso_access_reason)r),
                                    iso_access_reason_name((enum iso_access_reason)k));
        }
    }
    assert_null(iso_access_reason_name(ISO_ACCESS_REASONS));
    assert_string_equal(iso_access_reason_name(ISO_ACCESS_NOT_AT_THIS_TIME),
                        "NotPermittedAtThisTime");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(test_all_zero_is_deny, setup),
        cmocka_unit_test_setup(test_indices_of_the_request_may_be_anything, setup),
        cmocka_unit_test_setup(test_what_is_shown, setup),
        cmocka_unit_test_setup(test_levels_by_schedule, setup),
        cmocka_unit_test_setup(test_the_highest_priority_wins, setup),
        cmocka_unit_test_setup(test_access_policies_are_a_union, setup),
        cmocka_unit_test_setup(test_validity_ends_before_its_end, setup),
        cmocka_unit_test_setup(test_antipassback, setup),
        cmocka_unit_test_setup(test_a_walk_through_the_areas, setup),
        cmocka_unit_test_setup(test_two_people, setup),
        cmocka_unit_test_setup(test_escort, setup),
        cmocka_unit_test_setup(test_soft_passback_of_two, setup),
        cmocka_unit_test_setup(test_duress, setup),
        cmocka_unit_test_setup(test_names_of_reasons, setup),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
