/* The person who already has the name of an enrolment, as the daemon reports at its beginning. */
#ifndef CLI_TEXT_KNOWN_H
#define CLI_TEXT_KNOWN_H

#include <stdint.h>
#include <stdio.h>
#include <systemd/sd-bus.h>

enum { CLI_KNOWN_NAME_SIZE = 260 };

struct cli_known {
    char person[CLI_KNOWN_NAME_SIZE]; /* as it is spelt there; "": nobody has the name */
    int64_t enrolled_s, valid_from_s, valid_until_s;
    uint32_t templates;
};

/* Reads the answer to EnrollStart; members that an older daemon does not send stay unknown. */
void cli_known_read(sd_bus_message *reply, struct cli_known *out);

/* Prints that the name is in use and that an enrolment adds to it; and that the door no longer
 * opens to the person, if that is so at now_s. Prints nothing if nobody has the name. */
void cli_known_say(const struct cli_known *known, int64_t now_s, FILE *out);

#endif
