/* The result of GetStatus as a JSON object with the names and types of the bus dictionary. */
#ifndef CLI_CLIENT_STATE_H
#define CLI_CLIENT_STATE_H

#include <jansson.h>

#include "enroll/cli/client/daemon.h"

/* Reads an a{sv} of texts, lists of texts, numbers and booleans from a message, as a JSON object
 * with its names and types. The caller releases *out with json_decref(). -EBADMSG for a value of
 * another type, -ENOMEM, errors of sd_bus_message_read(). */
int cli_state_read(sd_bus_message *message, json_t **out) __attribute__((warn_unused_result));

/* Reads an array of texts from a message. The caller releases *out with json_decref(). -ENOMEM,
 * errors of sd_bus_message_read_basic(). */
int cli_state_read_texts(sd_bus_message *message, json_t **out) __attribute__((warn_unused_result));

/* Asks the daemon for its status. The caller releases *out with json_decref(). Faults of
 * cli_daemon_send(), and "bad-reply". */
enum cli_exit cli_state_fetch(struct cli_daemon *daemon, json_t **out, struct cli_fault *fault)
    __attribute__((warn_unused_result));

/* The text of a member; NULL if there is none or it is not a text. It belongs to `state`. */
const char *cli_state_text(const json_t *state, const char *name);

/* The number of a member; NaN if there is none or it is not a number. */
double cli_state_real(const json_t *state, const char *name);

/* The whole number of a member; `otherwise` if there is none or it is not a whole number. */
json_int_t cli_state_number(const json_t *state, const char *name, json_int_t otherwise);

#endif
