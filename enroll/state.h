/* What GetStatus tells, as a JSON object: the bus dictionary with its names and types kept. */
#ifndef CLI_STATE_H
#define CLI_STATE_H

#include <jansson.h>

#include "enroll/door.h"

/* The caller releases *out with json_decref(). Faults of cli_door_send(), "bad-reply". */
enum cli_exit cli_state_fetch(struct cli_door *door, json_t **out, struct cli_fault *fault)
    __attribute__((warn_unused_result));

/* The text of a member; NULL if there is none or it is no text. Belongs to `state`. */
const char *cli_state_text(const json_t *state, const char *name);

/* The whole number of a member; `otherwise` if there is none or it is no number. */
json_int_t cli_state_number(const json_t *state, const char *name, json_int_t otherwise);

#endif
