/* The Nth allocation fails, for every N until all goes well: -ENOMEM, outputs untouched, and
 * (seen by the sanitizers) nothing leaks. The linker wraps the allocators of what is linked
 * statically. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/cmocka_headers.h"

#include "firmware/audit.h"
#include "firmware/config.h"
#include "firmware/gallery.h"
#include "firmware/pipeline.h"
#include "tests/firmware/rig.h"
#include "tests/support/scratch.h"

static long left = -1; /* allocations until one fails; negative: none does */

static bool denied(void)
{
    return left >= 0 && left-- == 0;
}

void *__real_malloc(size_t size);
void *__real_calloc(size_t n, size_t size);
void *__real_realloc(void *old, size_t size);
void *__real_reallocarray(void *old, size_t n, size_t size);
char *__real_strdup(const char *text);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t n, size_t size);
void *__wrap_realloc(void *old, size_t size);
void *__wrap_reallocarray(void *old, size_t n, size_t size);
char *__wrap_strdup(const char *text);

void *__wrap_malloc(size_t size)
{
    return denied() ? NULL : __real_malloc(size);
}

void *__wrap_calloc(size_t n, size_t size)
{
    return denied() ? NULL : __real_calloc(n, size);
}

void *__wrap_realloc(void *old, size_t size)
{
    return denied() ? NULL : __real_realloc(old, size);
}

void *__wrap_reallocarray(void *old, size_t n, size_t size)
{
    return denied() ? NULL : __real_reallocarray(old, n, size);
}

char *__wrap_strdup(const char *text)
{
    return denied() ? NULL : __real_strdup(text);
}

/* Calls `action` with the first, second, ... allocation failing, until none fails any more. Returns
 * how many failed. */
static int exhaust(int (*action)(struct rig *rig, struct iso_fault *fault), struct rig *rig)
{
    for (int n = 0; n < 200; n++) {
        struct iso_fault fault = {""};
        left = n;
        const int error = action(rig, &fault);
        const bool all_went_well = left >= 0;
        left = -1;
        if (all_went_well) {
            assert_int_equal(error, 0);
            return n;
        }
        assert_int_equal(error, -ENOMEM);
        assert_non_null(strstr(fault.text, "out of memory"));
    }
    fail_msg("never went well");
    return 0;
}

static int load_config(struct rig *rig, struct iso_fault *fault)
{
    struct iso_config config = {.door.unlock_ms = 4711};
    const int error = iso_config_load(scratch_path(rig->directory, "c.conf"), &config, fault);
    assert_int_equal(config.door.unlock_ms, error ? 4711 : 700);
    return error;
}

static void while_it_reads_a_configuration(void **state)
{
    struct rig *rig = *state;
    scratch_write_text(scratch_path(rig->directory, "c.conf"), "[door]\nunlock_ms = 700\n");
    assert_true(exhaust(load_config, rig) >= 1);
}

static int open_log(struct rig *rig, struct iso_fault *fault)
{
    struct iso_audit *audit = NULL;
    const int error = iso_audit_open(scratch_path(rig->directory, "b.log"), false,
                                     &rig->parts.times, &audit, fault);
    assert_int_equal(audit == NULL, error != 0);
    iso_audit_close(audit);
    return error;
}

static void while_it_opens_a_log(void **state)
{
    struct rig *rig = *state;
    scratch_write_text(scratch_path(rig->directory, "b.log"), "{\"sequence\":1,\"x\":0}\n");
    assert_true(exhaust(open_log, rig) >= 3);
}

static int open_gallery(struct rig *rig, struct iso_fault *fault)
{
    struct iso_gallery *gallery = NULL;
    const int error = iso_gallery_open(scratch_path(rig->directory, "h.db"), 3, PUPPET_ALGORITHM,
                                       &gallery, fault);
    assert_int_equal(gallery == NULL, error != 0);
    iso_gallery_close(gallery);
    return error;
}

static void while_it_opens_a_gallery(void **state)
{
    struct rig *rig = *state;
    struct iso_gallery *gallery = NULL;
    const struct iso_person anna = {.name = "anna"};
    const struct iso_template tmpl = puppet_template(50, PUPPET_ALGORITHM);
    assert_int_equal(
        iso_gallery_open(scratch_path(rig->directory, "h.db"), 3, PUPPET_ALGORITHM, &gallery, NULL),
        0);
    assert_int_equal(iso_gallery_add(gallery, &anna, &tmpl, NULL), 0);
    iso_gallery_close(gallery);
    assert_true(exhaust(open_gallery, rig) >= 5);
}

static int add_anna(struct rig *rig, struct iso_fault *fault)
{
    const struct iso_person anna = {.name = "anna"};
    const struct iso_template tmpl = puppet_template(50, PUPPET_ALGORITHM);
    const int error = iso_gallery_add(rig->gallery, &anna, &tmpl, fault);
    int n = -1;
    (void)iso_gallery_entries(rig->gallery, &n);
    assert_int_equal(n, error ? 0 : 1);
    assert_int_equal(iso_gallery_find(rig->gallery, "anna") == NULL, error != 0);
    return error;
}

static void while_it_adds_to_a_gallery(void **state)
{
    assert_true(exhaust(add_anna, *state) >= 3);
}

static int open_pipeline(struct rig *rig, struct iso_fault *fault)
{
    const struct iso_pipeline_options options = {
        .head_path = ISOTHERM_SOURCE_DIR "/core/data/head.model",
        .cohort_path = ISOTHERM_SOURCE_DIR "/core/data/cohort.templates",
        .extract = iso_extract_options_default(),
        .match = iso_match_options_default(),
        .clock = rig->parts.times.monotonic,
    };
    struct iso_pipeline pipeline = {0};
    const int error = iso_pipeline_open(&options, &pipeline, fault);
    assert_int_equal(pipeline.ops == NULL, error != 0);
    iso_pipeline_close(&pipeline);
    return error;
}

static void while_it_opens_a_pipeline(void **state)
{
    assert_true(exhaust(open_pipeline, *state) >= 3);
}

static int make_appliance(struct rig *rig, struct iso_fault *fault)
{
    struct iso_appliance *appliance = NULL;
    const int error = iso_appliance_new(&rig->parts, &appliance);
    assert_int_equal(appliance == NULL, error != 0);
    iso_appliance_free(appliance);
    return error ? iso_fault_set(fault, error, "out of memory") : 0;
}

static void while_it_makes_an_appliance(void **state)
{
    assert_int_equal(exhaust(make_appliance, *state), 1);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, rig_setup, rig_teardown)
    const struct CMUnitTest tests[] = {
        TEST(while_it_reads_a_configuration), TEST(while_it_opens_a_log),
        TEST(while_it_opens_a_gallery),       TEST(while_it_adds_to_a_gallery),
        TEST(while_it_opens_a_pipeline),      TEST(while_it_makes_an_appliance),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
