/* Joining a fleet, and leaving it. */
#ifndef ISO_FIRMWARE_FLEET_PROGRAM_JOIN_H
#define ISO_FIRMWARE_FLEET_PROGRAM_JOIN_H

#include "core/base/fault.h"
#include "firmware/fleet/link/link_bus.h"
#include "firmware/fleet/program/home.h"

/* Joins by a one-time address (join_address.h): makes a key, gets the membership and a certificate
 * of the hub, gives the membership to the daemon, and stores the rest in `folder`. *out is what was
 * stored. After an error nothing is stored; the code may be used up.
 *
 * -EALREADY the door has joined, -EINVAL the address, -EKEYREJECTED the server is not the hub of
 * the address, -EACCES the hub refuses, -ENOTCONN and -EIO the daemon, -EBADMSG the reply; errors
 * of the disk. */
int link_join(struct link_bus *bus, const char *folder, const char *address, struct link_home *out,
              struct iso_fault *fault) __attribute__((warn_unused_result));

/* Lets the daemon forget the fleet, and removes the files. If the daemon cannot, they stay. */
int link_leave(struct link_bus *bus, const char *folder, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
