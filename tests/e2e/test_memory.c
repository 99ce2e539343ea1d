/* After a person was removed, the daemon's memory has neither the name nor the template. Before the
 * removal the search finds both, which shows that it works. Only root can read the memory of a
 * daemon. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "firmware/daemon/components.h"
#include "isotherm/template.h"
#include "tests/e2e/appliance.h"
#include "tests/e2e/process_memory.h"
#include "tests/support/scratch.h"

#define NAME  "Wilhelmina-Xyloquartz-of-the-Seventh-Landing"
#define OTHER "p02"

enum { RUN = 32, RUNS_MAX = 600 };

/* Pieces of a template, as it is in memory and as it is stored. */
struct runs {
    uint8_t bytes[RUNS_MAX][RUN];
    int n;
};

/* Whether the piece has many different bytes. A piece with few, such as zeros, may occur anywhere
 * in memory. */
static bool is_telling(const uint8_t *run)
{
    int kinds = 0;
    bool seen[256] = {false};
    for (int i = 0; i < RUN; i++) {
        kinds += !seen[run[i]];
        seen[run[i]] = true;
    }
    return kinds >= RUN / 2;
}

/* Collects a piece every `step` bytes, if it has enough different bytes. */
static void take_runs(struct runs *runs, const void *bytes, size_t size, size_t step)
{
    const uint8_t *at = bytes;
    for (size_t i = 0; i + RUN <= size && runs->n < RUNS_MAX; i += step) {
        if (is_telling(at + i)) {
            memcpy(runs->bytes[runs->n++], at + i, RUN);
        }
    }
}

static int take_item(void *context, const struct iso_gallery_item *item, struct iso_fault *fault)
{
    static struct iso_template tmpl;
    struct runs *runs = context;
    (void)fault;
    assert_true(item->n >= 1);
    assert_int_equal(iso_template_parse(item->templates[0].bytes, item->templates[0].size, &tmpl),
                     0);
    take_runs(runs, item->templates[0].bytes, item->templates[0].size, 96);
    take_runs(runs, &tmpl.points_mm, sizeof tmpl.points_mm, 512);
    take_runs(runs, &tmpl.upper, sizeof tmpl.upper, 64);
    return 0;
}

/* Reads the person's template from a copy of the daemon's stores. */
static void read_template(const struct appliance *appliance, struct runs *runs)
{
    struct iso_config config = iso_config_default();
    const struct iso_times times = iso_times_system();
    struct iso_components *borrowed = NULL;
    struct iso_fault fault = {.text = ""};
    struct run copy;
    const char *stores = scratch_path(appliance->directory, "copy");
    char command[1024];
    (void)snprintf(command, sizeof command, "rm -rf %s && mkdir %s && cp -p %s/[ag]* %s", stores,
                   stores, appliance->directory, stores);
    const char *const argv[] = {"/bin/sh", "-c", command, NULL};
    run_start(&copy, argv);
    run_finish(&copy);
    run_expect(&copy, 0);
    run_free(&copy);
    assert_int_equal(iso_config_load(appliance->configuration, &config, &fault), 0);
    (void)snprintf(config.gallery.path, sizeof config.gallery.path, "%s/gallery.db", stores);
    (void)snprintf(config.log.path, sizeof config.log.path, "%s/audit.log", stores);
    if (iso_components_open(&config, &times, false, &borrowed, &fault)) {
        fail_msg("%s", fault.text);
    }
    runs->n = 0;
    assert_int_equal(iso_gallery_export(borrowed->gallery, NAME, take_item, runs, &fault), 0);
    iso_components_close(borrowed);
    assert_true(runs->n >= 50);
}

struct found {
    int names, runs;
};

static struct found search(const struct appliance *appliance, const struct runs *runs, bool print)
{
    struct process_memory memory;
    struct found found = {0, 0};
    if (!process_memory_read(appliance->daemon.pid, &memory)) {
        print_message("skipped: only root can read the memory of the daemon\n");
        skip();
    }
    found.names = process_memory_count(&memory, NAME, strlen(NAME), print);
    for (int i = 0; i < runs->n; i++) {
        found.runs += process_memory_count(&memory, runs->bytes[i], RUN, print) > 0;
    }
    print_message("%zu kB: the name %d times, %d of %d pieces of the template\n",
                  memory.size / 1024, found.names, found.runs, runs->n);
    process_memory_free(&memory);
    return found;
}

/* Makes the daemon use the person in every way: list, name, recognise and record. */
static void use(struct appliance *appliance)
{
    static const char *const recordings[] = {"p01-v1", NULL};
    (void)appliance_visit(appliance, recordings);
    appliance_expect(appliance_run(appliance, "verify " NAME, "p01-v2"), 0);
    appliance_expect(appliance_run(appliance, "identify", "p01-v1"), 0);
    appliance_expect(appliance_run(appliance, "list", NULL), 0);
    appliance_expect(appliance_run(appliance, "log", NULL), 0);
    appliance_expect(appliance_run(appliance, "validity " NAME " --until 2099-01-01", NULL), 0);
}

static void remove_and_search(struct appliance *appliance)
{
    static struct runs runs;
    read_template(appliance, &runs);
    use(appliance);
    const struct found before = search(appliance, &runs, false);
    assert_true(before.names > 0);
    assert_true(before.runs > 0);
    appliance_expect(appliance_run(appliance, "remove " NAME, NULL), 0);
    appliance_expect(appliance_run(appliance, "status", NULL), 0);
    const struct found after = search(appliance, &runs, true);
    assert_int_equal(after.names, 0);
    assert_int_equal(after.runs, 0);
}

static void a_person_enrolled_by_this_process_leaves_no_trace(void **state)
{
    struct appliance *appliance = *state;
    appliance_expect(appliance_run(appliance, "enroll --quick " OTHER, "p02-enrol"), 0);
    appliance_expect(appliance_run(appliance, "enroll --quick " NAME, "p01-enrol"), 0);
    remove_and_search(appliance);
}

static void a_person_read_from_the_gallery_leaves_no_trace(void **state)
{
    struct appliance *appliance = *state;
    appliance_expect(appliance_run(appliance, "enroll --quick " NAME, "p01-enrol"), 0);
    appliance_end_daemon(appliance, SIGTERM);
    appliance_start_daemon(appliance);
    remove_and_search(appliance);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_person_enrolled_by_this_process_leaves_no_trace),
        cmocka_unit_test(a_person_read_from_the_gallery_leaves_no_trace),
    };

    if (!appliance_find()) {
        return TEST_SKIPPED;
    }
    return cmocka_run_group_tests(tests, appliance_setup, appliance_teardown);
}
