/* Reads the answers of the command line tool with --json. Failures fail the running cmocka test. */
#ifndef TEST_E2E_ANSWERS_H
#define TEST_E2E_ANSWERS_H

#include <jansson.h>

#include "tests/e2e/appliance.h"

/* The text of a member; "(none)" if the object has no such text. */
const char *answer_text(const json_t *object, const char *name);

/* The whole number of a member; 0 if the object has no such number. */
json_int_t answer_number(const json_t *object, const char *name);

/* How many people `isotherm list` names. */
size_t answer_people(const struct appliance *appliance);

/* Runs a command that has to end with this exit code and answer with this code of an error. */
void answer_expect_error(const struct appliance *appliance, const char *words, int exit,
                         const char *code);

#endif
