/* The parts of a client of the bus (link_bus.h), for its own sources. */
#ifndef ISO_FIRMWARE_FLEET_LINK_LINK_BUS_INNER_H
#define ISO_FIRMWARE_FLEET_LINK_LINK_BUS_INNER_H

#include <systemd/sd-bus.h>

#include "firmware/fleet/link/link_bus.h"

struct link_bus {
    sd_event *event;
    char *address;
    struct link_bus_calls calls;
    sd_bus *bus; /* NULL: not connected */
};

/* Begins a call of the daemon, and connects if it must. -ENOTCONN, -ENOMEM. */
int link__bus_begin(struct link_bus *bus, const char *method, sd_bus_message **call,
                    struct iso_fault *fault) __attribute__((warn_unused_result));

/* Sends the call, which is released, and waits for the reply, which the caller unreferences. */
int link__bus_send(struct link_bus *bus, sd_bus_message *call, uint64_t limit_us,
                   sd_bus_message **reply, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Both, for a method without arguments. */
int link__bus_ask(struct link_bus *bus, const char *method, sd_bus_message **reply,
                  struct iso_fault *fault) __attribute__((warn_unused_result));

/* A reply that is not as it should be: r is the error of reading it. */
int link__bus_bad_reply(int r, struct iso_fault *fault);

#endif
