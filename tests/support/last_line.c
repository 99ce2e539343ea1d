/* Linked into every test program: at its end it prints once more which tests failed and why, so
 * that the last line of the output of a failed test is the reason. cmocka prints the reason in the
 * middle and ends with a count. This file replaces cmocka's print_error() and print_message(),
 * which a program may do, and collects the reasons from their output. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { FAILURES_MAX = 8, TEXT_SIZE = 1024 };

static struct {
    char why[TEXT_SIZE], where[TEXT_SIZE], name[TEXT_SIZE];
} failures[FAILURES_MAX];

static size_t n_failures;
static pid_t tester; /* a forked child must not print the list */

__attribute__((constructor)) static void remember_who_tests(void)
{
    tester = getpid();
}

/* Copies the text after `prefix` up to one of the letters of `end`. False if there is no such text.
 */
static bool take_behind(const char *prefix, const char *text, const char *end, char copy[TEXT_SIZE])
{
    const char *start = strstr(text, prefix);

    if (start) {
        start += strlen(prefix);
        (void)snprintf(copy, TEXT_SIZE, "%.*s", (int)strcspn(start, end), start);
    }
    return start;
}

/* cmocka prints a failure in several calls: first the reason (by fail_msg(), or by an assertion
 * with its line), then the name of the test. Its list at the very end repeats the names. */
static void listen(const char *text)
{
    static char why[TEXT_SIZE], where[TEXT_SIZE];
    char own[TEXT_SIZE];

    (void)take_behind("[   LINE   ] --- ", text, " \n", where);
    if (strncmp(text, "ERROR: ", 7) == 0) {
        (void)take_behind("ERROR: ", text, "\n", why);
    } else if (take_behind("[  ERROR   ] --- ", text, "\n", own) && own[0] && own[0] != '[') {
        memcpy(why, own, sizeof why);
    } else if ((why[0] || where[0]) && take_behind("[  FAILED  ] ", text, " \n", own)) {
        if (n_failures < FAILURES_MAX) {
            memcpy(failures[n_failures].why, why, sizeof why);
            memcpy(failures[n_failures].where, where, sizeof where);
            memcpy(failures[n_failures].name, own, sizeof own);
            n_failures++;
        }
        why[0] = where[0] = '\0';
    }
}

static void say(FILE *out, const char *format, va_list arguments)
{
    char text[TEXT_SIZE];
    va_list copy;

    va_copy(copy, arguments);
    (void)vsnprintf(text, sizeof text, format, copy);
    va_end(copy);
    (void)vfprintf(out, format, arguments);
    (void)fflush(out);
    listen(text);
}

void print_message(const char *const format, ...)
{
    va_list arguments;

    va_start(arguments, format);
    say(stdout, format, arguments);
    va_end(arguments);
}

void print_error(const char *const format, ...)
{
    va_list arguments;

    va_start(arguments, format);
    say(stderr, format, arguments);
    va_end(arguments);
}

__attribute__((destructor)) static void say_why(void)
{
    if (getpid() != tester) {
        return;
    }
    (void)fflush(stdout);
    for (size_t i = 0; i < n_failures; i++) {
        fprintf(stderr, "%s %s: %s\n", failures[i].where, failures[i].name,
                failures[i].why[0] ? failures[i].why : "an assertion failed");
    }
    (void)fflush(stderr);
}
