/* The service: `isotherm-link run`. It waits until the door has joined a fleet, keeps the link
 * (link.h) as long as it belongs to it, and renews the certificate. It looks every five seconds
 * whether an administrator has joined or left a fleet.
 *
 *   NONE     LINKED  link.json is there
 *   LINKED   NONE    link.json is gone: what is left of updates is removed
 *            LINKED  it is another one: the link is made anew */
#ifndef ISO_FIRMWARE_FLEET_PROGRAM_SERVICE_H
#define ISO_FIRMWARE_FLEET_PROGRAM_SERVICE_H

#include "core/base/fault.h"
#include "firmware/fleet/program/options.h"

/* Runs until SIGTERM or SIGINT. A negative errno with a fault if it cannot start. */
int link_service_run(const struct link_options *options, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
