/* What the clients of fuzz_bus.c say: calls whose methods and arguments the input chooses, and the
 * messages of a hub that holds the keys of the fleet. */
#ifndef TESTS_FUZZ_FIRMWARE_BUS_CLIENTS_H
#define TESTS_FUZZ_FIRMWARE_BUS_CLIENTS_H

#include <stddef.h>
#include <stdint.h>
#include <systemd/sd-bus.h>

#include "tests/firmware/fleet/door/door_rig.h"

/* The rest of the input. */
struct bus_input {
    const uint8_t *data;
    size_t size;
};

/* Takes up to `bytes` (at most 8) as a number, the first of them as its highest. Where the input
 * has ended, nothing is added. */
uint64_t bus_input_take(struct bus_input *input, size_t bytes);

/* A call of a method of the service from one of the clients, or NULL if it cannot be made. The
 * caller frees it. `bus` is the bus's end of the connection; `hub` makes the messages of the fleet
 * for its own door. */
sd_bus_message *bus_clients_call(sd_bus *bus, struct door_rig *hub, struct bus_input *input);

/* The signal that a client has left the bus. As above. */
sd_bus_message *bus_clients_leave(sd_bus *bus, struct bus_input *input);

/* A message of the hub, whole or with one changed byte, or bytes of the input. The caller frees
 * them. */
struct iso_fleet_bytes bus_hub_message(struct door_rig *hub, struct bus_input *input);

/* A file in memory with a snapshot of a zone or with such bytes. The caller closes it. */
int bus_hub_file(struct door_rig *hub, struct bus_input *input);

#endif
