#include "tests/firmware/policy/policy_rig.h"

#include <stdio.h>
#include <string.h>

#include "firmware/policy/calendar.h"
#include "tests/firmware/policy/zone_rig.h"

static void name(char token[ISO_TOKEN_SIZE], const char *text)
{
    (void)snprintf(token, ISO_TOKEN_SIZE, "%s", text);
}

static void init_times(struct policy_rig *rig)
{
    zone_rig_fixed(0, &rig->zone);
    name(rig->group.token, "holidays");
    rig->group.n = 1;
    rig->group.days[0] = (int32_t)iso_calendar_day(2026, 12, 25);
    static const char *const names[] = {"always", "never", "office"};
    for (int i = 0; i < RIG_SCHEDULES; i++) {
        name(rig->schedules[i].token, names[i]);
    }
    for (int day = 0; day < ISO_WEEKDAYS; day++) {
        rig->schedules[RIG_ALWAYS].weekly[day] = (struct iso_day_hours){
            .n = 1, .periods = {{0, ISO_DAY_MINUTES}}};
        if (day >= 1 && day <= 5) {
            rig->schedules[RIG_OFFICE].weekly[day] = (struct iso_day_hours){
                .n = 1, .periods = {{8 * 60, 17 * 60}}};
        }
    }
}

static void init_levels(struct policy_rig *rig)
{
    static const struct iso_security_level levels[RIG_LEVELS] = {
        [RIG_FACE] = {"face", false, 1, 1, {ISO_RECOGNITION_FACE}},
        [RIG_CARD_PIN] = {"card-pin", false, 5, 1, {ISO_RECOGNITION_CARD | ISO_RECOGNITION_PIN}},
        [RIG_FACE_OR_CARD] = {"face-or-card",
                              false,
                              3,
                              2,
                              {ISO_RECOGNITION_FACE, ISO_RECOGNITION_CARD | ISO_RECOGNITION_PIN}},
        [RIG_CLOSED] = {.token = "closed", .priority = 90},
        [RIG_OPEN] = {.token = "open", .priority = 100, .open = true},
    };
    memcpy(rig->levels, levels, sizeof levels);
    name(rig->authentication.token, "doors");
    rig->authentication.default_level = RIG_FACE;
}

static void init_places(struct policy_rig *rig)
{
    name(rig->areas[RIG_OUTSIDE].token, "outside");
    name(rig->areas[RIG_INSIDE].token, "inside");
    name(rig->areas[RIG_LAB].token, "lab");
    static const struct iso_access_point points[RIG_ACCESS_POINTS] = {
        [RIG_ENTRY] = {"entry", true, RIG_OUTSIDE, RIG_INSIDE, 0, ISO_ANTIPASSBACK_NONE, 0},
        [RIG_EXIT] = {"exit", true, RIG_INSIDE, RIG_OUTSIDE, 0, ISO_ANTIPASSBACK_NONE, 0},
        [RIG_LAB_DOOR] = {"lab-door", true, ISO_INDEX_NONE, RIG_LAB, 0, ISO_ANTIPASSBACK_NONE, 0},
    };
    memcpy(rig->access_points, points, sizeof points);
}

static void init_people(struct policy_rig *rig)
{
    static const char *const names[] = {"anna", "ben", "carl"};
    name(rig->access_profiles[RIG_STAFF].token, "staff");
    rig->access_profiles[RIG_STAFF].n_policies = RIG_ACCESS_POINTS;
    for (uint16_t i = 0; i < RIG_ACCESS_POINTS; i++) {
        rig->access_profiles[RIG_STAFF].policies[i] = (struct iso_access_policy){
            .access_point = i, .schedule = RIG_ALWAYS};
    }
    for (int i = 0; i < RIG_CREDENTIALS; i++) {
        rig->credentials[i] = (struct iso_credential){.enabled = true,
                                                      .identifiers = ISO_RECOGNITION_ALL,
                                                      .pin = RIG_PIN,
                                                      .duress_pin = RIG_DURESS_PIN,
                                                      .n_profiles = 1,
                                                      .profiles = {RIG_STAFF}};
        name(rig->credentials[i].token, names[i]);
    }
}

void policy_rig_init(struct policy_rig *rig)
{
    memset(rig, 0, sizeof *rig);
    init_times(rig);
    init_levels(rig);
    init_places(rig);
    init_people(rig);
    rig->policy = (struct iso_policy){.zones = &rig->zone,
                                      .groups = &rig->group,
                                      .schedules = rig->schedules,
                                      .areas = rig->areas,
                                      .levels = rig->levels,
                                      .authentication_profiles = &rig->authentication,
                                      .access_points = rig->access_points,
                                      .access_profiles = rig->access_profiles,
                                      .credentials = rig->credentials,
                                      .n_zones = 1,
                                      .n_groups = 1,
                                      .n_schedules = RIG_SCHEDULES,
                                      .n_areas = RIG_AREAS,
                                      .n_levels = RIG_LEVELS,
                                      .n_authentication_profiles = 1,
                                      .n_access_points = RIG_ACCESS_POINTS,
                                      .n_access_profiles = RIG_ACCESS_PROFILES,
                                      .n_credentials = RIG_CREDENTIALS};
    rig->occupancy = (struct iso_occupancy){.presences = rig->presences, .n = RIG_CREDENTIALS};
}

void policy_rig_ask(struct policy_rig *rig, uint16_t schedule, uint16_t level, bool dual)
{
    struct iso_authentication_policy *added =
        &rig->authentication.policies[rig->authentication.n_policies++];
    added->schedule = schedule;
    for (int s = 0; s < ISO_SCHEDULE_STATES; s++) {
        const bool active = s == ISO_SCHEDULE_ACTIVE || s == ISO_SCHEDULE_SPECIAL_ACTIVE;
        added->constraints[s] = (struct iso_level_constraint){
            .level = active ? level : (uint16_t)ISO_INDEX_NONE, .dual = active && dual};
    }
}

struct iso_access_request policy_rig_request(void)
{
    return (struct iso_access_request){.access_point = RIG_ENTRY,
                                       .credential = RIG_ANNA,
                                       .shown = {.matched = ISO_RECOGNITION_FACE},
                                       .companion = ISO_CREDENTIAL_NONE,
                                       .time_s = RIG_NOON_S};
}

struct iso_access policy_rig_decide(const struct policy_rig *rig,
                                    const struct iso_access_request *request)
{
    return iso_access_decide(&rig->policy, &rig->occupancy, request);
}
