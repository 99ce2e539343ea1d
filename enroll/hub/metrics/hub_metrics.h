/* The figures of a fleet in the text format of Prometheus, version 0.0.4, as the database has them:
 * they are the same from every process of a hub, and from a command. What one process counts for
 * itself (isotherm_hub_...) is not among them. The errors of hub_store.h.
 *
 *   isotherm_fleet_leader                      1: a process of the hub publishes, 0: none does
 *   isotherm_fleet_doors_joined, _online       doors
 *   isotherm_fleet_events_total                numbers of events up to which nothing lacks
 *   isotherm_fleet_requests_pending            people who wait for approval
 *   isotherm_fleet_database_bytes              the size of the database
 *   isotherm_fleet_door_reported_seconds       the last report, since 1970; 0: none {door, name}
 *   isotherm_fleet_door_online                 {door, name}
 *   isotherm_fleet_zone_doors, _doors_behind   joined doors, and those which have not confirmed
 * what the zone has {zone, name} isotherm_fleet_zone_people                 {zone, name}
 *   isotherm_fleet_zone_deltas_total, _published_total, _epoch   {zone, name}
 *   isotherm_fleet_zone_lockdown, _behind      1: it is {zone, name}
 *   isotherm_fleet_outlet_delivered_total      events {outlet}
 *   isotherm_fleet_outlet_waiting              numbers of events that it has not passed {outlet}
 *   isotherm_fleet_outlet_delivered_seconds    the last success, since 1970; 0: none {outlet}
 *   isotherm_fleet_outlet_failures, _stopped   {outlet}
 *   isotherm_fleet_directory_people            {state="enrolled|missing|disabled|unnamed"};
 * missing: has no face yet */
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
