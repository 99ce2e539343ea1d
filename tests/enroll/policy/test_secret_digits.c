/* A PIN at a terminal: asked for twice, and never shown. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <pty.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "enroll/cli/policy/secret_digits.h"

static int terminal;
static char said[4096];
static size_t length;

/* Starts the question on a terminal. The child ends with 0 if it reads 4711, with 1 if it is told
 * so, and with 2 else. */
static pid_t start(void)
{
    const pid_t pid = forkpty(&terminal, NULL, NULL, NULL);

    assert_true(pid >= 0);
    if (pid == 0) {
        char pin[CLI_PIN_SIZE] = "";
        struct cli_fault fault = {.text = ""};
        (void)prctl(PR_SET_PDEATHSIG, SIGKILL);
        const enum cli_exit exit = cli_pin_ask("PIN", pin, &fault);
        fprintf(stderr, "%s\n", fault.text);
        _exit(exit == CLI_EXIT_USAGE ? 1 : strcmp(pin, "4711") == 0 ? 0 : 2);
    }
    length = 0;
    said[0] = '\0';
    return pid;
}

/* Waits until the program has said the text; NULL: until its end. */
static void wait_for(const char *text)
{
    ssize_t n = 1;

    while ((!text || !strstr(said, text)) &&
           (n = read(terminal, said + length, sizeof said - 1 - length)) > 0) {
        length += (size_t)n;
        said[length] = '\0';
    }
    if (text && n <= 0) {
        fail_msg("'%s' was never said, but: %s", text, said);
    }
}

static void answer(const char *question, const char *text)
{
    wait_for(question);
    assert_int_equal(write(terminal, text, strlen(text)), strlen(text));
}

static int finish(pid_t pid)
{
    int status = 0;

    wait_for(NULL);
    close(terminal);
    assert_int_equal(waitpid(pid, &status, 0), pid);
    assert_true(WIFEXITED(status));
    return WEXITSTATUS(status);
}

static void it_asks_twice_without_echo(void **state)
{
    const pid_t pid = start();

    (void)state;
    answer("PIN: ", "4711\n");
    answer("PIN once more: ", "4711\n");
    assert_int_equal(finish(pid), 0);
    assert_null(strstr(said, "4711"));
}

static void two_that_differ(void **state)
{
    const pid_t pid = start();

    (void)state;
    answer("PIN: ", "4711\n");
    answer("PIN once more: ", "4712\n");
    assert_int_equal(finish(pid), 1);
    assert_non_null(strstr(said, "the two PINs differ"));
}

static void the_first_one_is_wrong(void **state)
{
    const pid_t pid = start();

    (void)state;
    answer("PIN: ", "47\n");
    assert_int_equal(finish(pid), 1);
    assert_non_null(strstr(said, "a PIN has 4 to 9 digits"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_asks_twice_without_echo),
        cmocka_unit_test(two_that_differ),
        cmocka_unit_test(the_first_one_is_wrong),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
