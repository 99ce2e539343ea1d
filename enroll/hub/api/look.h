/* What several routes of the hub look up, read and show. Internal to enroll/hub/api. */
#ifndef HUB_API_LOOK_H
#define HUB_API_LOOK_H

#include "enroll/hub/api/call.h"
#include "enroll/hub/people/hub_person.h"
#include "enroll/hub/people/hub_request.h"
#include "enroll/hub/store/hub_door.h"
#include "enroll/hub/store/hub_zone.h"

/* The zone, door, person or request of the path, by its name or id. After -ENOENT the code of the
 * answer says what is absent. */
int hub__look_zone(struct hub_call *call, struct hub_store *store, const char *name_or_id,
                   struct hub_zone *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));
int hub__look_door(struct hub_call *call, struct hub_store *store, const char *name_or_id,
                   struct hub_door *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));
int hub__look_person(struct hub_call *call, struct hub_store *store, const char *name_or_id,
                     struct hub_person *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));
int hub__look_request(struct hub_call *call, struct hub_store *store, const char *name_or_id,
                      struct hub_request *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The member "zones" of the body: a list of names or ids. *has says whether it is there. More than
 * `most` are refused. */
int hub__look_zones(struct hub_call *call, struct hub_store *store, size_t most, bool *has,
                    struct iso_fleet_id *out, size_t *n, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Which doors have not confirmed the places of their zones. */
struct hub_waits;

int hub__waits_read(struct hub_store *store, struct hub_waits **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));
void hub__waits_free(struct hub_waits *waits);
bool hub__waits_for(const struct hub_waits *waits, const struct iso_fleet_id *door,
                    const struct iso_fleet_id *zone);

/* {"id", "name", "epoch", ...}, {"id", "name", "state", ...}, {"id", "name", "zones", ...} of
 * openapi.json. NULL: there is no memory. `whole`: with all that the door tells of its health. */
json_t *hub__json_zone(const struct hub_zone *zone);
json_t *hub__json_door(const struct hub_door *door, const struct hub_waits *waits, int64_t now_s,
                       bool whole);
json_t *hub__json_person(const struct hub_person *person);

/* The doors of a zone that have not confirmed its place: a list of {"id", "name", "online",
 * "reported_s"}. */
int hub__json_unconfirmed(struct hub_store *store, const struct iso_fleet_id *zone, json_t **out,
                          struct iso_fault *fault) __attribute__((warn_unused_result));

/* The same for several zones: [{"id", "name", "lockdown", "unconfirmed": [...]}]. */
int hub__json_zones_waiting(struct hub_store *store, const struct iso_fleet_id *zones, size_t n,
                            json_t **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* -ENOMEM with a fault. */
int hub__no_memory(struct iso_fault *fault);

#endif
