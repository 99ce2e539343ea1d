/* How a change of a person reaches all zones of the person. Internal to the hub; all functions are
 * called within a transaction. */
#ifndef ISO_ENROLL_HUB_PEOPLE_HUB_SPREAD_H
#define ISO_ENROLL_HUB_PEOPLE_HUB_SPREAD_H

#include <jansson.h>

#include "enroll/hub/people/hub_person.h"

struct hub__zones {
    size_t n;
    struct iso_fleet_id ids[HUB_PERSON_ZONES_MAX];
};

struct hub__person_text {
    char text[ISO_FLEET_NAME_MAX + 1];
};

/* Locks the row of a person, so that its changes have an order; reads its zones and, if `json` is
 * not NULL, its description for the act. -ENOENT. */
int hub__person_lock(struct hub_store *store, const struct iso_fleet_id *id,
                     struct hub__zones *zones, json_t **json, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The name for an act; "" if there is none. */
struct hub__person_text hub__person_name(struct hub_store *store, const struct iso_fleet_id *id);

/* A person as the acts describe it, without templates and credential. NULL: there is none. */
json_t *hub__person_json(struct hub_store *store, const struct iso_fleet_id *id);

/* Replaces the zones of a person. -ENOENT there is no such zone. */
int hub__person_put_zones(struct hub_store *store, const struct iso_fleet_id *id,
                          const struct iso_fleet_id *zones, size_t n, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Gives a person a new revision, and appends a PUT to all its zones and a REMOVE to those of
 * `before` that it has left. */
int hub__person_spread(struct hub_store *store, const struct iso_fleet_id *id,
                       const struct hub__zones *before, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Appends a REMOVE to these zones, with a new revision. */
int hub__person_remove(struct hub_store *store, const struct iso_fleet_id *id,
                       const struct hub__zones *zones, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
