/* Reads the answers of the command line tool with --json. Failures fail the running cmocka test. */
#ifndef TEST_E2E_ANSWERS_H
#define TEST_E2E_ANSWERS_H

#include <jansson.h>

#include "tests/e2e/appliance.h"

/* Returns the text of a member, or "(none)" if the object has no such text. */
const char *answer_text(const json_t *object, const char *name);

/* Returns the whole number of a member, or 0 if the object has no such number. */
json_int_t answer_number(const json_t *object, const char *name);

/* Returns how many people `isotherm list` names. */
size_t answer_people(const struct appliance *appliance);

/* Runs a command. It has to end with this exit code and print this error code. */
void answer_expect_error(const struct appliance *appliance, const char *words, int exit,
                         const char *code);

#endif
