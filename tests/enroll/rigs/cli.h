/* Runs the program `isotherm` against a scripted daemon on a private bus. */
#ifndef TEST_CLI_H
#define TEST_CLI_H

#include <jansson.h>
#include <stdbool.h>

#include "tests/enroll/rigs/fake_daemon.h"
#include "tests/support/programs/private_bus.h"
#include "tests/support/programs/run.h"

/* A daemon with two people. anna has two templates and is valid until 30 December 2026, Bo Ek has
 * one template and is valid from 21 November 2026. */
extern const struct fake_script cli_two_people;

/* Starts the bus that all tests of a program share. Returns false if the program has to skip its
 * tests. */
bool cli_find_bus(void);

/* cmocka tear-down of the group: stops the bus. */
int cli_teardown(void **state);

struct cli_result {
    int exit;
    const char *what; /* the command line */
    const char *out, *err,
        *calls; /* calls: the calls to the daemon; all three are valid until the next run */
};

/* Runs `isotherm --bus ADDRESS WORDS`. Single blanks separate the words. If `script` is NULL, no
 * daemon is on the bus. */
struct cli_result cli_run(const struct fake_script *script, const char *words);

/* Runs `isotherm WORDS`. The test's bus is the system bus for this run, and no daemon is on it. */
struct cli_result cli_run_on_system_bus(const char *words);

/* Like cli_run, but standard output is a file, such as /dev/full. result.out is "". */
struct cli_result cli_run_to(const char *path, const struct fake_script *script, const char *words);

/* Like cli_run, but on a terminal of 80 columns. result.out has both outputs of the program; the
 * caller frees it. `environment` is one NAME=VALUE that is added to the environment, or NULL. */
struct cli_result cli_run_on_terminal(const struct fake_script *script, const char *words,
                                      const char *environment);

/* Like cli_run, but the program gets a SIGINT as soon as its stdout contains `text`. */
struct cli_result cli_run_interrupt(const struct fake_script *script, const char *words,
                                    const char *text);

/* Parses stdout, which has to be exactly one JSON document. The caller releases it. */
json_t *cli_json(const struct cli_result *result);

/* Fails the test unless the program ended with this exit code. The message has the command line,
 * the exit code and the outputs. */
void cli_expect_exit(const struct cli_result *result, int exit);

/* Fails the test unless the program ended with this exit code, and stdout is an error document with
 * this error code and this exit code. */
void cli_expect_error(const struct cli_result *result, int exit, const char *code);

#endif
