/* The example clients of the bus, while somebody enrolled and a stranger come to the door of a
 * whole appliance. The tests are one story and run in this order. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <string.h>
#include <unistd.h>

#include "tests/e2e/appliance.h"

#define WATCH_DOOR ISOTHERM_BINARY_DIR "/enroll/examples/example_watch_door"
#define VISITS     ISOTHERM_SOURCE_DIR "/enroll/examples/visits.py"
#define PYTHON     "/usr/bin/python3"

static const char state_of_one_person[] = "version: " ISOTHERM_VERSION "\n";

static void expect_text(const struct run *run, const char *text)
{
    if (!strstr(run->out, text)) {
        fail_msg("%s does not print '%s':\n%s%s", run->what, text, run->out, run->err);
    }
}

/* Expects the lines about the appliance that both clients print. */
static void expect_state(const struct run *run)
{
    expect_text(run, state_of_one_person);
    expect_text(run, "sensor-state: started\n");
    expect_text(run, "door-state: locked\n");
    expect_text(run, "people: 1\n");
    expect_text(run, "enrolled: p01, 1 template(s)\n");
}

static void the_client_in_c_prints_each_visit(void **state)
{
    const struct appliance *appliance = *state;
    const char *const argv[] = {WATCH_DOOR, appliance->bus.address, "2", NULL};
    const char *const visits[] = {"p01-v1", "x01-v1", NULL};
    struct run run;

    appliance_expect(appliance_run(appliance, "enroll --quick p01", "p01-enrol"), 0);
    run_start(&run, argv);
    run_until(&run, "watching\n");
    expect_state(&run);
    appliance_expect(appliance_visit(appliance, visits), 0);
    run_finish(&run);
    run_expect(&run, 0);
    expect_text(&run, "\nvisit: allow p01, score ");
    expect_text(&run, ", door unlocked\n");
    expect_text(&run, "\nvisit: deny (unknown), score ");
    run_free(&run);
}

static void the_client_in_python_prints_the_visits_of_the_log(void **state)
{
    const struct appliance *appliance = *state;
    const char *const module[] = {PYTHON, "-c", "import dbus", NULL};
    const char *const argv[] = {PYTHON, VISITS, appliance->bus.address, NULL};
    struct run run;

    if (access(PYTHON, X_OK)) {
        print_message("skipped: there is no " PYTHON "\n");
        skip();
    }
    run_start(&run, module);
    run_finish(&run);
    const int missing = run.exit;
    run_free(&run);
    if (missing) {
        print_message("skipped: python3-dbus is missing\n");
        skip();
    }
    run_start(&run, argv);
    run_finish(&run);
    run_expect(&run, 0);
    expect_state(&run);
    expect_text(&run, " allow p01, ");
    expect_text(&run, " deny (unknown), ");
    run_free(&run);
}

static void a_client_that_finds_no_daemon_says_so(void **state)
{
    (void)state;
    const char *const argv[] = {WATCH_DOOR, "unix:path=/nonexistent", "1", NULL};
    struct run run;

    run_start(&run, argv);
    run_finish(&run);
    run_expect(&run, 1);
    assert_non_null(strstr(run.err, "No such file"));
    run_free(&run);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_client_in_c_prints_each_visit),
        cmocka_unit_test(the_client_in_python_prints_the_visits_of_the_log),
        cmocka_unit_test(a_client_that_finds_no_daemon_says_so),
    };

    return appliance_find() ? cmocka_run_group_tests(tests, appliance_setup, appliance_teardown)
                            : TEST_SKIPPED;
}
