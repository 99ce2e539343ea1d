#include "firmware/bus/bus.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "firmware/bus/bus_state.h"
#include "firmware/contract/bus_connect.h"
#include "firmware/contract/contract.h"
#include "firmware/contract/fleet_words.h"

enum { CALL_TIMEOUT_US = 2 * 1000 * 1000 };

static int on_disconnected(sd_bus_message *signal, void *context, sd_bus_error *out)
{
    (void)signal;
    (void)out;
    ((struct iso_bus *)context)->gone = true;
    return 0;
}

/* Closes the connection, and ends the claim and the listeners that it had. */
static void drop_connection(struct iso_bus *bus)
{
    if (bus->claimant[0]) {
        iso_appliance_release(bus->appliance);
    }
    if (bus->aiming) {
        iso_appliance_aim(bus->appliance, false);
    }
    iso__bus_forget_claimant(bus);
    bus->aiming = sd_bus_track_unref(bus->aiming);
    bus->object = sd_bus_slot_unref(bus->object);
    bus->filter = sd_bus_slot_unref(bus->filter);
    bus->naming = sd_bus_slot_unref(bus->naming);
    bus->disconnected = sd_bus_slot_unref(bus->disconnected);
    if (bus->bus) {
        (void)sd_bus_detach_event(bus->bus);
        bus->bus = sd_bus_flush_close_unref(bus->bus);
    }
    bus->serving = false;
}

/* Begins a connection. Whether it works becomes known later. */
static int begin_connection(struct iso_bus *bus)
{
    int r = iso_bus_connect(bus->address, &bus->bus);
    /* The bus is asked for the client that claims the camera, and the door waits for the answer. */
    if (r >= 0) {
        r = sd_bus_set_method_call_timeout(bus->bus, CALL_TIMEOUT_US);
    }
    return r < 0 ? r
                 : sd_bus_match_signal_async(
                       bus->bus, &bus->disconnected, "org.freedesktop.DBus.Local", NULL,
                       "org.freedesktop.DBus.Local", "Disconnected", on_disconnected, NULL, bus);
}

/* An address needs a transport and a colon, as the D-Bus specification says ("Server
 * Addresses"). */
int iso_bus_check_address(const char *address, struct iso_fault *fault)
{
    const char *colon = strchr(address, ':');
    if (strcmp(address, "system") == 0 || strcmp(address, "session") == 0 ||
        (colon && colon > address)) {
        return 0;
    }
    return iso_fault_set_code(
        fault, ISO_FAULT_CONFIG_WRONG, -EINVAL,
        "bus '%s': not system, session or an address such as unix:path=/run/bus", address);
}

int iso_bus_open(const char *address, struct iso_bus **out, struct iso_fault *fault)
{
    const char *unique;
    struct iso_bus *bus = calloc(1, sizeof *bus);
    if (!bus) {
        return iso_fault_set(fault, -ENOMEM, "bus: out of memory");
    }
    (void)snprintf(bus->address, sizeof bus->address, "%s", address);
    int r = begin_connection(bus);
    if (r >= 0) {
        /* This call waits for the handshake. */
        r = sd_bus_get_unique_name(bus->bus, &unique);
    }
    if (r < 0) {
        iso_bus_close(bus);
        return iso_fault_set_code(fault, ISO_FAULT_BUS_MISSING, r, "bus '%s': %s", address,
                                  strerror(-r));
    }
    *out = bus;
    return 0;
}

void iso_bus_close(struct iso_bus *bus)
{
    if (bus) {
        bus->claimant[0] = '\0'; /* the appliance may have been freed already */
        bus->login = (struct iso__bus_login){.on = false};
        bus->aiming = sd_bus_track_unref(bus->aiming);
        bus->picture = sd_bus_message_unref(bus->picture);
        drop_connection(bus);
        iso_stream_list_end(&bus->streams, ISO_STREAM_OUTLINE);
        free(bus);
    }
}

/* Answers a client's calls beyond its allowance with an error, before any other code sees them. */
static int limit_calls(sd_bus_message *message, void *context, sd_bus_error *out)
{
    struct iso_bus *bus = context;
    const char *sender = sd_bus_message_get_sender(message);
    (void)out;
    if (!sd_bus_message_is_method_call(message, NULL, NULL)) {
        return 0;
    }
    const int64_t now_ns = iso_times_now_ns(&bus->borrowed->times);
    const bool may = sd_bus_message_is_method_call(message, ISO_CONTRACT_INTERFACE,
                                                   ISO_CONTRACT_FLEET_RECEIVE)
                         ? iso_call_rate_take_message(&bus->rate, now_ns)
                         : sender && iso_call_rate_take(&bus->rate, sender, now_ns);
    if (may) {
        return 0;
    }
    const int r = sd_bus_reply_method_errorf(message, ISO_CONTRACT_ERROR_TOO_MANY_CALLS,
                                             "too many calls: wait a second");
    return r < 0 ? r : 1;
}

/* Adds the object and the limit of calls to the connection, and the connection to the event
 * loop. */
static int attach_object(struct iso_bus *bus)
{
    int r = sd_bus_attach_event(bus->bus, bus->event, SD_EVENT_PRIORITY_NORMAL);
    if (r >= 0) {
        r = sd_bus_add_filter(bus->bus, &bus->filter, limit_calls, bus);
    }
    return r < 0 ? r
                 : sd_bus_add_object_vtable(bus->bus, &bus->object, ISO_CONTRACT_PATH,
                                            ISO_CONTRACT_INTERFACE, iso__bus_vtable, bus);
}

int iso_bus_serve(struct iso_bus *bus, struct iso_appliance *appliance,
                  const struct iso_appliance_borrowed *borrowed, sd_event *event,
                  struct iso_fault *fault)
{
    bus->appliance = appliance;
    bus->borrowed = borrowed;
    bus->event = event;
    iso_call_rate_init(&bus->rate, iso_times_now_ns(&borrowed->times));
    int r = attach_object(bus);
    if (r < 0) {
        return iso_fault_set_code(fault, ISO_FAULT_BUS_REFUSED, r, "bus: %s", strerror(-r));
    }
    r = sd_bus_request_name(bus->bus, ISO_CONTRACT_NAME, 0);
    if (r < 0) {
        return iso_fault_set_code(fault, ISO_FAULT_BUS_REFUSED, r, "bus: the name %s: %s",
                                  ISO_CONTRACT_NAME,
                                  r == -EEXIST ? "another isothermd has it" : strerror(-r));
    }
    bus->serving = true;
    return 0;
}

bool iso_bus_is_gone(const struct iso_bus *bus)
{
    return bus->gone;
}

bool iso_bus_is_serving(const struct iso_bus *bus)
{
    return bus->serving;
}

/* The answer to the request for the name: 1 means that this connection owns it. */
static int on_named(sd_bus_message *reply, void *context, sd_bus_error *out)
{
    struct iso_bus *bus = context;
    uint32_t answer = 0;
    (void)out;
    bus->serving = !sd_bus_message_is_method_error(reply, NULL) &&
                   sd_bus_message_read(reply, "u", &answer) >= 0 && answer == 1;
    bus->gone = !bus->serving;
    return 0;
}

int iso_bus_mend(struct iso_bus *bus, struct iso_fault *fault)
{
    drop_connection(bus);
    int r = begin_connection(bus);
    if (r >= 0) {
        r = attach_object(bus);
    }
    if (r >= 0) {
        r = sd_bus_request_name_async(bus->bus, &bus->naming, ISO_CONTRACT_NAME, 0, on_named, bus);
    }
    if (r < 0) {
        drop_connection(bus);
        return iso_fault_set_code(fault, ISO_FAULT_BUS_MISSING, r, "bus '%s': %s", bus->address,
                                  strerror(-r));
    }
    bus->gone = false;
    return 0;
}
