/* Zones: what holds in them, their epochs, and how far they have come. The errors of hub_store.h.
 */
#ifndef ISO_ENROLL_HUB_STORE_HUB_ZONE_H
#define ISO_ENROLL_HUB_STORE_HUB_ZONE_H

#include "enroll/hub/store/hub_store.h"

struct hub_zone_settings {
    uint32_t lease_s;  /* how long a door acts without the hub; 0: ISO_FLEET_LEASE_ONLINE_S */
    bool local_people; /* people who were enrolled at a door and are not approved are admitted */
    bool approve_auto; /* people who were enrolled at a door are approved at once */
};

struct hub_zone {
    struct iso_fleet_place place; /* id, epoch, sequence, digest */
    struct iso_fleet_place base;  /* where the epoch began */
    uint64_t reset_epoch; /* the newest epoch that began with a reset; 0: none. A door of an earlier
                           * epoch has to take a snapshot */
    uint64_t reset_sequence; /* its base */
    char name[HUB_NAME_SIZE];
    struct hub_zone_settings settings;
    bool lockdown;
    bool behind; /* a door knows more than this database: nothing is changed until a recovery */
    uint64_t published;         /* the last delta that the broker has */
    uint64_t snapshot_sequence; /* of the newest snapshot; 0: none */
    uint64_t people, doors;
};

/* Adds a zone with the standard settings: lease ISO_FLEET_LEASE_DEFAULT_S, no local people,
 * approval by a person. */
int hub_zone_add(struct hub_store *store, const char *name, struct iso_fleet_id *out,
                 struct iso_fault *fault) __attribute__((warn_unused_result));

/* Finds a zone by its name or its id. */
int hub_zone_find(struct hub_store *store, const char *name_or_id, struct hub_zone *out,
                  struct iso_fault *fault) __attribute__((warn_unused_result));

/* All zones by name. */
int hub_zone_each(struct hub_store *store, int (*each)(void *context, const struct hub_zone *zone),
                  void *context, struct iso_fault *fault) __attribute__((warn_unused_result));

int hub_zone_set(struct hub_store *store, const struct iso_fleet_id *zone,
                 const struct hub_zone_settings *settings, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Sets the policy (JSON text of the policy document; "": none), which goes to the doors as a
 * change. -EINVAL it is no policy, -EFBIG. get: the caller frees *document. */
int hub_zone_set_policy(struct hub_store *store, const struct iso_fleet_id *zone,
                        const char *document, struct iso_fault *fault)
    __attribute__((warn_unused_result));
int hub_zone_get_policy(struct hub_store *store, const struct iso_fleet_id *zone, char **document,
                        struct iso_fault *fault) __attribute__((warn_unused_result));

/* Begins or ends the lockdown of a zone, or of all zones (`zone` is NULL) in one transaction. A
 * zone that is in this state already does not change. */
int hub_zone_lockdown(struct hub_store *store, const struct iso_fleet_id *zone, bool on,
                      struct iso_fault *fault) __attribute__((warn_unused_result));

/* Begins a new epoch with a new key, which the doors of the zone get; so a door that has left can
 * open nothing more. */
int hub_zone_new_epoch(struct hub_store *store, const struct iso_fleet_id *zone,
                       struct iso_fault *fault) __attribute__((warn_unused_result));

/* Begins a new epoch with a reset, above every place that a door has reported, and lets the zone
 * change again: all its doors take a snapshot of what this database knows. -EALREADY the zone is
 * not behind its doors. */
int hub_zone_recover(struct hub_store *store, const struct iso_fleet_id *zone,
                     struct iso_fault *fault) __attribute__((warn_unused_result));

/* A door of a zone that has not confirmed the zone's place. */
struct hub_behind {
    struct iso_fleet_id door;
    const char *name;
    uint64_t epoch, sequence; /* which it has reported last; 0, 0: nothing */
    int64_t reported_s;       /* 0: never */
    bool online;
};

/* The doors of a zone whose last report is not at the zone's place, by name. */
int hub_doors_behind(struct hub_store *store, const struct iso_fleet_id *zone,
                     int (*each)(void *context, const struct hub_behind *door), void *context,
                     struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
