/* The fake daemon as a service on a bus, in a process of its own, which can be killed. */
#ifndef TESTS_FLEET_LINK_BUS_SERVICE_H
#define TESTS_FLEET_LINK_BUS_SERVICE_H

#include <sys/types.h>

#include "tests/firmware/fleet/link/fake_daemon.h"

/* Starts a process that owns the daemon's name on the bus and answers as `daemon` would; without a
 * fleet if `is_member` is false. It emits FleetWork("events") after each question. Returns its id.
 */
pid_t bus_service_start(const char *address, const struct fake_daemon *daemon, bool is_member);
void bus_service_stop(pid_t pid);

#endif
