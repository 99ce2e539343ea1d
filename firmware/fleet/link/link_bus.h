/* The daemon of a door over the bus (firmware/contract/fleet_words.h), as the link needs it
 * (link_daemon.h). The daemon and the bus may go away and come back at any time: calls then return
 * -ENOTCONN, and the next call connects again. */
#ifndef ISO_FIRMWARE_FLEET_LINK_LINK_BUS_H
#define ISO_FIRMWARE_FLEET_LINK_LINK_BUS_H

#include <systemd/sd-event.h>

#include "firmware/fleet/link/link_daemon.h"

struct link_bus;

/* Called from the event loop. */
struct link_bus_calls {
    void *context;
    void (*came)(void *context);                   /* the daemon has started */
    void (*work)(void *context, const char *what); /* the signal FleetWork */
};

/* Makes a client of the bus at `address` (bus_connect.h), which connects by itself at the first
 * call. The caller frees *out. -ENOMEM. */
int link_bus_new(sd_event *event, const char *address, const struct link_bus_calls *calls,
                 struct link_bus **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));
void link_bus_free(struct link_bus *bus);

/* The functions of the link; they are valid as long as `bus`. */
struct iso_link_daemon link_bus_daemon(struct link_bus *bus);

/* ---- for the commands `join` and `leave` ---- */

/* The public keys of the door: 128 hexadecimal digits. */
enum { LINK_ADDRESS_SIZE = 129 };
int link_bus_address(struct link_bus *bus, char address[LINK_ADDRESS_SIZE], struct iso_fault *fault)
    __attribute__((warn_unused_result));

int link_bus_join(struct link_bus *bus, const void *membership, size_t size,
                  struct iso_fault *fault) __attribute__((warn_unused_result));
int link_bus_leave(struct link_bus *bus, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* How the lease stands, for people: "held", "over" or "none", and the seconds that are left. */
struct link_bus_lease {
    char word[16];
    int64_t left_s;
    uint32_t pending; /* people who wait for approval */
    bool is_hub_behind;
    char fault[256]; /* what of the hub's wishes the door could not do; "": nothing */
    char door_name[ISO_FLEET_TITLE_SIZE], hub_name[ISO_FLEET_TITLE_SIZE];
};

/* Reads the state of the daemon with what only people want to know. Errors of
 * iso_link_daemon.status. */
int link_bus_status(struct link_bus *bus, struct iso_link_status *out, struct link_bus_lease *lease,
                    struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
