/* The factory reset of a whole appliance: while it is begun and not finished the daemon does not
 * start, and afterwards the person who was admitted is a stranger. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <signal.h>
#include <stdio.h>
#include <string.h>

#include "tests/e2e/appliance.h"
#include "tests/support/child_end.h"
#include "tests/support/scratch.h"

static const char isothermd[] = ISOTHERM_BINARY_DIR "/firmware/isothermd";

/* An appliance whose folders of other services are its own, whatever this machine has. */
static int set_up(void **state)
{
    static char keys[1024];
    const int r = appliance_setup(state);
    struct appliance *appliance = *state;

    (void)snprintf(keys, sizeof keys,
                   "[reset]\nweb = %s/web\nlink = %s/link\ncredential = %s/credential\n",
                   appliance->directory, appliance->directory, appliance->directory);
    appliance_end_daemon(appliance, SIGTERM);
    appliance->keys = keys;
    appliance_configure(appliance);
    scratch_mkdir(scratch_path(appliance->directory, "web"));
    scratch_write_text(scratch_path(scratch_path(appliance->directory, "web"), "accounts"), "ada");
    appliance_start_daemon(appliance);
    return r;
}

/* Runs the program with these files, and expects its end. */
static void expect_end(const struct appliance *appliance, const char *option, int exit,
                       const char *says)
{
    const char *const argv[] = {isothermd, "--config", appliance->configuration, option, NULL};
    struct run run;

    run_start(&run, argv);
    run_finish(&run);
    child_expect_code(option ? option : "isothermd", run.exit, exit, run.out, run.err);
    if (!strstr(run.err, says) && !strstr(run.out, says)) {
        fail_msg("%s does not say '%s': %s%s", option ? option : "isothermd", says, run.out,
                 run.err);
    }
    run_free(&run);
}

/* Plays a visit of p01, and returns how often the door has admitted somebody since its start. */
static json_int_t visits_allowed(const struct appliance *appliance)
{
    const char *const visit[] = {"p01-v1", NULL};

    (void)appliance_visit(appliance, visit); /* it expects that p01 is admitted */
    json_t *status = appliance_run_json(appliance, "status", NULL, 0);
    const json_int_t allowed = json_integer_value(json_object_get(status, "visits-allowed"));
    assert_true(allowed + json_integer_value(json_object_get(status, "visits-denied")) > 0);
    json_decref(status);
    return allowed;
}

static void whoever_was_enrolled_is_a_stranger_after_a_reset(void **state)
{
    struct appliance *appliance = *state;

    appliance_expect(appliance_run(appliance, "enroll --quick p01", "p01-enrol"), 0);
    assert_true(visits_allowed(appliance) > 0);
    expect_end(appliance, "--factory-reset", 4, "a daemon runs: stop it first");
    assert_true(visits_allowed(appliance) > 1);
    appliance_end_daemon(appliance, SIGKILL);
    appliance->daemon.exit = 0; /* that was the test */

    /* The power fails directly after the reset was begun. */
    scratch_write_text(scratch_path(appliance->directory, "factory-reset"), "");
    expect_end(appliance, NULL, 4, "a factory reset was begun");
    expect_end(appliance, "--print-log", 4, "a factory reset was begun");
    expect_end(appliance, "--accept-state", 4, "a factory reset was begun");
    expect_end(appliance, "--finish-reset", 4, "the appliance is reset");
    expect_end(appliance, "--finish-reset", 0, "");
    assert_false(scratch_exists(scratch_path(appliance->directory, "gallery.db")));
    assert_false(
        scratch_exists(scratch_path(scratch_path(appliance->directory, "web"), "accounts")));

    appliance_start_daemon(appliance);
    assert_int_equal(visits_allowed(appliance), 0);
    json_t *list = appliance_run_json(appliance, "list", NULL, 0);
    assert_int_equal(json_array_size(json_object_get(list, "people")), 0);
    json_decref(list);
    const struct appliance_result *result = appliance_run(appliance, "log verify", NULL);
    appliance_expect(result, 0);
    assert_non_null(strstr(result->out, "records 1 to "));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(whoever_was_enrolled_is_a_stranger_after_a_reset),
    };

    if (!appliance_find()) {
        return TEST_SKIPPED;
    }
    return cmocka_run_group_tests(tests, set_up, appliance_teardown);
}
