/* The D-Bus service of firmware/contract/contract.h. It passes calls to the appliance, and the
 * appliance's events to the bus.
 *
 * One client at a time has the claim. It is identified by its unique name; when it leaves the bus,
 * the claim is released. Status signals go to the claimant only. Only the thread of the event loop
 * uses the bus. The policy of the bus (board/generic/org.isotherm.Isotherm.conf) decides who may
 * call, and call_rate.h how often. */
#ifndef ISO_FIRMWARE_BUS_BUS_H
#define ISO_FIRMWARE_BUS_BUS_H

#include <stdbool.h>
#include <systemd/sd-event.h>

#include "core/base/fault.h"
#include "firmware/appliance/appliance.h"

struct iso_bus;

/* Checks whether this can be the address of a bus, without connecting. -EINVAL with a fault if it
 * cannot. */
int iso_bus_check_address(const char *address, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Connects, and waits for the handshake. `address` is "system", "session" or a D-Bus address.
 * Negative errno with a fault. */
int iso_bus_open(const char *address, struct iso_bus **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Sends the remaining messages, disconnects and frees the bus. Does not use the appliance. NULL is
 * accepted. */
void iso_bus_close(struct iso_bus *bus);

/* Handlers that send the appliance's events on this bus, except for `message`, which the caller
 * provides. */
struct iso_appliance_events iso_bus_events(struct iso_bus *bus,
                                           void (*message)(void *context, int priority,
                                                           const char *text));

/* Offers the appliance, which uses these components, under the name of the contract, from within an
 * event loop. All of them must be valid as long as the event loop runs. -EEXIST: the name is taken.
 */
int iso_bus_serve(struct iso_bus *bus, struct iso_appliance *appliance,
                  const struct iso_appliance_borrowed *borrowed, sd_event *event,
                  struct iso_fault *fault) __attribute__((warn_unused_result));

/* Whether the connection is lost. Then no client is served, and the appliance goes on without
 * waiting for the bus. */
bool iso_bus_is_gone(const struct iso_bus *bus);

/* Whether this connection has the name and answers calls. */
bool iso_bus_is_serving(const struct iso_bus *bus);

/* Gives up a lost connection, with the claim that a client had through it, and begins another one
 * without waiting. Whether it succeeds becomes known by iso_bus_is_serving, or by iso_bus_is_gone.
 * Returns an error of connecting; then the bus is still gone. Must not be called from within a
 * handler of the bus. */
int iso_bus_mend(struct iso_bus *bus, struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
