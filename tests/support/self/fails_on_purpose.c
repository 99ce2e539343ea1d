/* Every test of this program fails; test_child_end checks the lines that it prints at its end. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "tests/support/child_end.h"

static void a_child_ends_wrongly(void **state)
{
    struct child child;

    (void)state;
    if (child_fork(&child, "a daemon with a broken sensor") == 0) {
        fputs("starting\nthe sensor is gone\n\n", stderr);
        _exit(3);
    }
    child_expect(&child, 0);
}

static void a_child_is_killed(void **state)
{
    struct child child;

    (void)state;
    if (child_fork(&child, "a daemon") == 0) {
        (void)raise(SIGKILL);
    }
    child_expect(&child, 0);
}

static void a_program_ends_wrongly(void **state)
{
    (void)state;
    child_expect_code("isotherm list", 1, 0, "first\nnobody\n", "");
}

static void a_script_ends_wrongly(void **state)
{
    (void)state;
    child_expect_code("sh -c 'exit 7'", child_code(system("exit 7")), 0, NULL, NULL);
}

static void a_number_is_wrong(void **state)
{
    (void)state;
    assert_int_equal(256, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_child_ends_wrongly),   cmocka_unit_test(a_child_is_killed),
        cmocka_unit_test(a_program_ends_wrongly), cmocka_unit_test(a_script_ends_wrongly),
        cmocka_unit_test(a_number_is_wrong),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
