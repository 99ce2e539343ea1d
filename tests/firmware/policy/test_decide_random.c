/* A million decisions of random policies, compared with the reference (reference.h). Under the
 * sanitizers there are fewer. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/policy/calendar.h"
#include "firmware/policy/validate.h"
#include "tests/firmware/policy/reference.h"
#include "tests/firmware/policy/zone_rig.h"

#if defined(__SANITIZE_ADDRESS__)
enum { POLICIES = 10000 };
#else
enum { POLICIES = 1000000 };
#endif
enum {
    REQUESTS = 4,
    ZONES = 2,
    GROUPS = 3,
    SCHEDULES = 4,
    AREAS = 3,
    LEVELS = 5,
    AUTHENTICATIONS = 2,
    POINTS = 3,
    PROFILES = 3,
    CREDENTIALS = 4,
    DAYS = 20, /* of the times of requests, around a change of the clock */
};

static const struct {
    const char *name;
    int year, month, day; /* the clock changes on one of the next DAYS days */
} places[] = {
    {"Europe/Berlin", 2026, 10, 15},      {"Europe/Berlin", 2027, 3, 20},
    {"Australia/Lord_Howe", 2026, 9, 25}, {"America/Santiago", 2027, 4, 1},
    {"Asia/Almaty", 2024, 2, 20},
};
enum { PLACES = sizeof places / sizeof *places };

static struct world {
    struct iso_zone zones[ZONES];
    struct iso_special_day_group groups[GROUPS];
    struct iso_schedule schedules[SCHEDULES];
    struct iso_area areas[AREAS];
    struct iso_security_level levels[LEVELS];
    struct iso_authentication_profile authentications[AUTHENTICATIONS];
    struct iso_access_point points[POINTS];
    struct iso_access_profile profiles[PROFILES];
    struct iso_credential credentials[CREDENTIALS];
    struct iso_presence presences[CREDENTIALS];
} w;

static const struct iso_policy policy = {.zones = w.zones,
                                         .groups = w.groups,
                                         .schedules = w.schedules,
                                         .areas = w.areas,
                                         .levels = w.levels,
                                         .authentication_profiles = w.authentications,
                                         .access_points = w.points,
                                         .access_profiles = w.profiles,
                                         .credentials = w.credentials,
                                         .n_zones = ZONES,
                                         .n_groups = GROUPS,
                                         .n_schedules = SCHEDULES,
                                         .n_areas = AREAS,
                                         .n_levels = LEVELS,
                                         .n_authentication_profiles = AUTHENTICATIONS,
                                         .n_access_points = POINTS,
                                         .n_access_profiles = PROFILES,
                                         .n_credentials = CREDENTIALS};
static struct iso_occupancy occupancy = {.presences = w.presences};
static int64_t first_s; /* of the times of requests */
static uint64_t state_bits;

static uint32_t draw(uint32_t n)
{
    state_bits = state_bits * 6364136223846793005U + 1442695040888963407U;
    return (uint32_t)(state_bits >> 33) % n;
}

static bool chance(uint32_t percent)
{
    return draw(100) < percent;
}

static int64_t draw_time(void)
{
    return first_s + draw(DAYS * ISO_DAY_S);
}

static void draw_hours(struct iso_day_hours *hours)
{
    int minute = 0;
    hours->n = 0;
    while (hours->n < ISO_PERIODS_MAX && chance(70)) {
        const int from = minute + (int)draw(300), to = from + 1 + (int)draw(600);
        if (to > ISO_DAY_MINUTES) {
            break;
        }
        hours->periods[hours->n++] = (struct iso_period){(uint16_t)from, (uint16_t)to};
        minute = to;
    }
    if (hours->n == 0 && chance(60)) {
        *hours = (struct iso_day_hours){.n = 1, .periods = {{0, ISO_DAY_MINUTES}}};
    }
}

static void draw_times(void)
{
    const int32_t first_day = (int32_t)(first_s / ISO_DAY_S);
    for (int g = 0; g < GROUPS; g++) {
        w.groups[g].n = 0;
        for (int32_t d = -1; d <= DAYS; d++) {
            if (chance(25)) {
                w.groups[g].days[w.groups[g].n++] = first_day + d;
            }
        }
    }
    for (int s = 0; s < SCHEDULES; s++) {
        struct iso_schedule *schedule = &w.schedules[s];
        schedule->zone = (uint16_t)draw(ZONES);
        for (int day = 0; day < ISO_WEEKDAYS; day++) {
            draw_hours(&schedule->weekly[day]);
        }
        schedule->n_special = (uint8_t)draw(GROUPS + 1);
        const uint32_t shift = draw(GROUPS);
        for (uint32_t i = 0; i < schedule->n_special; i++) {
            schedule->special[i].group = (uint16_t)((i + shift) % GROUPS);
            draw_hours(&schedule->special[i].hours);
        }
    }
}

static void draw_levels(void)
{
    for (int l = 0; l < LEVELS; l++) {
        struct iso_security_level *level = &w.levels[l];
        level->priority = (int32_t)draw(1000) * LEVELS + l - 2000;
        level->open = chance(5);
        level->n_groups = level->open ? 0 : (uint8_t)draw(ISO_RECOGNITION_GROUPS_MAX + 1);
        for (int g = 0; g < level->n_groups; g++) {
            level->groups[g] = (uint8_t)(chance(60) ? 1U << draw(3)
                                                    : 1 + draw(ISO_RECOGNITION_ALL));
        }
    }
    for (int a = 0; a < AUTHENTICATIONS; a++) {
        struct iso_authentication_profile *profile = &w.authentications[a];
        profile->default_level = (uint16_t)draw(LEVELS);
        profile->n_policies = (uint8_t)draw(4);
        for (int p = 0; p < profile->n_policies; p++) {
            profile->policies[p].schedule = (uint16_t)draw(SCHEDULES);
            for (int s = 0; s < ISO_SCHEDULE_STATES; s++) {
                profile->policies[p].constraints[s] = (struct iso_level_constraint){
                    .level = chance(50) ? (uint16_t)ISO_INDEX_NONE : (uint16_t)draw(LEVELS),
                    .dual = chance(40)};
            }
        }
    }
}

static void draw_places(void)
{
    for (int p = 0; p < POINTS; p++) {
        struct iso_access_point *point = &w.points[p];
        point->enabled = chance(95);
        point->from = chance(30) ? (uint16_t)ISO_INDEX_NONE : (uint16_t)draw(AREAS);
        point->to = (uint16_t)draw(AREAS);
        if (point->to == point->from) {
            point->to = (uint16_t)((point->to + 1) % AREAS);
        }
        point->authentication_profile = (uint16_t)draw(AUTHENTICATIONS);
        point->antipassback = (uint8_t)draw(4);
        point->antipassback_s = point->antipassback == ISO_ANTIPASSBACK_TIMED
                                    ? 1 + (int32_t)draw(900000)
                                    : 0;
        if (point->antipassback == ISO_ANTIPASSBACK_NONE && chance(30)) {
            point->to = ISO_INDEX_NONE;
        }
    }
    for (int p = 0; p < PROFILES; p++) {
        w.profiles[p].n_policies = (uint8_t)(1 + draw(8));
        for (int i = 0; i < w.profiles[p].n_policies; i++) {
            w.profiles[p].policies[i] = (struct iso_access_policy){(uint16_t)draw(POINTS),
                                                                   (uint16_t)draw(SCHEDULES)};
        }
    }
}

static iso_pin draw_pin(void)
{
    return 10000 + draw(3);
}

static void draw_people(void)
{
    for (int c = 0; c < CREDENTIALS; c++) {
        struct iso_credential *credential = &w.credentials[c];
        const struct iso_credential old = *credential;
        *credential = (struct iso_credential){
            .enabled = chance(95),
            .no_antipassback = chance(20),
            .needs_escort = chance(20),
            .two_person_class = (uint8_t)draw(3),
            .identifiers = (uint8_t)(chance(60) ? ISO_RECOGNITION_ALL : 1 + draw(7)),
            .n_profiles = (uint8_t)(chance(3) ? 0 : 2 + draw(3))};
        memcpy(credential->token, old.token, sizeof old.token);
        if (credential->identifiers & ISO_RECOGNITION_PIN) {
            credential->pin = draw_pin();
            credential->duress_pin = chance(50) ? draw_pin() : 0;
            credential->duress_pin *= credential->duress_pin != credential->pin;
        }
        credential->valid_from_s = chance(8) ? draw_time() : 0;
        credential->valid_to_s = chance(8) ? draw_time() : 0;
        if (credential->valid_to_s <= credential->valid_from_s) {
            credential->valid_to_s = 0;
        }
        for (int p = 0; p < credential->n_profiles; p++) {
            credential->profiles[p] = (uint16_t)draw(PROFILES);
        }
        w.presences[c] = (struct iso_presence){chance(70), (uint16_t)draw(AREAS),
                                               draw_time() - 300000};
    }
    occupancy.n = chance(95) ? CREDENTIALS : 0;
}

static struct iso_shown draw_shown(uint32_t credential)
{
    const struct iso_credential *c = &w.credentials[credential % CREDENTIALS];
    struct iso_shown shown = {.matched = c->identifiers & (uint8_t)draw(8)};
    if (chance(60)) {
        shown.matched = c->identifiers;
    }
    if (chance(5)) {
        shown.matched = (uint8_t)draw(8);
    }
    shown.differed = chance(4) ? (uint8_t)(1 + draw(3)) : 0;
    shown.pin = chance(50) ? c->pin : chance(30) ? draw_pin() : 0;
    return shown;
}

static struct iso_access_request draw_request(void)
{
    struct iso_access_request request = {
        .access_point = (uint16_t)(chance(99) ? draw(POINTS) : draw(70000)),
        .credential = chance(98) ? draw(CREDENTIALS) : ISO_CREDENTIAL_NONE - draw(2),
        .companion = chance(60) ? draw(CREDENTIALS) : ISO_CREDENTIAL_NONE - draw(2),
        .time_s = draw_time(),
    };
    request.shown = draw_shown(request.credential);
    request.companion_shown = draw_shown(request.companion);
    return request;
}

static int64_t seen_reason[ISO_ACCESS_REASONS], seen_outcome[3], seen_flags[6];

static void count(const struct iso_access *access)
{
    seen_outcome[access->outcome]++;
    seen_reason[access->reason] += access->outcome == ISO_ACCESS_DENY;
    seen_flags[0] += access->companion_wanted;
    seen_flags[1] += access->of_companion && access->outcome == ISO_ACCESS_WANT;
    seen_flags[2] += access->of_companion && access->outcome == ISO_ACCESS_DENY;
    seen_flags[3] += access->duress;
    seen_flags[4] += access->passback;
    seen_flags[5] += access->companion_passback;
}

static void compare(int number)
{
    const struct iso_access_request request = draw_request();
    const struct iso_access got = iso_access_decide(&policy, &occupancy, &request);
    const struct iso_access expected = reference_decide(&policy, &occupancy, &request);
    const bool same = got.outcome == expected.outcome && got.reason == expected.reason &&
                      got.companion_wanted == expected.companion_wanted &&
                      got.of_companion == expected.of_companion && got.duress == expected.duress &&
                      got.passback == expected.passback &&
                      got.companion_passback == expected.companion_passback &&
                      got.has_level == expected.has_level && got.level == expected.level;
    const uint32_t who = got.of_companion ? request.companion : request.credential;
    const struct iso_shown *shown = got.of_companion ? &request.companion_shown : &request.shown;
    const bool wants = got.outcome == ISO_ACCESS_WANT && !got.companion_wanted;
    const bool right = wants ? reference_wanted_is_right(&policy, got.level, who, shown, got.wanted)
                             : got.wanted == 0;
    if (!same || !right) {
        fail_msg("policy %d, access point %u, credential %u: outcome %d %s, level %u, wanted %d; "
                 "the reference says %d %s, level %u",
                 number, request.access_point, request.credential, got.outcome,
                 iso_access_reason_name(got.reason), got.level, got.wanted, expected.outcome,
                 iso_access_reason_name(expected.reason), expected.level);
    }
    count(&got);
}

static void go_to(int place)
{
    zone_rig_read(places[place].name, &w.zones[0]);
    zone_rig_fixed(20700, &w.zones[1]); /* 5:45 */
    first_s = iso_calendar_day(places[place].year, places[place].month, places[place].day) *
              ISO_DAY_S;
    char variable[80];
    (void)snprintf(variable, sizeof variable, ":%s", places[place].name);
    assert_int_equal(setenv("TZ", variable, 1), 0);
    tzset();
}

static void name_records(void)
{
    for (int i = 0; i < 5; i++) {
        char *const tokens[] = {
            w.groups[i % GROUPS].token,     w.schedules[i % SCHEDULES].token,
            w.areas[i % AREAS].token,       w.levels[i % LEVELS].token,
            w.points[i % POINTS].token,     w.authentications[i % AUTHENTICATIONS].token,
            w.profiles[i % PROFILES].token, w.credentials[i % CREDENTIALS].token};
        for (size_t t = 0; t < sizeof tokens / sizeof *tokens; t++) {
            (void)strcpy(tokens[t], "x");
        }
    }
}

static void test_random_policies(void **state)
{
    (void)state;
    state_bits = 19;
    name_records();
    for (int i = 0; i < POLICIES; i++) {
        if (i % (POLICIES / PLACES) == 0) {
            go_to(i / (POLICIES / PLACES));
        }
        draw_times();
        draw_levels();
        draw_places();
        draw_people();
        struct iso_fault fault = {0};
        if (iso_policy_validate(&policy, &fault) != 0) {
            fail_msg("policy %d: %s", i, fault.text);
        }
        for (int r = 0; r < REQUESTS; r++) {
            compare(i);
        }
    }
    for (int r = 0; r <= ISO_ACCESS_NO_PAIR; r++) { /* the others are not of the policy */
        print_message("%9lld %s\n", (long long)seen_reason[r],
                      iso_access_reason_name((enum iso_access_reason)r));
        assert_true(seen_reason[r] > POLICIES / 1000);
    }
    print_message("%9lld allowed, %lld more wanted\n", (long long)seen_outcome[ISO_ACCESS_ALLOW],
                  (long long)seen_outcome[ISO_ACCESS_WANT]);
    static const char *const flags[6] = {"second person wanted",
                                         "more of the second person wanted",
                                         "second person refused",
                                         "duress",
                                         "passback",
                                         "passback of the second person"};
    for (int f = 0; f < 6; f++) {
        print_message("%9lld %s\n", (long long)seen_flags[f], flags[f]);
        assert_true(seen_flags[f] > POLICIES / 1000);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_random_policies),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
