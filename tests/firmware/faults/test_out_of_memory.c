/* The Nth allocation fails, for every N until the call succeeds. Each failure returns -ENOMEM and
 * leaves the outputs untouched. The sanitizers check that no memory leaks. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/audit/audit.h"
#include "firmware/config/config.h"
#include "firmware/gallery/gallery.h"
#include "firmware/recognise/pipeline.h"
#include "tests/firmware/rigs/rig.h"
#include "tests/firmware/rigs/stores.h"
#include "tests/support/memory/scarce_memory.h"
#include "tests/support/scratch.h"

enum { MOST = 200 }; /* no tested call makes more allocations */

static int load_config(void *context, struct iso_fault *fault)
{
    struct rig *rig = context;
    struct iso_config config = {.door.unlock_ms = 4711};
    const int error = iso_config_load(scratch_path(rig->directory, "c.conf"), &config, fault);
    assert_int_equal(config.door.unlock_ms, error ? 4711 : 700);
    return error;
}

static void while_it_reads_a_configuration(void **state)
{
    struct rig *rig = *state;
    scratch_write_text(scratch_path(rig->directory, "c.conf"), "[door]\nunlock_ms = 700\n");
    assert_true(scarce_memory_exhaust(load_config, rig, MOST) >= 1);
}

static int open_log(void *context, struct iso_fault *fault)
{
    struct rig *rig = context;
    struct iso_audit *audit = NULL;
    struct iso_audit_options options = stores_audit(rig->directory);
    options.path = scratch_path(rig->directory, "b.log");
    const int error = iso_audit_open(&options, &rig->borrowed.times, &audit, fault);
    assert_int_equal(audit == NULL, error != 0);
    iso_audit_close(audit);
    return error;
}

static void while_it_opens_a_log(void **state)
{
    struct rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    const struct iso_audit_record record = iso_audit_record_of("x");
    struct iso_audit *audit = NULL;
    struct iso_audit_options options = stores_audit(rig->directory);
    options.path = scratch_path(rig->directory, "b.log");
    assert_int_equal(iso_audit_open(&options, &rig->borrowed.times, &audit, &fault), 0);
    assert_int_equal(iso_audit_append(audit, &record, &fault), 0);
    iso_audit_close(audit);
    assert_true(scarce_memory_exhaust(open_log, rig, MOST) >= 3);
}

static int open_gallery(void *context, struct iso_fault *fault)
{
    struct rig *rig = context;
    struct iso_gallery *gallery = NULL;
    struct iso_gallery_options options = stores_gallery(rig->directory);
    options.path = scratch_path(rig->directory, "h.db");
    const int error = iso_gallery_open(&options, &gallery, fault);
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
    struct iso_gallery_options options = stores_gallery(rig->directory);
    options.path = scratch_path(rig->directory, "h.db");
    assert_int_equal(iso_gallery_open(&options, &gallery, NULL), 0);
    assert_int_equal(iso_gallery_add(gallery, &anna, &tmpl, NULL), 0);
    iso_gallery_close(gallery);
    assert_true(scarce_memory_exhaust(open_gallery, rig, MOST) >= 5);
}

static int add_anna(void *context, struct iso_fault *fault)
{
    struct rig *rig = context;
    const struct iso_person anna = {.name = "anna"};
    const struct iso_template tmpl = puppet_template(50, PUPPET_ALGORITHM);
    const int error = iso_gallery_add(rig->gallery, &anna, &tmpl, fault);
    assert_int_equal(iso_gallery_everybody(rig->gallery).n_entries, error ? 0 : 1);
    assert_int_equal(iso_gallery_find(rig->gallery, "anna") == NULL, error != 0);
    return error;
}

static void while_it_adds_to_a_gallery(void **state)
{
    assert_true(scarce_memory_exhaust(add_anna, *state, MOST) >= 3);
}

static int open_pipeline(void *context, struct iso_fault *fault)
{
    struct rig *rig = context;
    const struct iso_pipeline_options options = {
        .head_path = ISOTHERM_SOURCE_DIR "/core/data/head.model",
        .method = ISO_METHOD_distance,
        .data_path = ISOTHERM_SOURCE_DIR "/core/data/cohort.templates",
        .extract = iso_extract_options_default(),
        .match = iso_match_options_default(),
        .clock = rig->borrowed.times.monotonic,
    };
    struct iso_pipeline pipeline = {0};
    const int error = iso_pipeline_open(&options, &pipeline, fault);
    assert_int_equal(pipeline.ops == NULL, error != 0);
    iso_pipeline_close(&pipeline);
    return error;
}

static void while_it_opens_a_pipeline(void **state)
{
    assert_true(scarce_memory_exhaust(open_pipeline, *state, MOST) >= 3);
}

static int make_appliance(void *context, struct iso_fault *fault)
{
    struct rig *rig = context;
    struct iso_appliance *appliance = NULL;
    const int error = iso_appliance_new(&rig->borrowed, &appliance);
    assert_int_equal(appliance == NULL, error != 0);
    iso_appliance_free(appliance);
    return error ? iso_fault_set(fault, error, "out of memory") : 0;
}

static void while_it_makes_an_appliance(void **state)
{
    assert_int_equal(scarce_memory_exhaust(make_appliance, *state, MOST),
                     4); /* log and door are open already */
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
