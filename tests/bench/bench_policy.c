/* Measures how long a decision of the policy takes with 100,000 credentials, 1,000 schedules and
 * 500 access points: for usual records, and for records that are as large as they can be while no
 * access policy permits. Also the examination of such a policy, and its memory. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "firmware/policy/calendar.h"
#include "firmware/policy/check.h"
#include "firmware/policy/decide.h"
#include "firmware/policy/validate.h"
#include "sim/lab/match/latency.h"
#include "tests/bench/machine.h"

enum {
    CREDENTIALS = 100000,
    SCHEDULES = 1000,
    POINTS = 500,
    PROFILES = 2000,
    ZONES = 4,
    GROUPS = 50,
    LEVELS = 4,
    ROUNDS = 200000,
};

static struct world {
    struct iso_zone zones[ZONES];
    struct iso_special_day_group groups[GROUPS];
    struct iso_schedule schedules[SCHEDULES];
    struct iso_area areas[2];
    struct iso_security_level levels[LEVELS];
    struct iso_authentication_profile authentications[1];
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
                                         .n_areas = 2,
                                         .n_levels = LEVELS,
                                         .n_authentication_profiles = 1,
                                         .n_access_points = POINTS,
                                         .n_access_profiles = PROFILES,
                                         .n_credentials = CREDENTIALS};
static const struct iso_occupancy occupancy = {.presences = w.presences, .n = CREDENTIALS};
static const int64_t now_s = 1795608000; /* 2026-11-25 12:00 UTC */
static uint64_t bits = 5;

static uint32_t draw(uint32_t n)
{
    bits = bits * 6364136223846793005U + 1442695040888963407U;
    return (uint32_t)(bits >> 33) % n;
}

static void name(char token[ISO_TOKEN_SIZE], const char *kind, unsigned number)
{
    (void)snprintf(token, ISO_TOKEN_SIZE, "%s-%u", kind, number);
}

/* Hours of a day in n periods of an hour and a half, which do not have the minute of now. */
static struct iso_day_hours hours_of(int n)
{
    struct iso_day_hours hours = {.n = (uint8_t)n};
    for (int i = 0; i < n; i++) {
        hours.periods[i] = (struct iso_period){(uint16_t)(i * 90), (uint16_t)(i * 90 + 80)};
    }
    return hours;
}

static void make_zones(void)
{
    static const char rule[] = "CET-1CEST,M3.5.0,M10.5.0/3";
    for (unsigned z = 0; z < ZONES; z++) {
        (void)snprintf(w.zones[z].name, ISO_ZONE_NAME_SIZE, "zone-%u", z);
        if (iso_zone_rule_read(rule, strlen(rule), &w.zones[z].rule) != 0) {
            exit(1);
        }
    }
    for (unsigned g = 0; g < GROUPS; g++) {
        name(w.groups[g].token, "group", g);
        w.groups[g].n = ISO_SPECIAL_DAYS_MAX;
        for (int d = 0; d < ISO_SPECIAL_DAYS_MAX; d++) {
            w.groups[g].days[d] = (int32_t)(now_s / ISO_DAY_S) + 1 + d * 7;
        }
    }
}

static void make_schedules(bool large)
{
    for (unsigned s = 0; s < SCHEDULES; s++) {
        struct iso_schedule *schedule = &w.schedules[s];
        name(schedule->token, "schedule", s);
        schedule->zone = (uint16_t)(s % ZONES);
        for (int day = 0; day < ISO_WEEKDAYS; day++) {
            schedule->weekly[day] = large ? hours_of(ISO_PERIODS_MAX)
                                          : (struct iso_day_hours){2, {{450, 720}, {750, 1080}}};
        }
        schedule->n_special = large ? ISO_SPECIAL_SCHEDULES_MAX : 2;
        for (unsigned i = 0; i < schedule->n_special; i++) {
            schedule->special[i].group = (uint16_t)((s + i) % GROUPS);
        }
    }
}

static void make_places(bool large)
{
    static const uint8_t groups[LEVELS] = {
        ISO_RECOGNITION_FACE, ISO_RECOGNITION_FACE | ISO_RECOGNITION_PIN,
        ISO_RECOGNITION_CARD | ISO_RECOGNITION_PIN, ISO_RECOGNITION_ALL};
    for (unsigned l = 0; l < LEVELS; l++) {
        name(w.levels[l].token, "level", l);
        w.levels[l].priority = (int32_t)l;
        w.levels[l].n_groups = 1;
        w.levels[l].groups[0] = groups[l];
    }
    name(w.authentications[0].token, "doors", 0);
    w.authentications[0].n_policies = large ? ISO_AUTHENTICATION_POLICIES_MAX : 2;
    for (unsigned p = 0; p < w.authentications[0].n_policies; p++) {
        w.authentications[0].policies[p].schedule = (uint16_t)(p * 7);
        for (unsigned s = 0; s < ISO_SCHEDULE_STATES; s++) {
            w.authentications[0].policies[p].constraints[s].level = s == 1 ? 0 : ISO_INDEX_NONE;
        }
    }
    name(w.areas[0].token, "area", 0);
    name(w.areas[1].token, "area", 1);
    for (unsigned p = 0; p < POINTS; p++) {
        name(w.points[p].token, "point", p);
        w.points[p].enabled = true;
        w.points[p].to = 1;
        w.points[p].antipassback = ISO_ANTIPASSBACK_HARD;
    }
}

static void make_people(bool large)
{
    for (unsigned p = 0; p < PROFILES; p++) {
        name(w.profiles[p].token, "profile", p);
        w.profiles[p].n_policies = large ? ISO_ACCESS_POLICIES_MAX : 10;
        for (unsigned i = 0; i < w.profiles[p].n_policies; i++) {
            w.profiles[p].policies[i] = (struct iso_access_policy){
                (uint16_t)(large ? 0 : draw(POINTS)), (uint16_t)draw(SCHEDULES)};
        }
    }
    for (unsigned c = 0; c < CREDENTIALS; c++) {
        struct iso_credential *credential = &w.credentials[c];
        name(credential->token, "credential", c);
        credential->enabled = true;
        credential->identifiers = ISO_RECOGNITION_ALL;
        credential->pin = 14711;
        credential->n_profiles = large ? ISO_CREDENTIAL_PROFILES_MAX : 2;
        for (unsigned p = 0; p < credential->n_profiles; p++) {
            credential->profiles[p] = (uint16_t)draw(PROFILES);
        }
    }
}

/* Half of the requests are for an access point that the person has an access policy for. */
static struct iso_access_request draw_request(bool large)
{
    struct iso_access_request request = {.access_point = large ? 0 : (uint16_t)draw(POINTS),
                                         .credential = draw(CREDENTIALS),
                                         .shown.matched = ISO_RECOGNITION_FACE,
                                         .companion = ISO_CREDENTIAL_NONE,
                                         .time_s = now_s};
    if (!large && draw(2) == 0) {
        const struct iso_access_profile *profile =
            &w.profiles[w.credentials[request.credential].profiles[0]];
        request.access_point = profile->policies[draw(profile->n_policies)].access_point;
    }
    return request;
}

static void measure(bool large)
{
    static int64_t times_ns[ROUNDS];
    int allowed = 0;
    for (int i = 0; i < ROUNDS; i++) {
        const struct iso_access_request request = draw_request(large);
        const int64_t start_ns = sim_wall_ns(NULL);
        const struct iso_access access = iso_access_decide(&policy, &occupancy, &request);
        times_ns[i] = sim_wall_ns(NULL) - start_ns;
        allowed += access.outcome == ISO_ACCESS_ALLOW;
    }
    const struct sim_latency summary = sim_latency_of(times_ns, ROUNDS);
    printf("%-8s a decision: median %.2f us, 95 of 100 within %.2f us; %d %% allowed\n",
           large ? "largest" : "usual", summary.median_ms * 1000, summary.p95_ms * 1000,
           allowed * 100 / ROUNDS);
}

static int examine(void)
{
    struct iso_fault fault = {0};
    const int64_t start_ns = sim_wall_ns(NULL);
    if (iso_policy_validate(&policy, &fault) != 0) {
        fprintf(stderr, "%s\n", fault.text);
        return 1;
    }
    const int64_t valid_ns = sim_wall_ns(NULL);
    const size_t n = iso_policy_check(&policy, now_s, NULL, 0);
    printf("         validation %.1f ms, check %.1f ms (%zu findings)\n",
           (double)(valid_ns - start_ns) / 1e6, (double)(sim_wall_ns(NULL) - valid_ns) / 1e6, n);
    return 0;
}

int main(void)
{
    bench_print_machine();
    printf("%d credentials, %d schedules, %d access points: %.1f MB\n", CREDENTIALS, SCHEDULES,
           POINTS, (double)sizeof w / 1e6);
    for (int large = 0; large <= 1; large++) {
        make_zones();
        make_schedules(large);
        make_places(large);
        make_people(large);
        measure(large);
        if (examine() != 0) {
            return 1;
        }
    }
    return 0;
}
