/* How a zone changes: within a transaction its row is locked, so that its changes have an order,
 * and then each change becomes the next delta. Internal to the rooms of the hub that change
 * something. All functions are called within a transaction (hub_db_transaction). */
#ifndef ISO_ENROLL_HUB_STORE_HUB_CHANGE_H
#define ISO_ENROLL_HUB_STORE_HUB_CHANGE_H

#include "enroll/hub/store/hub_store.h"
#include "firmware/fleet/message/change.h"

#define HUB__NOTIFICATION "isotherm_hub" /* the channel of the database */

/* A zone whose row is locked until the transaction ends. The owner wipes it. */
struct hub__zone {
    char name[HUB_NAME_SIZE];
    struct iso_fleet_place place;
    struct iso_fleet_zone_key key;
    bool lockdown, behind;
};

/* Locks a zone. -ENOENT; -ESTALE it is behind its doors. */
int hub__zone_lock(struct hub_store *store, const struct iso_fleet_id *id, struct hub__zone *out,
                   struct iso_fault *fault) __attribute__((warn_unused_result));

/* The same also for a zone that is behind its doors. */
int hub__zone_lock_any(struct hub_store *store, const struct iso_fleet_id *id,
                       struct hub__zone *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

void hub__zone_wipe(struct hub__zone *zone);

/* Makes the next delta of a locked zone, stores it, and moves the zone to its place. -EFBIG. */
int hub__zone_append(struct hub_store *store, struct hub__zone *zone,
                     const struct iso_fleet_change *change, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Locks a zone, appends a change and wipes the zone. */
int hub__zone_change(struct hub_store *store, const struct iso_fleet_id *id,
                     const struct iso_fleet_change *change, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Begins the next epoch of a locked zone with a new key. */
int hub__zone_next_epoch(struct hub_store *store, struct hub__zone *zone, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Locks a zone, begins its next epoch and wipes the zone. A zone that is behind its doors stays as
 * it is: nothing changes in it until a recovery, which brings a new key. So a door that says it is
 * ahead can be expelled. */
int hub__zone_renew(struct hub_store *store, const struct iso_fleet_id *id, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Begins this epoch of a locked zone with a reset, at this sequence. */
int hub__zone_reset(struct hub_store *store, struct hub__zone *zone, uint64_t epoch,
                    uint64_t sequence, struct iso_fault *fault) __attribute__((warn_unused_result));

/* Puts ids into the order in which zones are locked, and removes repeated ones. Returns how many
 * are left. All transactions lock in this order, so that they do not wait for each other in a
 * circle. */
size_t hub__ids_in_order(struct iso_fleet_id *ids, size_t n);

/* Opens the key of a zone as it is stored. -EBADMSG with a fault: the keys of the hub are others.
 */
int hub__zone_key_open(struct hub_store *store, const struct iso_fleet_id *zone, const void *sealed,
                       size_t size, struct iso_fleet_zone_key *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* A new key, as it is stored. The caller frees *sealed. */
int hub__zone_key_make(struct hub_store *store, const struct iso_fleet_id *zone,
                       struct iso_fleet_zone_key *out, struct iso_fleet_bytes *sealed,
                       struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
