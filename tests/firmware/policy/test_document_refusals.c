/* What the reader of documents refuses, one fault at a time, and the line that names it. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/firmware/policy/document_rig.h"

#define GROUP    "\"special_day_groups\":[{\"token\":\"free\",\"days\":[\"2026-12-25\"]}]"
#define SCHEDULE "\"schedules\":[{\"token\":\"s\",\"zone\":\"UTC\"}]"
#define LEVEL    "\"security_levels\":[{\"token\":\"l\"}]"
#define S        "\"schedules\":[{\"token\":\"s\",\"zone\":\"UTC\","
#define AUTH     SCHEDULE "," LEVEL ",\"authentication_profiles\":[{\"token\":\"a\","

static const struct {
    const char *json, *line;
} cases[] = {
    /* The text. */
    {"", "policy: line 1, column 0: '[' or '{' expected near end of file"},
    {"{\"areas\":[]", "policy: line 1, column 11: '}' expected near end of file"},
    {"{\"areas\":[],\"areas\":[]}",
     "policy: line 1, column 19: duplicate object key near '\"areas\"'"},
    {"[]", "policy: the document is not an object"},
    {"{\"arreas\":[]}", "policy: the document has an unknown member \"arreas\""},
    {"{\"a\\u0007\":[]}", "policy: the document has an unknown member \"a?\""},
    {"{\"areas\":{}}", "policy: \"areas\" is not an array"},
    {"{\"areas\":[[[[[[[[[[[[[[[[[[[[[[]]]]]]]]]]]]]]]]]]]]]]}",
     "policy: has more than 16 arrays and objects within each other"},
    /* Tokens. */
    {"{\"areas\":[{\"token\":\"x\"},5]}", "area number 2: is not an object"},
    {"{\"areas\":[{}]}", "area number 1: has no token"},
    {"{\"areas\":[{\"token\":\"\"}]}", "area number 1: has no token"},
    {"{\"areas\":[{\"token\":7}]}", "area number 1: \"token\" is not a string"},
    {"{\"areas\":[{\"token\":\"\\u001b[2J\"}]}",
     "area number 1: the token has a control character"},
    {"{\"areas\":[{\"token\":\"\\u0085\"}]}", "area number 1: the token has a control character"},
    {"{\"areas\":[{\"token\":\"aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa\"}"
     "]"
     "}",
     "area number 1: the token has more than 64 bytes"},
    {"{\"areas\":[{\"token\":\"x\"},{\"token\":\"x\"}]}",
     "area number 2: the token \"x\" is used twice"},
    {"{\"areas\":[{\"token\":\"x\",\"color\":1}]}",
     "area \"x\": it has an unknown member \"color\""},
    /* Special day groups. */
    {"{\"special_day_groups\":[{\"token\":\"g\",\"days\":[\"2026-02-29\"]}]}",
     "special day group \"g\": \"2026-02-29\" is not a date such as \"2026-12-25\""},
    {"{\"special_day_groups\":[{\"token\":\"g\",\"days\":[\"1969-12-31\"]}]}",
     "special day group \"g\": \"1969-12-31\" is not a date such as \"2026-12-25\""},
    {"{\"special_day_groups\":[{\"token\":\"g\",\"days\":[20261225]}]}",
     "special day group \"g\": \"\" is not a date such as \"2026-12-25\""},
    {"{\"special_day_groups\":[{\"token\":\"g\",\"days\":[\"2026-12-26\",\"2026-12-25\","
     "\"2026-12-26\"]}]}",
     "special day group \"g\": has the date \"2026-12-26\" twice"},
    /* Schedules. */
    {"{\"schedules\":[{\"token\":\"s\"}]}", "schedule \"s\": has no \"zone\""},
    {"{\"schedules\":[{\"token\":\"s\",\"zone\":\"Europe/Berln\"}]}",
     "schedule \"s\": the zone cannot be read: there is no time zone \"Europe/Berln\""},
    {"{\"schedules\":[{\"token\":\"s\",\"zone\":"
     "\"aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa\"}"
     "]}",
     "schedule \"s\": the name of the zone is too long"},
    {"{" S "\"weekly\":[]}]}", "schedule \"s\": \"weekly\" is not an object"},
    {"{" S "\"weekly\":{\"mon\":[]}}]}",
     "schedule \"s\": \"mon\" is neither a day nor days such as \"monday-friday\""},
    {"{" S "\"weekly\":{\"monday-\":[]}}]}",
     "schedule \"s\": \"monday-\" is neither a day nor days such as \"monday-friday\""},
    {"{" S "\"weekly\":{\"saturday-tuesday\":[],\"monday\":[]}}]}",
     "schedule \"s\": \"monday\" names a day for the second time"},
    {"{" S "\"weekly\":{\"monday\":\"09:00-17:30\"}}]}",
     "schedule \"s\": monday: the hours are not an array"},
    {"{" S "\"weekly\":{\"monday\":[\"9:00-17:30\"]}}]}",
     "schedule \"s\": monday: \"9:00-17:30\" is not a period such as \"09:00-17:30\""},
    {"{" S "\"weekly\":{\"monday\":[\"24:00-24:00\"]}}]}",
     "schedule \"s\": monday: \"24:00-24:00\" is not a period such as \"09:00-17:30\""},
    {"{" S "\"weekly\":{\"monday\":[\"09:60-17:30\"]}}]}",
     "schedule \"s\": monday: \"09:60-17:30\" is not a period such as \"09:00-17:30\""},
    {"{" S "\"weekly\":{\"monday\":[\"22:00-06:00\"]}}]}",
     "schedule \"s\": Monday: the period 22:00 to 06:00 ends before it begins"},
    {"{" S "\"weekly\":{\"sunday\":[\"00:00-00:01\",\"01:00-01:01\",\"02:00-02:01\","
     "\"03:00-03:01\",\"04:00-04:01\",\"05:00-05:01\",\"06:00-06:01\",\"07:00-07:01\","
     "\"08:00-08:01\"]}}]}",
     "schedule \"s\": sunday: 9 periods, at most 8"},
    {"{" GROUP "," S "\"special_days\":[{\"group\":\"free\"},{\"group\":\"free\"}]}]}",
     "schedule \"s\": names \"free\" twice"},
    {"{" S "\"special_days\":[{\"group\":\"fre\"}]}]}",
     "schedule \"s\": there is no special day group \"fre\""},
    {"{" S "\"special_days\":[{\"hours\":[]}]}]}", "schedule \"s\": has no \"group\""},
    {"{" S "\"special_days\":[7]}]}",
     "schedule \"s\": an entry of \"special_days\" is not an object"},
    {"{" GROUP "," S "\"special_days\":[{\"group\":\"free\",\"hours\":[\"1\"]}]}]}",
     "schedule \"s\": free: \"1\" is not a period such as \"09:00-17:30\""},
    /* Security levels. */
    {"{\"security_levels\":[{\"token\":\"l\",\"open\":1}]}",
     "security level \"l\": \"open\" is neither true nor false"},
    {"{\"security_levels\":[{\"token\":\"l\",\"priority\":2147483648}]}",
     "security level \"l\": \"priority\" is not a whole number of 32 bits"},
    {"{\"security_levels\":[{\"token\":\"l\",\"priority\":1.5}]}",
     "security level \"l\": \"priority\" is not a whole number of 32 bits"},
    {"{\"security_levels\":[{\"token\":\"l\",\"priority\":2},{\"token\":\"m\"}]}",
     "security level \"m\": has the same priority as \"l\""},
    {"{\"security_levels\":[{\"token\":\"l\",\"open\":true,\"recognition_groups\":[[\"face\"]]}]}",
     "security level \"l\": is open and has recognition groups"},
    {"{\"security_levels\":[{\"token\":\"l\",\"recognition_groups\":[[]]}]}",
     "security level \"l\": has a recognition group without methods"},
    {"{\"security_levels\":[{\"token\":\"l\",\"recognition_groups\":[\"face\"]}]}",
     "security level \"l\": a recognition group is not an array"},
    {"{\"security_levels\":[{\"token\":\"l\",\"recognition_groups\":[[\"iris\"]]}]}",
     "security level \"l\": \"iris\" is none of \"face\", \"card\" and \"pin\""},
    {"{\"security_levels\":[{\"token\":\"l\",\"recognition_groups\":[[\"pin\",\"pin\"]]}]}",
     "security level \"l\": a recognition group has \"pin\" twice"},
    {"{\"security_levels\":[{\"token\":\"l\",\"recognition_groups\":[[],[],[],[],[]]}]}",
     "security level \"l\": \"recognition_groups\" has 5 entries, at most 4"},
    /* Authentication profiles. */
    {"{" AUTH "\"default_level\":\"m\"}]}",
     "authentication profile \"a\": there is no security level \"m\""},
    {"{" AUTH "\"policies\":[]}]}", "authentication profile \"a\": has no \"default_level\""},
    {"{" AUTH "\"default_level\":\"l\",\"policies\":[{}]}]}",
     "authentication profile \"a\": has no \"schedule\""},
    {"{" AUTH "\"default_level\":\"l\",\"policies\":[{\"schedule\":\"s\",\"activ\":{}}]}]}",
     "authentication profile \"a\": an entry of \"policies\" has an unknown member \"activ\""},
    {"{" AUTH "\"default_level\":\"l\",\"policies\":[{\"schedule\":\"s\",\"active\":\"l\"}]}]}",
     "authentication profile \"a\": active is not an object"},
    {"{" AUTH "\"default_level\":\"l\",\"policies\":[{\"schedule\":\"s\",\"active\":"
     "{\"two_people\":true}}]}]}",
     "authentication profile \"a\": has no \"level\""},
    /* Access points. */
    {"{\"access_points\":[{\"token\":\"p\",\"to\":\"hall\"}]}",
     "access point \"p\": there is no area \"hall\""},
    {"{\"access_points\":[{\"token\":\"p\",\"authentication_profile\":\"x\"}]}",
     "access point \"p\": there is no authentication profile \"x\""},
    {"{\"access_points\":[{\"token\":\"p\",\"antipassback\":\"loud\"}]}",
     "access point \"p\": antipassback: \"loud\" is none of \"none\", \"soft\", \"hard\" and "
     "\"timed\""},
    {"{\"access_points\":[{\"token\":\"p\",\"antipassback\":\"hard\"}]}",
     "access point \"p\": has antipassback and leads to no area"},
    {"{\"areas\":[{\"token\":\"x\"}],\"access_points\":[{\"token\":\"p\",\"to\":\"x\","
     "\"antipassback\":\"timed\"}]}",
     "access point \"p\": has a time of antipassback that does not fit its kind"},
    {"{\"areas\":[{\"token\":\"x\"}],\"access_points\":[{\"token\":\"p\",\"to\":\"x\",\"from\":"
     "\"x\"}]}",
     "access point \"p\": leads from an area to the same one"},
    /* Access profiles. */
    {"{\"access_profiles\":[{\"token\":\"f\",\"policies\":[{\"access_point\":\"p\"}]}]}",
     "access profile \"f\": there is no access point \"p\""},
    {"{\"access_points\":[{\"token\":\"p\"}],\"access_profiles\":[{\"token\":\"f\",\"policies\":"
     "[{\"access_point\":\"p\"}]}]}",
     "access profile \"f\": has no \"schedule\""},
    {"{\"default_profile\":\"f\"}", "policy: there is no access profile \"f\""},
};

static void refuse(const char *json, size_t size, int error, const char *line)
{
    struct iso_policy_document *document = (struct iso_policy_document *)&cases;
    struct iso_fault fault = {0};
    assert_int_equal(iso_policy_document_read(json, size, &document_rig_zones, &document, &fault),
                     error);
    assert_string_equal(fault.text, line);
    assert_ptr_equal(document, &cases); /* as before */
    assert_int_equal(iso_policy_document_read(json, size, &document_rig_zones, &document, NULL),
                     error);
}

static void each_fault_has_its_line(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        refuse(cases[i].json, strlen(cases[i].json), -EINVAL, cases[i].line);
    }
}

static void zone_without_memory(void **state)
{
    (void)state;
    static const char json[] = "{\"schedules\":[{\"token\":\"s\",\"zone\":\"Test/Memory\"}]}";
    refuse(json, strlen(json), -ENOMEM, "out of memory");
}

/* A document of `size` bytes; the rest is blank. */
static char *padded(const char *json, size_t size)
{
    char *text = malloc(size + 1);
    assert_non_null(text);
    memset(text, ' ', size);
    memcpy(text, json, strlen(json));
    text[size] = '\0';
    return text;
}

static void size_limit(void **state)
{
    (void)state;
    char *text = padded("{}", ISO_POLICY_DOCUMENT_MAX_BYTES + 1);
    refuse(text, ISO_POLICY_DOCUMENT_MAX_BYTES + 1, -EINVAL,
           "policy: has 1048577 bytes, at most 1048576");
    text[ISO_POLICY_DOCUMENT_MAX_BYTES] = '\0';
    iso_policy_document_free(document_rig_read(text));
    free(text);
}

static void depth_limit(void **state)
{
    (void)state;
    /* Depth 16 is refused for what it is, not for its depth; brackets in strings do not count. */
    static const char json[] = "{\"areas\":[[[[[[[[[[[[[[[]]]]]]]]]]]]]]]}";
    refuse(json, strlen(json), -EINVAL, "area number 1: is not an object");
    iso_policy_document_free(
        document_rig_read("{\"areas\":[{\"token\":\"\\\"[[[[[[[[[[[[[[[[[[[[[[\"}]}"));
}

/* `n` areas, each with a token of its own. */
static char *areas(unsigned n)
{
    char *text = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&text, &size);
    assert_non_null(stream);
    (void)fprintf(stream, "{\"areas\":[");
    for (unsigned i = 0; i < n; i++) {
        (void)fprintf(stream, "%s{\"token\":\"%u\"}", i ? "," : "", i);
    }
    (void)fprintf(stream, "]}");
    assert_int_equal(fclose(stream), 0);
    return text;
}

static void record_limit(void **state)
{
    (void)state;
    char *text = areas(ISO_POLICY_DOCUMENT_MAX_RECORDS + 1);
    refuse(text, strlen(text), -EINVAL, "policy: \"areas\" has 4097 entries, at most 4096");
    free(text);
    text = areas(ISO_POLICY_DOCUMENT_MAX_RECORDS);
    struct iso_policy_document *document = document_rig_read(text);
    assert_int_equal(iso_policy_document_policy(document)->n_areas, 4096);
    iso_policy_document_free(document);
    free(text);
}

/* A line is cut between two characters. */
static void long_lines_stay_utf8(void **state)
{
    (void)state;
    char json[512], name[200] = "";
    for (int shift = 0; shift < 3; shift++) {
        (void)snprintf(name, sizeof name, "%.*s", shift, "ab");
        while (strlen(name) + 3 < sizeof name) {
            (void)strcat(name, "\u20ac");
        }
        (void)snprintf(json, sizeof json, "{\"%s\":1}", name);
        struct iso_policy_document *document = NULL;
        struct iso_fault fault = {0};
        assert_int_equal(
            iso_policy_document_read(json, strlen(json), &document_rig_zones, &document, &fault),
            -EINVAL);
        const unsigned char *c = (const unsigned char *)fault.text;
        while (*c) {
            const int length = *c < 0x80 ? 1 : 3;
            assert_int_equal(strnlen((const char *)c, 3) >= (size_t)length, 1);
            assert_true(length == 1 || memcmp(c, "\u20ac", 3) == 0);
            c += length;
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_fault_has_its_line),
        cmocka_unit_test(zone_without_memory),
        cmocka_unit_test(size_limit),
        cmocka_unit_test(depth_limit),
        cmocka_unit_test(record_limit),
        cmocka_unit_test(long_lines_stay_utf8),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
