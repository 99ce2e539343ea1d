/* Documents that are right: defaults, the canonical text, comparison, and the example of the
 * manual. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/file/file.h"
#include "firmware/policy/calendar.h"
#include "firmware/policy/decide.h"
#include "firmware/policy/zones/zone_file.h"
#include "tests/firmware/policy/document_rig.h"

static void assert_canonical(const char *json, const char *expected)
{
    struct iso_policy_document *document = document_rig_read(json);
    char *text = document_rig_write(document);
    assert_string_equal(text, expected);
    struct iso_policy_document *again = document_rig_read(text);
    document_rig_assert_equal(iso_policy_document_policy(document),
                              iso_policy_document_policy(again));
    assert_int_equal(iso_policy_document_default_profile(document),
                     iso_policy_document_default_profile(again));
    iso_policy_document_free(again);
    iso_policy_document_free(document);
    free(text);
}

static void empty_document(void **state)
{
    (void)state;
    assert_canonical(" { } ", "{}");
    assert_canonical("{\"areas\":[]}", "{}");
    struct iso_policy_document *document = document_rig_read("{}");
    assert_int_equal(iso_policy_document_default_profile(document), ISO_INDEX_NONE);
    assert_int_equal(iso_policy_document_access_point(document, ""), ISO_INDEX_NONE);
    assert_null(iso_policy_document_policy(document)->credentials);
    iso_policy_document_free(document);
    iso_policy_document_free(NULL);
}

static void access_point_needs_a_face_by_default(void **state)
{
    (void)state;
    assert_canonical(
        "{\"access_points\":[{\"token\":\"p\"}]}",
        "{\"security_levels\":[{\"token\":\"face\",\"priority\":0,"
        "\"recognition_groups\":[[\"face\"]]}],"
        "\"authentication_profiles\":[{\"token\":\"face\",\"default_level\":\"face\"}],"
        "\"access_points\":[{\"token\":\"p\",\"authentication_profile\":\"face\"}]}");
    /* The lowest free priority. */
    assert_canonical(
        "{\"access_points\":[{\"token\":\"p\"}],"
        "\"security_levels\":[{\"token\":\"a\",\"priority\":0},{\"token\":\"b\",\"priority\":1}]}",
        "{\"security_levels\":[{\"token\":\"a\",\"priority\":0},{\"token\":\"b\",\"priority\":1},"
        "{\"token\":\"face\",\"priority\":2,\"recognition_groups\":[[\"face\"]]}],"
        "\"authentication_profiles\":[{\"token\":\"face\",\"default_level\":\"face\"}],"
        "\"access_points\":[{\"token\":\"p\",\"authentication_profile\":\"face\"}]}");
    /* The document's own profile, and its own level. */
    assert_canonical(
        "{\"access_points\":[{\"token\":\"p\"}],\"security_levels\":[{\"token\":\"l\"}],"
        "\"authentication_profiles\":[{\"token\":\"x\",\"default_level\":\"l\"},"
        "{\"token\":\"face\",\"default_level\":\"l\"}]}",
        "{\"security_levels\":[{\"token\":\"l\",\"priority\":1}],"
        "\"authentication_profiles\":[{\"token\":\"x\",\"default_level\":\"l\"},"
        "{\"token\":\"face\",\"default_level\":\"l\"}],"
        "\"access_points\":[{\"token\":\"p\",\"authentication_profile\":\"face\"}]}");
    assert_canonical(
        "{\"access_points\":[{\"token\":\"p\"}],"
        "\"security_levels\":[{\"token\":\"l\"},{\"token\":\"face\"}]}",
        "{\"security_levels\":[{\"token\":\"l\",\"priority\":1},{\"token\":\"face\",\"priority\":2}"
        "],\"authentication_profiles\":[{\"token\":\"face\",\"default_level\":\"face\"}],"
        "\"access_points\":[{\"token\":\"p\",\"authentication_profile\":\"face\"}]}");
}

static void everything_has_its_canonical_form(void **state)
{
    (void)state;
    assert_canonical(
        "{\"default_profile\":\"f\","
        "\"access_profiles\":[{\"token\":\"f\",\"policies\":[{\"schedule\":\"s\","
        "\"access_point\":\"p\"}]}],"
        "\"access_points\":[{\"token\":\"p\",\"enabled\":false,\"from\":\"x\",\"to\":\"y\","
        "\"authentication_profile\":\"a\",\"antipassback\":\"timed\",\"antipassback_s\":60},"
        "{\"token\":\"q\",\"enabled\":true,\"authentication_profile\":\"a\","
        "\"antipassback\":\"none\"}],"
        "\"authentication_profiles\":[{\"token\":\"a\",\"default_level\":\"l\",\"policies\":["
        "{\"schedule\":\"s\",\"active\":{\"level\":\"o\",\"two_people\":true},"
        "\"special_active\":null,\"inactive\":{\"level\":\"l\",\"two_people\":false},"
        "\"special_inactive\":{\"level\":\"l\",\"two_people\":true}},{\"schedule\":\"s\"}]}],"
        "\"security_levels\":[{\"token\":\"o\",\"open\":true},"
        "{\"token\":\"l\",\"recognition_groups\":[[\"pin\",\"card\"],[\"face\"]],\"open\":false}],"
        "\"areas\":[{\"token\":\"x\"},{\"token\":\"y\"}],"
        "\"schedules\":[{\"token\":\"s\",\"zone\":\"Test/East\",\"weekly\":{"
        "\"tuesday\":[\"09:00-17:30\"],\"sunday-monday\":[\"09:00-17:30\"],\"friday\":[],"
        "\"thursday\":[\"00:00-00:01\",\"00:01-24:00\"]},"
        "\"special_days\":[{\"group\":\"g\",\"hours\":[\"10:00-12:00\"]}]}],"
        "\"special_day_groups\":[{\"token\":\"g\",\"days\":[\"2028-02-29\",\"1970-01-01\"]}]}",
        "{\"special_day_groups\":[{\"token\":\"g\",\"days\":[\"1970-01-01\",\"2028-02-29\"]}],"
        "\"schedules\":[{\"token\":\"s\",\"zone\":\"Test/East\",\"weekly\":{"
        "\"monday-tuesday\":[\"09:00-17:30\"],\"thursday\":[\"00:00-00:01\",\"00:01-24:00\"],"
        "\"sunday\":[\"09:00-17:30\"]},"
        "\"special_days\":[{\"group\":\"g\",\"hours\":[\"10:00-12:00\"]}]}],"
        "\"areas\":[{\"token\":\"x\"},{\"token\":\"y\"}],"
        "\"security_levels\":[{\"token\":\"o\",\"priority\":1,\"open\":true},"
        "{\"token\":\"l\",\"priority\":2,\"recognition_groups\":[[\"card\",\"pin\"],[\"face\"]]}],"
        "\"authentication_profiles\":[{\"token\":\"a\",\"default_level\":\"l\",\"policies\":["
        "{\"schedule\":\"s\",\"active\":{\"level\":\"o\",\"two_people\":true},"
        "\"inactive\":{\"level\":\"l\"},\"special_active\":null,"
        "\"special_inactive\":{\"level\":\"l\",\"two_people\":true}},{\"schedule\":\"s\"}]}],"
        "\"access_points\":[{\"token\":\"p\",\"enabled\":false,\"from\":\"x\",\"to\":\"y\","
        "\"authentication_profile\":\"a\",\"antipassback\":\"timed\",\"antipassback_s\":60},"
        "{\"token\":\"q\",\"authentication_profile\":\"a\"}],"
        "\"access_profiles\":[{\"token\":\"f\",\"policies\":[{\"access_point\":\"p\","
        "\"schedule\":\"s\"}]}],\"default_profile\":\"f\"}");
}

static void states_on_special_days_are_as_on_others(void **state)
{
    (void)state;
    struct iso_policy_document *document = document_rig_read(
        "{\"schedules\":[{\"token\":\"s\",\"zone\":\"UTC\"}],"
        "\"security_levels\":[{\"token\":\"k\"},{\"token\":\"l\"}],"
        "\"authentication_profiles\":[{\"token\":\"a\",\"default_level\":\"k\",\"policies\":["
        "{\"schedule\":\"s\",\"active\":{\"level\":\"l\",\"two_people\":true},"
        "\"special_inactive\":{\"level\":\"k\"}}]}]}");
    const struct iso_level_constraint *constraints =
        iso_policy_document_policy(document)->authentication_profiles[0].policies[0].constraints;
    assert_int_equal(constraints[ISO_SCHEDULE_ACTIVE].level, 1);
    assert_int_equal(constraints[ISO_SCHEDULE_SPECIAL_ACTIVE].level, 1);
    assert_true(constraints[ISO_SCHEDULE_SPECIAL_ACTIVE].dual);
    assert_int_equal(constraints[ISO_SCHEDULE_INACTIVE].level, ISO_INDEX_NONE);
    assert_int_equal(constraints[ISO_SCHEDULE_SPECIAL].level, 0);
    assert_false(constraints[ISO_SCHEDULE_SPECIAL].dual);
    iso_policy_document_free(document);
}

static void zones_are_read_once(void **state)
{
    (void)state;
    struct iso_policy_document *document = document_rig_read(
        "{\"schedules\":[{\"token\":\"a\",\"zone\":\"UTC\"},{\"token\":\"b\",\"zone\":"
        "\"Test/West\"},"
        "{\"token\":\"c\",\"zone\":\"UTC\"},{\"token\":\"d\",\"zone\":\"Test/West\"}]}");
    const struct iso_policy *policy = iso_policy_document_policy(document);
    assert_int_equal(policy->n_zones, 2);
    assert_int_equal(policy->schedules[2].zone, 0);
    assert_int_equal(policy->schedules[3].zone, 1);
    assert_int_equal(policy->zones[1].rule.standard_s, -7200);
    iso_policy_document_free(document);
}

/* ---- comparison ---- */

struct report {
    char text[1024];
    int n, stop_at, result;
};

static int note(void *context, const char *kind, const char *token, const char *before,
                const char *after)
{
    struct report *report = context;
    char line[512];
    (void)snprintf(line, sizeof line, "%s %s: %s -> %s\n", kind, token, before, after);
    (void)strcat(report->text, line);
    return ++report->n == report->stop_at ? report->result : 0;
}

#define AREAS_BEFORE "{\"areas\":[{\"token\":\"a\"},{\"token\":\"b\"},{\"token\":\"c\"}],"
#define AREAS_AFTER  "{\"areas\":[{\"token\":\"d\"},{\"token\":\"c\"},{\"token\":\"a\"}],"

static void changes_are_reported(void **state)
{
    (void)state;
    struct iso_policy_document *before = document_rig_read(
        AREAS_BEFORE "\"security_levels\":[{\"token\":\"l\",\"priority\":5}],"
                     "\"access_profiles\":[{\"token\":\"f\"},{\"token\":\"g\"}],"
                     "\"default_profile\":\"f\"}");
    struct iso_policy_document *after = document_rig_read(
        AREAS_AFTER "\"security_levels\":[{\"token\":\"l\",\"priority\":6}],"
                    "\"access_profiles\":[{\"token\":\"g\"},{\"token\":\"f\"}],"
                    "\"default_profile\":\"g\"}");
    struct report report = {.text = ""};
    assert_int_equal(iso_policy_document_compare(before, after, note, &report), 0);
    assert_string_equal(
        report.text,
        "area b: {\"token\":\"b\"} -> \n"
        "area d:  -> {\"token\":\"d\"}\n"
        "security_level l: {\"token\":\"l\",\"priority\":5} -> {\"token\":\"l\",\"priority\":6}\n"
        "default_profile : \"f\" -> \"g\"\n");
    report = (struct report){.stop_at = 2, .result = -7};
    assert_int_equal(iso_policy_document_compare(before, after, note, &report), -7);
    assert_int_equal(report.n, 2);
    report = (struct report){.text = ""};
    assert_int_equal(iso_policy_document_compare(after, after, note, &report), 0);
    assert_int_equal(iso_policy_document_compare(NULL, NULL, note, &report), 0);
    assert_int_equal(report.n, 0);
    assert_int_equal(iso_policy_document_compare(NULL, before, note, &report), 0);
    assert_int_equal(report.n, 7);
    report = (struct report){.text = ""};
    assert_int_equal(iso_policy_document_compare(before, NULL, note, &report), 0);
    assert_int_equal(report.n, 7);
    assert_non_null(strchr(report.text, '\n'));
    iso_policy_document_free(before);
    iso_policy_document_free(after);
}

static void too_large_to_be_written(void **state)
{
    (void)state;
    /* Each access point is longer in the canonical form, by its authentication profile. */
    char *json = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&json, &size);
    assert_non_null(stream);
    (void)fprintf(stream, "{\"security_levels\":[{\"token\":\"l\"}],\"access_profiles\":[");
    for (int i = 0; i < 4000; i++) {
        (void)fprintf(stream, "%s{\"token\":\"profile-%d-", i ? "," : "", i);
        (void)fprintf(stream, "%.*s\"}", 50, "xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx");
    }
    (void)fprintf(stream, "],\"areas\":[");
    for (int i = 0; i < 4096; i++) {
        (void)fprintf(stream, "%s{\"token\":\"area-%d-%.*s\"}", i ? "," : "", i, 50,
                      "xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx");
    }
    (void)fprintf(stream, "],\"access_points\":[");
    for (int i = 0; i < 4096; i++) {
        (void)fprintf(stream, "%s{\"token\":\"point-%d-%.*s\"}", i ? "," : "", i, 50,
                      "xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx");
    }
    (void)fprintf(stream, "]}");
    assert_int_equal(fclose(stream), 0);
    assert_true(size <= ISO_POLICY_DOCUMENT_MAX_BYTES);
    struct iso_policy_document *document = document_rig_read(json);
    free(json);
    char *text = NULL;
    struct iso_fault fault = {0};
    assert_int_equal(iso_policy_document_write(document, &text, &fault), -E2BIG);
    assert_null(text);
    assert_memory_equal(fault.text, "policy: has ", 12);
    iso_policy_document_free(document);
}

/* ---- the example of the manual ---- */

struct case_of_office {
    const char *profile, *point;
    int year, month, day, minute; /* by the clock on the wall in Berlin, which is UTC+1 in winter */
    uint8_t shown;
    enum iso_access_outcome outcome;
    enum iso_access_reason reason; /* of DENY; of WANT: what is wanted */
};

enum { FACE = ISO_RECOGNITION_FACE, CARD = ISO_RECOGNITION_CARD, PIN = ISO_RECOGNITION_PIN };

static const struct case_of_office cases[] = {
    {"staff", "front", 2026, 11, 30, 7 * 60, FACE, ISO_ACCESS_ALLOW, 0},
    {"staff", "back", 2026, 11, 30, 19 * 60 - 1, FACE, ISO_ACCESS_ALLOW, 0},
    {"staff", "front", 2026, 11, 30, 19 * 60, FACE, ISO_ACCESS_DENY, ISO_ACCESS_NOT_AT_THIS_TIME},
    {"staff", "front", 2026, 11, 29, 9 * 60, FACE, ISO_ACCESS_DENY, ISO_ACCESS_NOT_AT_THIS_TIME},
    {"staff", "front", 2026, 12, 25, 9 * 60, FACE, ISO_ACCESS_DENY, ISO_ACCESS_NOT_AT_THIS_TIME},
    {"staff", "front", 2026, 12, 24, 9 * 60, FACE, ISO_ACCESS_ALLOW, 0},
    {"staff", "front", 2026, 12, 24, 13 * 60, FACE, ISO_ACCESS_DENY, ISO_ACCESS_NOT_AT_THIS_TIME},
    {"staff", "front", 2026, 11, 30, 23 * 60, FACE, ISO_ACCESS_DENY, ISO_ACCESS_NOT_AT_THIS_TIME},
    {"night-guards", "back", 2026, 11, 30, 23 * 60, CARD | PIN, ISO_ACCESS_ALLOW, 0},
    {"night-guards", "back", 2026, 11, 30, 23 * 60, FACE, ISO_ACCESS_WANT, CARD | PIN},
    {"night-guards", "front", 2026, 12, 25, 5 * 60, CARD | PIN, ISO_ACCESS_ALLOW, 0},
    {"night-guards", "front", 2026, 11, 30, 12 * 60, FACE, ISO_ACCESS_DENY,
     ISO_ACCESS_NOT_AT_THIS_TIME},
    {"visitors", "front", 2026, 11, 30, 11 * 60, FACE, ISO_ACCESS_ALLOW, 0},
    {"visitors", "front", 2026, 11, 30, 12 * 60 + 30, FACE, ISO_ACCESS_DENY,
     ISO_ACCESS_NOT_AT_THIS_TIME},
    {"visitors", "back", 2026, 11, 30, 11 * 60, FACE, ISO_ACCESS_DENY, ISO_ACCESS_UNAUTHORIZED},
};

static void try_office(const struct iso_policy_document *document, const struct case_of_office *c)
{
    struct iso_policy policy = *iso_policy_document_policy(document);
    const struct iso_credential credential = {
        .token = "somebody",
        .enabled = true,
        .identifiers = ISO_RECOGNITION_ALL,
        .pin = 14711,
        .n_profiles = 1,
        .profiles = {iso_policy_document_access_profile(document, c->profile)}};
    policy.credentials = &credential;
    policy.n_credentials = 1;
    const struct iso_access_request request = {
        .access_point = iso_policy_document_access_point(document, c->point),
        .shown = {.matched = c->shown & (FACE | CARD),
                  .pin = (c->shown & PIN) != 0 ? credential.pin : 0},
        .companion = ISO_CREDENTIAL_NONE,
        .time_s = iso_calendar_day(c->year, c->month, c->day) * ISO_DAY_S +
                  (int64_t)(c->minute - 60) * 60};
    const struct iso_occupancy nobody = {NULL, 0};
    const struct iso_access access = iso_access_decide(&policy, &nobody, &request);
    assert_int_equal(access.outcome, c->outcome);
    assert_int_equal(access.outcome == ISO_ACCESS_WANT ? access.wanted : access.reason, c->reason);
}

static void example_does_what_the_manual_says(void **state)
{
    (void)state;
    char *json = NULL;
    size_t size = 0;
    struct iso_fault fault = {0};
    assert_int_equal(iso_file_read(ISOTHERM_SOURCE_DIR "/enroll/examples/policy-office.json",
                                   1 << 16, &json, &size, &fault),
                     0);
    const struct iso_zone_source zones = {iso_zone_file_read, (void *)ISO_ZONE_FOLDER};
    struct iso_policy_document *document = NULL;
    if (iso_policy_document_read(json, size, &zones, &document, &fault) != 0) {
        fail_msg("%s", fault.text);
    }
    /* The manual shows the same file. */
    char *manual = NULL;
    size_t manual_size = 0;
    assert_int_equal(iso_file_read(ISOTHERM_SOURCE_DIR "/enroll/man/isotherm-policy.5", 1 << 16,
                                   &manual, &manual_size, &fault),
                     0);
    assert_non_null(memmem(manual, manual_size, json, size));
    free(manual);
    free(json);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        try_office(document, &cases[i]);
    }
    assert_int_equal(iso_policy_document_default_profile(document),
                     iso_policy_document_access_profile(document, "staff"));
    iso_policy_document_free(document);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(empty_document),
        cmocka_unit_test(access_point_needs_a_face_by_default),
        cmocka_unit_test(everything_has_its_canonical_form),
        cmocka_unit_test(states_on_special_days_are_as_on_others),
        cmocka_unit_test(zones_are_read_once),
        cmocka_unit_test(changes_are_reported),
        cmocka_unit_test(too_large_to_be_written),
        cmocka_unit_test(example_does_what_the_manual_says),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
