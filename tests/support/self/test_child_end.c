/* A test that fails says why in its last line. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "tests/support/child_end.h"
#include "tests/support/programs/run.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

/* The n-th line from the end of a text that ends with a line feed; 0 is the last line. */
static const char *line_from_end(const char *text, size_t n)
{
    static char line[1024];
    const char *end = text + strlen(text);

    for (size_t i = 0; i <= n + 1 && end > text; i++) {
        const char *at = end - 1;
        while (at > text && at[-1] != '\n') {
            at--;
        }
        if (i == n) {
            (void)snprintf(line, sizeof line, "%.*s", (int)strcspn(at, "\n"), at);
            return line;
        }
        end = at;
    }
    return "";
}

static void the_last_lines_say_why(void **state)
{
    static const char *const reasons[] = {
        /* the last reason comes first */
        "a_number_is_wrong: 0x100 != 0",
        "a_script_ends_wrongly: sh -c 'exit 7': ended with exit code 7, not exit code 0; it said "
        "nothing",
        "a_program_ends_wrongly: isotherm list: ended with exit code 1, not exit code 0; last it "
        "said: nobody",
        "a_child_is_killed: a daemon: ended with signal 9 (Killed), not exit code 0; it said "
        "nothing",
        "a_child_ends_wrongly: a daemon with a broken sensor: ended with exit code 3, not exit "
        "code "
        "0; last it said: the sensor is gone",
    };
    static const char *const argv[] = {ISOTHERM_BINARY_DIR "/tests/support/fails_on_purpose", NULL};
    struct run run;

    (void)state;
    run_start(&run, argv);
    run_finish(&run);
    run_expect(&run, (int)COUNT(reasons));
    for (size_t i = 0; i < COUNT(reasons); i++) {
        const char *line = line_from_end(run.err, i);
        if (!strstr(line, reasons[i]) || !strstr(line, ".c:")) {
            fail_msg("line %zu from the end is '%s', not '... %s'", i, line, reasons[i]);
        }
    }
    run_free(&run);
}

static void an_expected_end_prints_nothing(void **state)
{
    char err[CHILD_ERR_SIZE];
    struct child child;

    (void)state;
    child_expect_code("what is right", 4, 4, "out", "err");
    if (child_fork(&child, "a child") == 0) {
        fputs("what it says\n", stderr);
        _exit(5);
    }
    assert_int_equal(child_wait(&child, err), 5);
    assert_string_equal(err, "what it says\n");
    if (child_fork(&child, "a child") == 0) {
        (void)raise(SIGKILL);
    }
    assert_int_equal(child_wait(&child, err), 1000 + SIGKILL);
}

/* If a child prints more than fits, the end is kept. */
static void the_end_of_a_long_output_is_kept(void **state)
{
    char err[CHILD_ERR_SIZE];
    struct child child;

    (void)state;
    if (child_fork(&child, "a child") == 0) {
        for (int i = 0; i < 5000; i++) {
            fprintf(stderr, "line %d\n", i);
        }
        _exit(0);
    }
    assert_int_equal(child_wait(&child, err), 0);
    assert_string_equal(line_from_end(err, 0), "line 4999");
    assert_string_equal(line_from_end(err, 1), "line 4998");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_last_lines_say_why),
        cmocka_unit_test(an_expected_end_prints_nothing),
        cmocka_unit_test(the_end_of_a_long_output_is_kept),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
