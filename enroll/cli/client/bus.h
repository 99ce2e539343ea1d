/* A connection to a message bus. */
#ifndef CLI_CLIENT_BUS_H
#define CLI_CLIENT_BUS_H

#include <stdbool.h>
#include <systemd/sd-bus.h>

/* Which bus: an address, else the session bus, else (all zero) the system bus. */
struct cli_bus {
    const char *address;
    bool session;
};

/* Makes a connection, without waiting for the bus to answer. The caller unreferences *out. Returns
 * 0 or more, or a negative errno; then *out stays as it was. */
int cli_bus_connect(const struct cli_bus *bus, sd_bus **out) __attribute__((warn_unused_result));

#endif
