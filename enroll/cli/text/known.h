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

/* Reads the answer to EnrollStart. Members that an older daemon does not send are 0 or "". If the
 * answer cannot be read, *out stays as it was. */
void cli_known_read(sd_bus_message *reply, struct cli_known *out);

/* Prints that the name is in use and that the enrolment adds templates to this person. If the
 * person's validity has ended at now_s, prints that the door no longer opens. Prints nothing if
 * nobody has the name. */
void cli_known_say(const struct cli_known *known, int64_t now_s, FILE *out);

#endif
