/* Verdicts of scripts (verdict.sh) are in colour on a terminal with colours, otherwise plain. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdlib.h>

#include "tests/support/devices/pseudo_terminal.h"
#include "tests/support/programs/run.h"

#define SCRIPT \
    ". " ISOTHERM_SOURCE_DIR "/tests/support/verdict.sh; paint bad wrong; echo; say_tally 12 0 1"

static const char *const argv[] = {"/bin/sh", "-c", SCRIPT, NULL};

static void expect(const char *environment, const char *text)
{
    int status = 0;
    char *said = pseudo_terminal_run(argv, 80, environment, &status);

    assert_string_equal(said, text);
    free(said);
}

static void a_terminal_gets_colours_if_it_wants_them(void **state)
{
    (void)state;
    expect(NULL, "\033[31mwrong\033[0m\r\n\033[32m12 passed\033[0m, 0 failed, "
                 "\033[33m1 skipped\033[0m\r\n");
    expect("NO_COLOR=1", "wrong\r\n12 passed, 0 failed, 1 skipped\r\n");
    expect("TERM=dumb", "wrong\r\n12 passed, 0 failed, 1 skipped\r\n");
}

static void a_pipe_gets_plain_text(void **state)
{
    struct run run;

    (void)state;
    run_start(&run, argv);
    run_finish(&run);
    assert_string_equal(run.out, "wrong\n12 passed, 0 failed, 1 skipped\n");
    run_expect(&run, 0);
    run_free(&run);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_terminal_gets_colours_if_it_wants_them),
        cmocka_unit_test(a_pipe_gets_plain_text),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
