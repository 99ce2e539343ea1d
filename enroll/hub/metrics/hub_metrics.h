/* The figures of a fleet in the text format of Prometheus, version 0.0.4. They come from the
 * database, so they are the same from every process of a hub and from a command. What one process
 * counts for itself (isotherm_hub_...) is not among them. The errors of hub_store.h. */
/* clang-format off */
/* name                                       labels        value
 *   isotherm_fleet_leader                                  1: a process of the hub publishes; 0: none does
 *   isotherm_fleet_doors_joined, _online                   doors
 *   isotherm_fleet_events_total                            the sum of the doors' acknowledged numbers
 *   isotherm_fleet_requests_pending                        people who wait for approval
 *   isotherm_fleet_database_bytes                          the size of the database
 *   isotherm_fleet_door_reported_seconds     door, name    the last report, since 1970; 0: there was none
 *   isotherm_fleet_door_online               door, name    1: the broker sees the door; 0: it does not
 *   isotherm_fleet_zone_doors                zone, name    doors that have joined
 *   isotherm_fleet_zone_doors_behind         zone, name    those of them that have not confirmed the zone's place
 *   isotherm_fleet_zone_people               zone, name    people of the zone
 *   isotherm_fleet_zone_deltas_total         zone, name    the number of the newest delta
 *   isotherm_fleet_zone_published_total      zone, name    the number of the newest delta that the broker has
 *   isotherm_fleet_zone_epoch                zone, name    the epoch
 *   isotherm_fleet_zone_lockdown             zone, name    1: the zone is closed to everybody; 0: it is not
 *   isotherm_fleet_zone_behind               zone, name    1: a door knows more than the database; 0: none does
 *   isotherm_fleet_outlet_delivered_total    outlet        events that were delivered
 *   isotherm_fleet_outlet_waiting            outlet        acknowledged numbers that it has not passed yet
 *   isotherm_fleet_outlet_delivered_seconds  outlet        the last success, since 1970; 0: there was none
 *   isotherm_fleet_outlet_failures           outlet        failures since the last success
 *   isotherm_fleet_outlet_stopped            outlet        1: the outlet has to be resumed by hand; 0: it goes on
 *   isotherm_fleet_directory_people          state         people of the directory: "enrolled", "missing" (they
 *                                                          have no face yet), "disabled", "unnamed"
 */
/* clang-format on */
#ifndef ISO_ENROLL_HUB_METRICS_HUB_METRICS_H
#define ISO_ENROLL_HUB_METRICS_HUB_METRICS_H

#include <stdio.h>

#include "enroll/hub/store/hub_store.h"

/* Writes all figures, or none: nothing is written after an error. For an answer to GET /metrics, or
 * as a part of a longer text. -ENOMEM; what goes wrong with `out` itself is in ferror(out). */
int hub_metrics_write(struct hub_store *store, FILE *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Writes them into a file that everybody may read, for the textfile collector of node_exporter: a
 * new file takes the place of the old one at once. The errors of iso_file_open and storage, too. */
int hub_metrics_file(struct hub_store *store, const char *path, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
