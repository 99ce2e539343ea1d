/* What the link asks of the daemon (firmware/fleet/link/link_daemon.h), answered by a door's side
 * in the same process: for tests and measurements, which run the link without a bus. */
#ifndef ISO_FIRMWARE_FLEET_DOOR_FLEET_DIRECT_H
#define ISO_FIRMWARE_FLEET_DOOR_FLEET_DIRECT_H

#include "firmware/fleet/door/fleet.h"
#include "firmware/fleet/link/link_daemon.h"

/* The fleet must outlive what is returned. */
struct iso_link_daemon iso_fleet_direct(struct iso_fleet *fleet);

#endif
