#include "firmware/fleet/link/link_bus.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "firmware/contract/bus_connect.h"
#include "firmware/contract/contract.h"
#include "firmware/fleet/link/link_bus_inner.h"

#define S_US UINT64_C(1000000)

static const uint64_t LIMIT_US = 25 * S_US;

/* ---- the connection ---- */

static void disconnect(struct link_bus *bus)
{
    if (bus->bus) {
        (void)sd_bus_detach_event(bus->bus);
        bus->bus = sd_bus_close_unref(bus->bus);
    }
}

static int on_owner(sd_bus_message *signal, void *context, sd_bus_error *error)
{
    struct link_bus *bus = context;
    const char *name = NULL, *before = NULL, *now = NULL;

    (void)error;
    if (sd_bus_message_read(signal, "sss", &name, &before, &now) >= 0 && now[0]) {
        bus->calls.came(bus->calls.context);
    }
    return 0;
}

static int on_work(sd_bus_message *signal, void *context, sd_bus_error *error)
{
    struct link_bus *bus = context;
    const char *what = NULL;

    (void)error;
    if (sd_bus_message_read(signal, "s", &what) >= 0) {
        bus->calls.work(bus->calls.context, what);
    }
    return 0;
}

static int add_matches(struct link_bus *bus)
{
    int r = sd_bus_match_signal_async(bus->bus, NULL, ISO_CONTRACT_NAME, ISO_CONTRACT_PATH,
                                      ISO_CONTRACT_INTERFACE, ISO_CONTRACT_FLEET_WORK, on_work,
                                      NULL, bus);
    return r < 0 ? r
                 : sd_bus_add_match_async(
                       bus->bus, NULL,
                       "type='signal',sender='org.freedesktop.DBus',"
                       "path='/org/freedesktop/DBus',interface='org.freedesktop.DBus',"
                       "member='NameOwnerChanged',arg0='" ISO_CONTRACT_NAME "'",
                       on_owner, NULL, bus);
}

static int connect_bus(struct link_bus *bus)
{
    if (bus->bus && sd_bus_is_open(bus->bus) > 0) {
        return 0;
    }
    disconnect(bus);
    int r = iso_bus_connect(bus->address, &bus->bus);
    r = r < 0 ? r : add_matches(bus);
    r = r < 0 ? r : sd_bus_attach_event(bus->bus, bus->event, 0);
    if (r < 0) {
        disconnect(bus);
    }
    return r;
}

/* ---- calls ---- */

int link__bus_begin(struct link_bus *bus, const char *method, sd_bus_message **call,
                    struct iso_fault *fault)
{
    int r = connect_bus(bus);

    if (r < 0) {
        return iso_fault_set(fault, -ENOTCONN, "the bus %s: %s", bus->address, strerror(-r));
    }
    r = sd_bus_message_new_method_call(bus->bus, call, ISO_CONTRACT_NAME, ISO_CONTRACT_PATH,
                                       ISO_CONTRACT_INTERFACE, method);
    return r < 0 ? iso_fault_set(fault, r, "%s: %s", method, strerror(-r)) : 0;
}

/* Errors that say that the daemon is not there, or that the connection is not. */
static bool is_away(const sd_bus_error *error, int r)
{
    static const char *const names[] = {
        SD_BUS_ERROR_SERVICE_UNKNOWN, SD_BUS_ERROR_NAME_HAS_NO_OWNER, SD_BUS_ERROR_NO_REPLY,
        SD_BUS_ERROR_TIMEOUT,         SD_BUS_ERROR_DISCONNECTED,      SD_BUS_ERROR_NO_SERVER};

    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        if (sd_bus_error_has_name(error, names[i])) {
            return true;
        }
    }
    return r == -ENOTCONN || r == -ECONNRESET || r == -ETIMEDOUT || r == -EPIPE;
}

int link__bus_send(struct link_bus *bus, sd_bus_message *call, uint64_t limit_us,
                   sd_bus_message **reply, struct iso_fault *fault)
{
    sd_bus_error error = SD_BUS_ERROR_NULL;
    char method[64]; /* a message moves its texts when it is sent */
    (void)snprintf(method, sizeof method, "%s", sd_bus_message_get_member(call));
    int r = sd_bus_call(bus->bus, call, limit_us, &error, reply);

    if (r < 0) {
        const int result = sd_bus_error_has_name(&error, ISO_CONTRACT_ERROR_NO_FLEET) ? -ENOENT
                           : is_away(&error, r)                                       ? -ENOTCONN
                                                                                      : -EIO;
        r = iso_fault_set(fault, result, "%s: %s", method,
                          error.message ? error.message : strerror(-r));
    }
    sd_bus_message_unref(call);
    sd_bus_error_free(&error);
    return r < 0 ? r : 0;
}

int link__bus_ask(struct link_bus *bus, const char *method, sd_bus_message **reply,
                  struct iso_fault *fault)
{
    sd_bus_message *call = NULL;
    const int r = link__bus_begin(bus, method, &call, fault);

    return r < 0 ? r : link__bus_send(bus, call, LIMIT_US, reply, fault);
}

int link__bus_bad_reply(int r, struct iso_fault *fault)
{
    return iso_fault_set(fault, -EIO, "the daemon answers in another form: %s",
                         strerror(r < 0 ? -r : EBADMSG));
}

int link_bus_address(struct link_bus *bus, char address[LINK_ADDRESS_SIZE], struct iso_fault *fault)
{
    sd_bus_message *reply = NULL;
    const char *text = NULL;
    int r = link__bus_ask(bus, ISO_CONTRACT_GET_ADDRESS, &reply, fault);

    if (r < 0) {
        return r;
    }
    r = sd_bus_message_read(reply, "s", &text);
    if (r < 0 || strlen(text) != LINK_ADDRESS_SIZE - 1) {
        r = link__bus_bad_reply(r, fault);
    } else {
        memcpy(address, text, LINK_ADDRESS_SIZE);
    }
    sd_bus_message_unref(reply);
    return r < 0 ? r : 0;
}

int link_bus_join(struct link_bus *bus, const void *membership, size_t size,
                  struct iso_fault *fault)
{
    sd_bus_message *call = NULL, *reply = NULL;
    int r = link__bus_begin(bus, ISO_CONTRACT_FLEET_JOIN, &call, fault);

    if (r < 0) {
        return r;
    }
    r = sd_bus_message_append_array(call, 'y', membership, size);
    if (r < 0) {
        sd_bus_message_unref(call);
        return iso_fault_set(fault, r, "FleetJoin: %s", strerror(-r));
    }
    r = link__bus_send(bus, call, LIMIT_US, &reply, fault);
    sd_bus_message_unref(reply);
    return r;
}

int link_bus_leave(struct link_bus *bus, struct iso_fault *fault)
{
    sd_bus_message *call = NULL, *reply = NULL;
    int r = link__bus_begin(bus, ISO_CONTRACT_FLEET_LEAVE, &call, fault);

    /* The daemon removes all people of the fleet, which may be many. */
    r = r < 0 ? r : link__bus_send(bus, call, 600 * S_US, &reply, fault);
    sd_bus_message_unref(reply);
    return r;
}

/* ---- begin and end ---- */

int link_bus_new(sd_event *event, const char *address, const struct link_bus_calls *calls,
                 struct link_bus **out, struct iso_fault *fault)
{
    struct link_bus *bus = calloc(1, sizeof *bus);
    char *copy = strdup(address);

    if (!bus || !copy) {
        free(bus);
        free(copy);
        return iso_fault_set(fault, -ENOMEM, "the bus %s: out of memory", address);
    }
    bus->event = sd_event_ref(event);
    bus->address = copy;
    bus->calls = *calls;
    *out = bus;
    return 0;
}

void link_bus_free(struct link_bus *bus)
{
    if (bus) {
        disconnect(bus);
        (void)sd_event_unref(bus->event);
        free(bus->address);
        free(bus);
    }
}
