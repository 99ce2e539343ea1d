/* Runs the program `isotherm` against a scripted daemon on a private bus. */
#ifndef TEST_CLI_H
#define TEST_CLI_H

#include <jansson.h>
#include <stdbool.h>

#include "tests/enroll/rigs/fake_daemon.h"
#include "tests/support/programs/private_bus.h"
#include "tests/support/programs/run.h"

/* A daemon with two people: anna, with two templates and until the end of 2026, and Bo Ek. */
extern const struct fake_script cli_two_people;

/* Starts the bus that all tests of a program share; false if the program is to be skipped. */
bool cli_find_bus(void);

/* cmocka tear-down of the group: stops it. */
int cli_teardown(void **state);

struct cli_result {
    int exit;
    const char *what;              /* the command line */
    const char *out, *err, *calls; /* what the daemon got; valid until the next run */
};

/* isotherm --bus ADDRESS WORDS, the words being separated by single blanks. `script` NULL: nobody
 * is at the other end. */
struct cli_result cli_run(const struct fake_script *script, const char *words);

/* isotherm WORDS with nobody on the bus, which is the system's for this run. */
struct cli_result cli_run_on_system_bus(const char *words);

/* The same with standard output to a file, such as /dev/full; result.out is "". */
struct cli_result cli_run_to(const char *path, const struct fake_script *script, const char *words);

/* The same on a terminal of 80 columns, which gets both outputs (result.out, to be freed by the
 * caller); `environment` is one NAME=VALUE that is added, or NULL. */
struct cli_result cli_run_on_terminal(const struct fake_script *script, const char *words,
                                      const char *environment);

/* The same; but as soon as `text` stands in stdout, the program gets a SIGINT. */
struct cli_result cli_run_interrupt(const struct fake_script *script, const char *words,
                                    const char *text);

/* Parses stdout, which has to be exactly one JSON document; the caller releases it. */
json_t *cli_json(const struct cli_result *result);

/* Fails the test, saying what it was, how it ended and what it said, unless it ended like that. */
void cli_expect_exit(const struct cli_result *result, int exit);

/* Fails the test unless stdout is an error document with this code and the exit code of the run. */
void cli_expect_error(const struct cli_result *result, int exit, const char *code);

#endif
