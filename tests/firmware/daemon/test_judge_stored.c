/* `isothermd --judge` on stored people, the installed ones among them: who is recognised, and one
 * line for each reason why frames are not judged as they have to be. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/support/programs/run.h"
#include "tests/support/scratch.h"

#define PROGRAM ISOTHERM_BINARY_DIR "/firmware/isothermd"
#define DATA    ISOTHERM_SOURCE_DIR "/core/data"
#define STORED  ISOTHERM_SOURCE_DIR "/sim/stored/"

/* Makes the three recordings; NULL: this one is left as it is. */
static void link_recordings(const char *directory, const char *enrolled, const char *other,
                            const char *visitor)
{
    const char *const names[][2] = {{"enrolled", enrolled}, {"other", other}, {"visitor", visitor}};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        const char *path = scratch_path(directory, names[i][0]);
        char target[256];
        (void)snprintf(target, sizeof target, STORED "%s", names[i][1] ? names[i][1] : "");
        assert_true(!names[i][1] || symlink(target, path) == 0);
    }
}

/* Judges the recordings in `directory`. The result is valid until the next call. */
static const struct run *judge(const char *directory, const char *configuration)
{
    static struct run run;
    const char *path = scratch_path(directory, "c.conf");
    const char *const argv[] = {PROGRAM, "--config", path, "--judge", directory, NULL};
    run_free(&run);
    scratch_write_text(path, configuration);
    run_start(&run, argv);
    run_finish(&run);
    return &run;
}

static void expect_fault(const struct run *run, int exit, const char *line)
{
    run_expect(run, exit);
    assert_string_equal(run->out, "");
    if (!strstr(run->err, line)) {
        fail_msg("'%s' is not in: %s", line, run->err);
    }
    assert_string_equal(strchr(run->err, '\n'), "\n"); /* there is only one line */
}

static void recognises_the_enrolled_person(void **state)
{
    double score, other;
    link_recordings(*state, "p01-v2", "p02-v1", "p01-v1");
    const struct run *run = judge(*state, "");
    run_expect(run, 0);
    assert_int_equal(sscanf(run->out, "the visitor is recognised: score %lf, and %lf for another",
                            &score, &other),
                     2);
    assert_true(score >= 3.0 && other < 3.0);
}

/* Settings of the door change nothing: its range and its level. */
static void settings_of_the_door_do_not_count(void **state)
{
    link_recordings(*state, "p01-v2", "p02-v1", "p01-v1");
    run_expect(judge(*state, "[sensor]\ndistance_min_mm = 1400\n[decision]\nthreshold = 90\n"
                             "[update]\ntemplates = 0\n"),
               0);
}

static void ranks_by_a_method_that_is_not_calibrated(void **state)
{
    link_recordings(*state, "p01-v2", "p02-v1", "p01-v1");
    const struct run *run = judge(*state, "[match]\nmethod = distance\n[decision]\n"
                                          "threshold = 2\n[update]\ntemplates = 0\n");
    run_expect(run, 0);
    assert_non_null(strstr(run->out, "the visitor is recognised"));
}

static void refuses_other_people(void **state)
{
    link_recordings(*state, "p01-v2", "p02-v1", "p02-v2");
    expect_fault(judge(*state, ""), 4, "the visitor is taken for another person: score ");
}

static void refuses_strangers(void **state)
{
    link_recordings(*state, "p01-v2", "p02-v1", "p03-v1");
    const struct run *run = judge(*state, "");
    run_expect(run, 4);
    assert_true(strstr(run->err, "the scores are wrong: ") ||
                strstr(run->err, "taken for another person: "));
}

static void names_the_recording_at_fault(void **state)
{
    link_recordings(*state, "p01-v2", "p02-v1", NULL);
    expect_fault(judge(*state, ""), 3, "visitor: ");
    link_recordings(*state, NULL, NULL, "none-back1");
    expect_fault(judge(*state, ""), 4, "visitor: no frame is usable; the last one is judged as '");
}

static void refuses_a_damaged_model(void **state)
{
    char configuration[256];
    size_t size;
    char *bytes = scratch_read(DATA "/head.model", &size);
    const char *path = scratch_path(*state, "head.model");
    scratch_write(path, bytes, size / 2);
    free(bytes);
    link_recordings(*state, "p01-v2", "p02-v1", "p01-v1");
    (void)snprintf(configuration, sizeof configuration, "[model]\nhead = %s\n", path);
    expect_fault(judge(*state, configuration), 4, "head.model: ");
}

int main(void)
{
#define IN_SCRATCH(test) cmocka_unit_test_setup_teardown(test, scratch_setup, scratch_teardown)
    const struct CMUnitTest tests[] = {
        IN_SCRATCH(recognises_the_enrolled_person),
        IN_SCRATCH(settings_of_the_door_do_not_count),
        IN_SCRATCH(ranks_by_a_method_that_is_not_calibrated),
        IN_SCRATCH(refuses_other_people),
        IN_SCRATCH(refuses_strangers),
        IN_SCRATCH(names_the_recording_at_fault),
        IN_SCRATCH(refuses_a_damaged_model),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
