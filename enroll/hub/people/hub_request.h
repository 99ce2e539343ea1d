/* People who were enrolled at a door and wait for approval. The errors of hub_store.h. */
#ifndef ISO_ENROLL_HUB_PEOPLE_HUB_REQUEST_H
#define ISO_ENROLL_HUB_PEOPLE_HUB_REQUEST_H

#include "enroll/hub/store/hub_store.h"
#include "firmware/fleet/message/change.h"

enum hub_request_state { HUB_REQUEST_PENDING, HUB_REQUEST_APPROVED, HUB_REQUEST_REJECTED };

struct hub_request {
    struct iso_fleet_id person, door;
    char name[ISO_FLEET_NAME_MAX + 1], door_name[HUB_NAME_SIZE];
    int64_t time_s;
    enum hub_request_state state;
};

/* Stores a request that a door has sent. A request that is known changes nothing; with other
 * templates it waits again. The door of a request that was rejected, or of a person who was revoked
 * since, is told again to remove the person. */
int hub_request_add(struct hub_store *store, const struct iso_fleet_id *door,
                    const struct iso_fleet_person *person, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Requests, oldest first; `all`: also those that are decided. */
int hub_request_each(struct hub_store *store, bool all,
                     int (*each)(void *context, const struct hub_request *request), void *context,
                     struct iso_fault *fault) __attribute__((warn_unused_result));

/* Finds a pending request by the id of the person, or by the name if it is the only one. */
int hub_request_find(struct hub_store *store, const char *name_or_id, struct hub_request *out,
                     struct iso_fault *fault) __attribute__((warn_unused_result));

/* Approves a request: the person becomes one of the fleet, in these zones (n_zones 0: the home zone
 * of the door). -EEXIST another person has the name, -EALREADY it is decided. */
int hub_request_approve(struct hub_store *store, const struct iso_fleet_id *person,
                        const struct iso_fleet_id *zones, size_t n_zones, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Rejects a request: the doors of the home zone are told to remove the person, and the templates
 * are deleted. */
int hub_request_reject(struct hub_store *store, const struct iso_fleet_id *person,
                       struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
