/* The figures of a door in its fleet for Prometheus (text format 0.0.4). The state of the daemon is
 * asked for; what the service alone knows is in a file of its runtime folder, which it replaces
 * every few seconds, without waiting for a disk: /run is memory. */
/* clang-format off */
/* name                                          labels   value
 *   isotherm_door_connected                              1: the hub answers; 0: it does not, or the service does not run
 *   isotherm_door_lease_left_seconds                     until the lease ends; 0: it is over, or there is none
 *   isotherm_door_events_waiting                         records of the log that the hub has not acknowledged
 *   isotherm_door_requests_pending                       people who wait for approval
 *   isotherm_door_hub_behind                             1: the hub knows less than the door
 *   isotherm_door_certificate_ends_seconds               since 1970; 0: it cannot be read
 *   isotherm_door_zone_epoch                    zone     the epoch
 *   isotherm_door_zone_sequence                 zone     the number of the newest change that the door has
 *   isotherm_door_zone_waits                    zone     1: the zone has to be fetched whole
 *  and while the service runs:
 *   isotherm_door_changes_missing                        changes of all zones that the hub has named and the door lacks
 *   isotherm_door_deltas_total                           changes that were applied
 *   isotherm_door_snapshots_total                        snapshots that were applied
 *   isotherm_door_fetches_failed_total                   fetches that failed
 *   isotherm_door_messages_refused_total        reason   "forged": they did not reach the daemon; "refused": by the daemon
 */
/* clang-format on */
#ifndef ISO_FIRMWARE_FLEET_PROGRAM_FIGURES_H
#define ISO_FIRMWARE_FLEET_PROGRAM_FIGURES_H

#include <stdio.h>

#include "firmware/fleet/link/link.h"
#include "firmware/fleet/link/link_bus.h"

enum { LINK_FIGURES_OLD_S = 20 }; /* a file that is older is of a service that has ended */

/* Replaces the file of the service: RUNTIME_DIRECTORY/figures.json. Without the variable of the
 * environment, which systemd sets, and after a failure nothing happens: these are only figures. */
void link_figures_keep(const struct link_report *report);

/* Reads it, from /run/isotherm-link without the variable. False: there is none, or it is too old.
 */
bool link_figures_find(struct link_report *out);

/* Writes all figures. `report`: of the service; NULL: it does not run. ends_s: of the certificate.
 */
void link_figures_write(FILE *out, const struct iso_link_status *status,
                        const struct link_bus_lease *lease, int64_t ends_s,
                        const struct link_report *report);

#endif
