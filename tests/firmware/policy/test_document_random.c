/* Random policies, written as documents by this test with everything that may be written in several
 * ways: the reader finds the same policy, and what the writer makes of it is read as the same
 * again. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/policy/calendar.h"
#include "firmware/policy/validate.h"
#include "tests/firmware/policy/document_rig.h"
#include "tests/firmware/policy/document_text.h"
#include "tests/firmware/policy/zone_rig.h"

#if defined(__SANITIZE_ADDRESS__)
enum { POLICIES = 500 };
#else
enum { POLICIES = 5000 };
#endif
enum { MAX = 5 }; /* records of each kind */

static struct world {
    struct iso_zone zones[3];
    struct iso_special_day_group groups[MAX];
    struct iso_schedule schedules[MAX];
    struct iso_area areas[MAX];
    struct iso_security_level levels[MAX];
    struct iso_authentication_profile authentications[MAX];
    struct iso_access_point points[MAX];
    struct iso_access_profile profiles[MAX];
    struct iso_policy policy;
} w;

static uint32_t draw(uint32_t n)
{
    return document_text_draw(n);
}

static bool chance(uint32_t percent)
{
    return draw(100) < percent;
}

/* ---- a policy ---- */

static uint16_t draw_index(uint16_t n, bool or_none)
{
    return n == 0 || (or_none && chance(40)) ? (uint16_t)ISO_INDEX_NONE : (uint16_t)draw(n);
}

static void draw_token(char token[ISO_TOKEN_SIZE], int number)
{
    static const char *const parts[] = {"a", " ", "\"", "\\", "/", "\u00e4", "\u20ac", "Z"};
    (void)snprintf(token, ISO_TOKEN_SIZE, "%d", number);
    while (strlen(token) < 60 && chance(60)) {
        (void)strcat(token, parts[draw(8)]);
    }
}

static void draw_hours(struct iso_day_hours *hours)
{
    int minute = 0;
    while (hours->n < ISO_PERIODS_MAX && chance(60)) {
        const int from = minute + (int)draw(300), to = from + 1 + (int)draw(600);
        if (from >= ISO_DAY_MINUTES) {
            break;
        }
        minute = to < ISO_DAY_MINUTES ? to : ISO_DAY_MINUTES;
        hours->periods[hours->n++] = (struct iso_period){(uint16_t)from, (uint16_t)minute};
    }
}

static void draw_times(void)
{
    w.policy.n_groups = (uint16_t)draw(MAX + 1);
    for (int g = 0; g < w.policy.n_groups; g++) {
        int32_t day = (int32_t)draw(40000);
        draw_token(w.groups[g].token, g);
        while (w.groups[g].n < ISO_SPECIAL_DAYS_MAX && chance(90)) {
            w.groups[g].days[w.groups[g].n++] = day;
            day += 1 + (int32_t)draw(50);
        }
    }
    w.policy.n_schedules = (uint16_t)draw(MAX + 1);
    for (int s = 0; s < w.policy.n_schedules; s++) {
        struct iso_schedule *schedule = &w.schedules[s];
        draw_token(schedule->token, s);
        schedule->zone = (uint16_t)draw(3);
        for (int day = 0; day < ISO_WEEKDAYS; day++) {
            if (day > 0 && chance(50)) {
                schedule->weekly[day] = schedule->weekly[day - 1];
            } else {
                draw_hours(&schedule->weekly[day]);
            }
        }
        schedule->n_special = (uint8_t)draw(w.policy.n_groups + 1U);
        for (int i = 0; i < schedule->n_special; i++) {
            schedule->special[i].group = (uint16_t)((i + s) % w.policy.n_groups);
            draw_hours(&schedule->special[i].hours);
        }
    }
}

static void draw_authentication(struct iso_authentication_profile *profile)
{
    profile->default_level = draw_index(w.policy.n_levels, false);
    profile->n_policies = w.policy.n_schedules > 0 ? (uint8_t)draw(4) : 0;
    for (int p = 0; p < profile->n_policies; p++) {
        profile->policies[p].schedule = draw_index(w.policy.n_schedules, false);
        for (int s = 0; s < ISO_SCHEDULE_STATES; s++) {
            const uint16_t level = draw_index(w.policy.n_levels, true);
            profile->policies[p].constraints[s] = (struct iso_level_constraint){
                level, level != ISO_INDEX_NONE && chance(40)};
        }
    }
}

static void draw_levels(void)
{
    w.policy.n_levels = (uint16_t)draw(MAX + 1);
    for (int l = 0; l < w.policy.n_levels; l++) {
        struct iso_security_level *level = &w.levels[l];
        draw_token(level->token, l);
        level->priority = chance(30) ? l + 1 : (int32_t)draw(1000) * MAX + l - 3000;
        for (int k = 0; k < l; k++) {
            level->priority += level->priority == w.levels[k].priority ? 100000 * l : 0;
        }
        level->open = chance(20);
        level->n_groups = level->open ? 0 : (uint8_t)draw(ISO_RECOGNITION_GROUPS_MAX + 1);
        for (int g = 0; g < level->n_groups; g++) {
            level->groups[g] = (uint8_t)(1 + draw(ISO_RECOGNITION_ALL));
        }
    }
    w.policy.n_authentication_profiles = w.policy.n_levels > 0 ? (uint16_t)draw(MAX + 1) : 0;
    for (int a = 0; a < w.policy.n_authentication_profiles; a++) {
        draw_token(w.authentications[a].token, a);
        draw_authentication(&w.authentications[a]);
    }
}

static void draw_places(void)
{
    w.policy.n_areas = (uint16_t)draw(MAX + 1);
    for (int a = 0; a < w.policy.n_areas; a++) {
        draw_token(w.areas[a].token, a);
    }
    w.policy.n_access_points = w.policy.n_authentication_profiles > 0 ? (uint16_t)draw(MAX + 1) : 0;
    for (int p = 0; p < w.policy.n_access_points; p++) {
        struct iso_access_point *point = &w.points[p];
        draw_token(point->token, p);
        point->enabled = chance(80);
        point->from = draw_index(w.policy.n_areas, true);
        point->to = draw_index(w.policy.n_areas, true);
        point->from = point->from == point->to ? (uint16_t)ISO_INDEX_NONE : point->from;
        point->authentication_profile = draw_index(w.policy.n_authentication_profiles, false);
        point->antipassback = (uint8_t)(point->to == ISO_INDEX_NONE ? 0 : draw(4));
        point->antipassback_s = point->antipassback == ISO_ANTIPASSBACK_TIMED
                                    ? 1 + (int32_t)draw(INT32_MAX)
                                    : 0;
    }
    w.policy.n_access_profiles = (uint16_t)draw(MAX + 1);
    for (int p = 0; p < w.policy.n_access_profiles; p++) {
        struct iso_access_profile *profile = &w.profiles[p];
        draw_token(profile->token, p);
        profile->n_policies = (uint8_t)draw(ISO_ACCESS_POLICIES_MAX + 1);
        if (w.policy.n_access_points == 0 || w.policy.n_schedules == 0) {
            profile->n_policies = 0;
        }
        for (int i = 0; i < profile->n_policies; i++) {
            profile->policies[i] = (struct iso_access_policy){
                draw_index(w.policy.n_access_points, false),
                draw_index(w.policy.n_schedules, false)};
        }
    }
}

static void draw_policy(void)
{
    static const char *const names[] = {"UTC", "Test/East", "Test/West"};
    memset(&w, 0, sizeof w);
    for (int z = 0; z < 3; z++) {
        zone_rig_fixed(0, &w.zones[z]);
        (void)strcpy(w.zones[z].name, names[z]);
    }
    w.policy = (struct iso_policy){.zones = w.zones,
                                   .groups = w.groups,
                                   .schedules = w.schedules,
                                   .areas = w.areas,
                                   .levels = w.levels,
                                   .authentication_profiles = w.authentications,
                                   .access_points = w.points,
                                   .access_profiles = w.profiles,
                                   .n_zones = 3};
    draw_times();
    draw_levels();
    draw_places();
    struct iso_fault fault = {0};
    if (iso_policy_validate(&w.policy, &fault) != 0) {
        fail_msg("%s", fault.text);
    }
}

static int fail_on_change(void *context, const char *kind, const char *token, const char *before,
                          const char *after)
{
    (void)context;
    fail_msg("%s %s: %s -> %s", kind, token, before, after);
    return 0;
}

static void round_trip(void **state)
{
    (void)state;
    for (int i = 0; i < POLICIES; i++) {
        draw_policy();
        const uint16_t default_profile = draw_index(w.policy.n_access_profiles, true);
        char *json = document_text_write(&w.policy, default_profile);
        struct iso_policy_document *document = document_rig_read(json);
        document_rig_assert_equal(iso_policy_document_policy(document), &w.policy);
        assert_int_equal(iso_policy_document_default_profile(document), default_profile);
        char *canonical = document_rig_write(document);
        struct iso_policy_document *again = document_rig_read(canonical);
        document_rig_assert_equal(iso_policy_document_policy(again), &w.policy);
        assert_int_equal(iso_policy_document_default_profile(again), default_profile);
        char *same = document_rig_write(again);
        assert_string_equal(canonical, same);
        assert_int_equal(iso_policy_document_compare(document, again, fail_on_change, NULL), 0);
        for (uint16_t p = 0; p < w.policy.n_access_points; p++) {
            assert_int_equal(iso_policy_document_access_point(document, w.points[p].token), p);
        }
        iso_policy_document_free(document);
        iso_policy_document_free(again);
        free(json);
        free(canonical);
        free(same);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(round_trip)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
