/* What the service on the bus holds. Internal to firmware/bus*.c. */
#ifndef ISO_FIRMWARE_BUS_STATE_H
#define ISO_FIRMWARE_BUS_STATE_H

#include <systemd/sd-bus.h>

#include "firmware/bus.h"

struct iso_bus {
    sd_bus *bus;
    sd_bus_slot *object, *disconnected;
    sd_bus_track *track; /* of the claimant */
    char claimant[256];  /* unique name; "": nobody */
    bool gone;
    struct iso_appliance *appliance;
    const struct iso_appliance_parts *parts;
};

/* Methods and signals of the contract (bus_methods.c); the context is a struct iso_bus. */
extern const sd_bus_vtable iso__bus_vtable[];

/* Appends the a{sv} of GetStatus (bus_status.c). */
int iso__bus_append_status(sd_bus_message *reply, const struct iso_bus *bus);

/* Nobody has the claim any more. */
void iso__bus_forget_claimant(struct iso_bus *bus);

#endif
