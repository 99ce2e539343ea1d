/* A connection to the message bus, for the daemon and for its clients. */
#ifndef ISO_FIRMWARE_CONTRACT_BUS_CONNECT_H
#define ISO_FIRMWARE_CONTRACT_BUS_CONNECT_H

#include <systemd/sd-bus.h>

/* Makes a connection to a bus and does not wait for its answer. `address` is "system", "session" or
 * a D-Bus address ("unix:path=..."). The caller frees *out with sd_bus_unref(). Returns 0 or a
 * positive number, or a negative errno; then *out is unchanged. */
int iso_bus_connect(const char *address, sd_bus **out) __attribute__((warn_unused_result));

#endif
