/* The state of the appliance for people, in sections, with plain names and units. */
#ifndef CLI_TEXT_STATUS_TEXT_H
#define CLI_TEXT_STATUS_TEXT_H

#include <jansson.h>
#include <stdio.h>

/* Prints the daemon's status (enroll/cli/client/state.h) without the values that only programs
 * use. */
void cli_status_print(const json_t *state, FILE *out);

#endif
