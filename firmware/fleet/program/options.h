/* The command line of isotherm-link. */
#ifndef ISO_FIRMWARE_FLEET_PROGRAM_OPTIONS_H
#define ISO_FIRMWARE_FLEET_PROGRAM_OPTIONS_H

#include <stdbool.h>

#include "drivers/base/restart_hours.h"

enum link_command { LINK_COMMAND_RUN, LINK_COMMAND_JOIN, LINK_COMMAND_LEAVE, LINK_COMMAND_STATUS };

struct link_options {
    enum link_command command;
    const char *address;              /* of `join` */
    bool metrics;                     /* of `status`: for Prometheus */
    const char *bus;                  /* "system", "session" or an address */
    const char *state;                /* the folder (home.h) */
    const char *updates;              /* the folder of the image in which updates are */
    struct iso_restart_hours restart; /* of `run`: when the machine may restart */
};

/* Reads the command line. Returns 0; 1 if help or version was printed; or -EINVAL after a line on
 * stderr that says what is wrong. */
int link_options_read(int argc, char **argv, struct link_options *out)
    __attribute__((warn_unused_result));

#endif
