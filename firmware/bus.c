#include "firmware/bus.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "core/contract.h"
#include "firmware/bus_state.h"

static int connect_address(const char *address, sd_bus **out)
{
    sd_bus *made = NULL;
    if (strcmp(address, "system") == 0) {
        return sd_bus_open_system(out);
    }
    if (strcmp(address, "session") == 0) {
        return sd_bus_open_user(out);
    }
    int r = sd_bus_new(&made);
    r = r < 0 ? r : sd_bus_set_address(made, address);
    r = r < 0 ? r : sd_bus_set_bus_client(made, 1);
    r = r < 0 ? r : sd_bus_start(made);
    if (r < 0) {
        sd_bus_unref(made);
        return r;
    }
    *out = made;
    return 0;
}

static int on_disconnected(sd_bus_message *signal, void *context, sd_bus_error *out)
{
    (void)signal;
    (void)out;
    ((struct iso_bus *)context)->gone = true;
    return 0;
}

int iso_bus_open(const char *address, struct iso_bus **out, struct iso_fault *fault)
{
    const char *unique;
    struct iso_bus *bus = calloc(1, sizeof *bus);
    if (!bus) {
        return iso_fault_set(fault, -ENOMEM, "bus: out of memory");
    }
    int r = connect_address(address, &bus->bus);
    r = r < 0 ? r : sd_bus_get_unique_name(bus->bus, &unique); /* waits for the handshake */
    r = r < 0
            ? r
            : sd_bus_match_signal_async(bus->bus, &bus->disconnected, "org.freedesktop.DBus.Local",
                                        NULL, "org.freedesktop.DBus.Local", "Disconnected",
                                        on_disconnected, NULL, bus);
    if (r < 0) {
        iso_bus_close(bus);
        return iso_fault_set(fault, r, "bus '%s': %s", address, strerror(-r));
    }
    *out = bus;
    return 0;
}

void iso_bus_close(struct iso_bus *bus)
{
    if (!bus) {
        return;
    }
    iso__bus_forget_claimant(bus);
    sd_bus_track_unref(bus->aiming);
    sd_bus_slot_unref(bus->object);
    sd_bus_slot_unref(bus->disconnected);
    if (bus->bus) {
        (void)sd_bus_detach_event(bus->bus);
        sd_bus_flush_close_unref(bus->bus);
    }
    free(bus);
}

int iso_bus_serve(struct iso_bus *bus, struct iso_appliance *appliance,
                  const struct iso_appliance_parts *parts, sd_event *event, struct iso_fault *fault)
{
    bus->appliance = appliance;
    bus->parts = parts;
    int r = sd_bus_attach_event(bus->bus, event, SD_EVENT_PRIORITY_NORMAL);
    r = r < 0 ? r
              : sd_bus_add_object_vtable(bus->bus, &bus->object, ISO_CONTRACT_PATH,
                                         ISO_CONTRACT_INTERFACE, iso__bus_vtable, bus);
    if (r < 0) {
        return iso_fault_set(fault, r, "bus: %s", strerror(-r));
    }
    r = sd_bus_request_name(bus->bus, ISO_CONTRACT_NAME, 0);
    if (r < 0) {
        return iso_fault_set(fault, r, "bus: the name %s: %s", ISO_CONTRACT_NAME,
                             r == -EEXIST ? "another isothermd has it" : strerror(-r));
    }
    return 0;
}

bool iso_bus_is_gone(const struct iso_bus *bus)
{
    return bus->gone;
}
