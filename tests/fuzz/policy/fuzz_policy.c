/* Whatever the records of a policy are: they are refused with a line, or a decision and the check
 * can use them. The input changes single bytes of a policy that is right. Each array has a block of
 * its own, so that a sanitizer finds reads beyond it. */
#include <stdlib.h>
#include <string.h>

#include "firmware/policy/check.h"
#include "firmware/policy/decide.h"
#include "firmware/policy/validate.h"
#include "tests/fuzz/fuzz.h"

/* One array of records: how to make them right, and which of their bytes are truth values. */
struct block {
    uint8_t *records;
    size_t size, n;
};

enum { ZONES, GROUPS, SCHEDULES, AREAS, LEVELS, PROFILES, POINTS, ACCESSES, PEOPLE, BLOCKS };

static void *make(struct block *block, const void *record, size_t size, size_t n)
{
    *block = (struct block){malloc(size * n), size, n};
    fuzz_check(block->records != NULL, "memory");
    for (size_t i = 0; i < n; i++) {
        memcpy(block->records + i * size, record, size);
    }
    return block->records;
}

static const struct iso_zone zone = {.name = "zone", .n = 2, .at_s = {1000, 2000}};
static const struct iso_special_day_group group = {"group", 2, {20782, 20783}};
static const struct iso_schedule schedule = {
    .token = "schedule",
    .weekly = {{1, {{0, 1440}}}, {1, {{0, 1440}}}, {2, {{0, 700}, {710, 1440}}}, {1, {{0, 1440}}}},
    .n_special = 1,
    .special = {{0, {1, {{0, 1000}}}}}};
static const struct iso_area area = {"area"};
static const struct iso_security_level level = {"level", false, 1, 2, {1, 6}};
static const struct iso_authentication_profile profile = {
    "profile", 0, 1, {{0, {{0, false}, {0, true}, {ISO_INDEX_NONE, false}, {0, false}}}}};
static const struct iso_access_point point = {"point", true, 0, 1, 0, ISO_ANTIPASSBACK_HARD, 0};
static const struct iso_access_profile access_profile = {"access", 2, {{0, 0}, {1, 1}}};
static const struct iso_credential person = {
    .token = "person", .enabled = true, .identifiers = 7, .pin = 14711, .n_profiles = 1};

static struct iso_policy make_policy(struct block blocks[BLOCKS])
{
    struct iso_policy policy = {
        .zones = make(&blocks[ZONES], &zone, sizeof zone, 1),
        .groups = make(&blocks[GROUPS], &group, sizeof group, 2),
        .schedules = make(&blocks[SCHEDULES], &schedule, sizeof schedule, 2),
        .areas = make(&blocks[AREAS], &area, sizeof area, 2),
        .levels = make(&blocks[LEVELS], &level, sizeof level, 2),
        .authentication_profiles = make(&blocks[PROFILES], &profile, sizeof profile, 1),
        .access_points = make(&blocks[POINTS], &point, sizeof point, 2),
        .access_profiles = make(&blocks[ACCESSES], &access_profile, sizeof access_profile, 1),
        .credentials = make(&blocks[PEOPLE], &person, sizeof person, 3),
        .n_zones = 1,
        .n_groups = 2,
        .n_schedules = 2,
        .n_areas = 2,
        .n_levels = 2,
        .n_authentication_profiles = 1,
        .n_access_points = 2,
        .n_access_profiles = 1,
        .n_credentials = 3};
    ((struct iso_security_level *)blocks[LEVELS].records)[1].priority = 2;
    return policy;
}

/* A byte that is a truth value in C may only be 0 or 1. */
static void keep_true_or_false(void *bytes)
{
    *(uint8_t *)bytes &= 1;
}

static void keep_truth_values(struct block blocks[BLOCKS])
{
    struct iso_authentication_profile *p = (void *)blocks[PROFILES].records;
    for (int i = 0; i < ISO_AUTHENTICATION_POLICIES_MAX; i++) {
        for (int s = 0; s < ISO_SCHEDULE_STATES; s++) {
            keep_true_or_false(&p->policies[i].constraints[s].dual);
        }
    }
    keep_true_or_false(&((struct iso_zone *)blocks[ZONES].records)->rule.has_summer);
    for (size_t i = 0; i < 2; i++) {
        keep_true_or_false(&((struct iso_security_level *)blocks[LEVELS].records)[i].open);
        keep_true_or_false(&((struct iso_access_point *)blocks[POINTS].records)[i].enabled);
    }
    for (size_t i = 0; i < 3; i++) {
        struct iso_credential *c = (struct iso_credential *)blocks[PEOPLE].records + i;
        keep_true_or_false(&c->enabled);
        keep_true_or_false(&c->no_antipassback);
        keep_true_or_false(&c->needs_escort);
    }
}

static void use(const struct iso_policy *policy, const uint8_t *data, size_t size)
{
    struct iso_presence presences[3] = {{true, 0, 5}, {true, 1, 1795608000}, {false, 0, 0}};
    const struct iso_occupancy occupancy = {presences, 3};
    struct iso_access_request request = {.companion = 1, .time_s = 1795608000};
    memcpy(&request.shown, data, size < sizeof request.shown ? size : sizeof request.shown);
    request.companion_shown = request.shown;
    for (unsigned i = 0; i < 16; i++) {
        request.access_point = i % 3;
        request.credential = i % 4;
        request.time_s += 40000 * i;
        const struct iso_access access = iso_access_decide(policy, &occupancy, &request);
        fuzz_check(access.outcome != ISO_ACCESS_WANT || access.wanted || access.companion_wanted,
                   "more is wanted, and it is said what");
        fuzz_check(iso_access_reason_name(access.reason) != NULL, "a reason with a name");
    }
    struct iso_policy_finding findings[8];
    char text[ISO_POLICY_FINDING_TEXT_SIZE];
    const size_t n = iso_policy_check(policy, request.time_s, findings, 8);
    for (size_t i = 0; i < n && i < 8; i++) {
        fuzz_check(iso_policy_finding_text(policy, &findings[i], text)[0] != '\0', "a line");
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct block blocks[BLOCKS];
    const struct iso_policy policy = make_policy(blocks);
    size_t at = 0;
    /* Which array, which byte, which value. */
    for (; at + 4 <= size && data[at] != 0xff; at += 4) {
        struct block *block = &blocks[data[at] % BLOCKS];
        const size_t offset = (size_t)(data[at + 1] << 8 | data[at + 2]);
        block->records[offset % (block->size * block->n)] = data[at + 3];
    }
    keep_truth_values(blocks);
    struct iso_fault fault = {0};
    if (iso_policy_validate(&policy, &fault) == 0) {
        use(&policy, data + at, size - at);
    } else {
        fuzz_check(fault.text[0] != '\0', "a fault that says something");
    }
    for (int i = 0; i < BLOCKS; i++) {
        free(blocks[i].records);
    }
    return 0;
}
