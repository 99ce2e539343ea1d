#include "tests/enroll/rigs/cli.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/child_end.h"
#include "tests/support/devices/pseudo_terminal.h"

static const char isotherm[] = ISOTHERM_BINARY_DIR "/enroll/isotherm";

static const struct fake_person people[] = {
    {"anna", 1795248000, 0, 1798675199, 2},
    {"Bo Ek", 1795248060, 1795300000, 0, 1},
};

const struct fake_script cli_two_people = {.people = people, .n_people = 2};

static struct private_bus bus;
static struct run last;
static const char *out_path; /* standard output of the next run; NULL: a pipe */

enum { WORDS_MAX = 24 };

/* Writes the words of the command line `isotherm --bus ADDRESS WORDS` to argv, which ends with
 * NULL. They are valid until the next call. */
static void make_argv(const char *words, const char *argv[WORDS_MAX])
{
    static char copy[512];
    size_t argc = 3;

    memset(argv, 0, WORDS_MAX * sizeof *argv);
    argv[0] = isotherm;
    argv[1] = "--bus";
    argv[2] = bus.address;
    (void)snprintf(copy, sizeof copy, "%s", words);
    for (char *word = strtok(copy, " "); word; word = strtok(NULL, " ")) {
        assert_true(argc < WORDS_MAX - 1);
        argv[argc++] = word;
    }
}

static void start(const char *words)
{
    const char *argv[WORDS_MAX];

    make_argv(words, argv);
    run_free(&last);
    run_start_to(&last, argv, out_path);
}

struct cli_result cli_run_interrupt(const struct fake_script *script, const char *words,
                                    const char *text)
{
    struct fake_daemon daemon;
    struct cli_result result = {.calls = ""};

    if (script) {
        fake_daemon_start(&daemon, bus.address, script);
    }
    start(words);
    if (text) {
        run_until(&last, text);
        kill(last.pid, SIGINT);
    }
    run_finish(&last);
    if (script) {
        result.calls = fake_daemon_stop(&daemon);
    }
    result.exit = last.exit;
    result.what = last.what;
    result.out = last.out;
    result.err = last.err;
    return result;
}

struct cli_result cli_run(const struct fake_script *script, const char *words)
{
    return cli_run_interrupt(script, words, NULL);
}

struct cli_result cli_run_on_system_bus(const char *words)
{
    const char *argv[WORDS_MAX];

    make_argv(words, argv);
    memmove(argv + 1, argv + 3, (WORDS_MAX - 3) * sizeof *argv); /* removes --bus ADDRESS */
    run_free(&last);
    setenv("DBUS_SYSTEM_BUS_ADDRESS", bus.address, 1);
    run_start(&last, argv);
    unsetenv("DBUS_SYSTEM_BUS_ADDRESS");
    run_finish(&last);
    return (struct cli_result){
        .exit = last.exit, .what = last.what, .out = last.out, .err = last.err, .calls = ""};
}

struct cli_result cli_run_to(const char *path, const struct fake_script *script, const char *words)
{
    out_path = path;
    const struct cli_result result = cli_run(script, words);
    out_path = NULL;
    return result;
}

struct cli_result cli_run_on_terminal(const struct fake_script *script, const char *words,
                                      const char *environment)
{
    struct cli_result result = {.err = ""};
    struct fake_daemon daemon;
    const char *argv[WORDS_MAX];
    int status = 0;

    fake_daemon_start(&daemon, bus.address, script);
    make_argv(words, argv);
    result.out = pseudo_terminal_run(argv, 80, environment, &status);
    result.calls = fake_daemon_stop(&daemon);
    result.exit = child_code(status);
    result.what = words;
    return result;
}

void cli_expect_exit(const struct cli_result *result, int exit)
{
    child_expect_code(result->what, result->exit, exit, result->out, result->err);
}

json_t *cli_json(const struct cli_result *result)
{
    json_error_t error;
    json_t *document = json_loads(result->out, 0, &error);

    if (!document) {
        fail_msg("%s in: %s%s", error.text, result->out, result->err);
    }
    return document;
}

void cli_expect_error(const struct cli_result *result, int exit, const char *code)
{
    json_t *document = cli_json(result);
    json_t *error = json_object_get(document, "error");

    assert_string_equal(json_string_value(json_object_get(error, "code")), code);
    assert_int_equal(json_integer_value(json_object_get(error, "exit_code")), exit);
    assert_true(strlen(json_string_value(json_object_get(error, "message"))) > 0);
    cli_expect_exit(result, exit);
    json_decref(document);
}

bool cli_find_bus(void)
{
    return private_bus_start(&bus);
}

int cli_teardown(void **state)
{
    (void)state;
    run_free(&last);
    private_bus_stop(&bus);
    return 0;
}
