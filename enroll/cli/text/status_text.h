/* The state of the appliance as people read it: sections, plain names, units. */
#ifndef CLI_TEXT_STATUS_TEXT_H
#define CLI_TEXT_STATUS_TEXT_H

#include <jansson.h>
#include <stdio.h>

/* Prints what there is in the daemon's status (enroll/cli/client/state.h). What nobody but a
 * program wants is left out. */
void cli_status_print(const json_t *state, FILE *out);

#endif
