/* Memory that runs out while a document is read, written and compared: each allocation fails once,
 * those of Jansson too. */
#include <errno.h>
#include <jansson.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/firmware/policy/document_rig.h"
#include "tests/support/memory/scarce_memory.h"

/* Every kind of record, two zones, and the profile that the reader adds. */
static const char json[] =
    "{\"special_day_groups\":[{\"token\":\"g\",\"days\":[\"2026-12-25\"]}],"
    "\"schedules\":[{\"token\":\"s\",\"zone\":\"UTC\",\"weekly\":{\"monday\":[\"09:00-12:00\"]},"
    "\"special_days\":[{\"group\":\"g\",\"hours\":[\"10:00-11:00\"]}]},"
    "{\"token\":\"t\",\"zone\":\"Test/East\"}],\"areas\":[{\"token\":\"x\"}],"
    "\"security_levels\":[{\"token\":\"o\",\"open\":true},"
    "{\"token\":\"l\",\"recognition_groups\":[[\"face\",\"card\"]]}],"
    "\"authentication_profiles\":[{\"token\":\"a\",\"default_level\":\"l\",\"policies\":["
    "{\"schedule\":\"s\",\"active\":{\"level\":\"o\",\"two_people\":true},"
    "\"special_active\":null}]}],"
    "\"access_points\":[{\"token\":\"p\",\"to\":\"x\",\"antipassback\":\"soft\"},"
    "{\"token\":\"q\",\"enabled\":false,\"authentication_profile\":\"a\"}],"
    "\"access_profiles\":[{\"token\":\"f\",\"policies\":[{\"access_point\":\"p\","
    "\"schedule\":\"s\"}]}],\"default_profile\":\"f\"}";

static void *take(size_t size)
{
    return malloc(size); /* that of scarce_memory.h */
}

static char *canonical; /* the right text */

/* Each of these returns the error, and fails the test for a result that is wrong. */
static int read_it(struct iso_fault *fault)
{
    struct iso_policy_document *document = NULL;
    const int error = iso_policy_document_read(json, strlen(json), &document_rig_zones, &document,
                                               fault);
    const long left = scarce_memory_left;
    scarce_memory_left = -1;
    assert_true((error == 0) == (document != NULL));
    if (document) {
        char *text = document_rig_write(document);
        assert_string_equal(text, canonical);
        free(text);
    }
    iso_policy_document_free(document);
    scarce_memory_left = left;
    return error;
}

static struct iso_policy_document *stored;

static int write_it(struct iso_fault *fault)
{
    char *text = NULL;
    const int error = iso_policy_document_write(stored, &text, fault);
    assert_true((error == 0) == (text != NULL));
    if (text) {
        assert_string_equal(text, canonical);
    }
    free(text);
    return error;
}

static int count(void *context, const char *kind, const char *token, const char *before,
                 const char *after)
{
    (void)kind, (void)token, (void)before;
    assert_string_equal(after, "");
    ++*(int *)context;
    return 0;
}

static int compare_it(struct iso_fault *fault)
{
    int n = 0;
    const int error = iso_policy_document_compare(stored, NULL, count, &n);
    if (error == 0) {
        assert_int_equal(n, 13);
    }
    return error != 0 ? iso_fault_set(fault, error, "out of memory") : 0;
}

/* Lets the first allocation fail, then the second, and so on. Jansson does not need every one, so
 * the result may be right nevertheless. Returns how often it was not. */
static int exhaust(int (*action)(struct iso_fault *fault))
{
    int failures = 0;
    for (long n = 0; n < 5000; n++) {
        struct iso_fault fault = {.text = ""};
        scarce_memory_left = n;
        const int error = action(&fault);
        const bool all_went_well = scarce_memory_left >= 0;
        scarce_memory_left = -1;
        if (all_went_well) {
            assert_int_equal(error, 0);
            return failures;
        }
        if (error != 0) {
            assert_int_equal(error, -ENOMEM);
            assert_string_equal(fault.text, "out of memory");
            failures++;
        }
    }
    fail_msg("never went well");
    return 0;
}

static void each_allocation_fails(void **state)
{
    (void)state;
    stored = document_rig_read(json);
    canonical = document_rig_write(stored);
    assert_true(exhaust(read_it) > 200);
    assert_true(exhaust(write_it) > 50);
    assert_true(exhaust(compare_it) > 50);
    iso_policy_document_free(stored);
    free(canonical);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(each_allocation_fails)};
    json_set_alloc_funcs(take, free);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
