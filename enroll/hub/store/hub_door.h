/* Doors: how they join, which zones they belong to, and what they have reported last. The errors of
 * hub_store.h. */
#ifndef ISO_ENROLL_HUB_STORE_HUB_DOOR_H
#define ISO_ENROLL_HUB_STORE_HUB_DOOR_H

#include "enroll/hub/store/hub_store.h"
#include "firmware/fleet/message/lease.h"

enum {
    HUB_CODE_SIZE = 33,            /* of a one-time code: 32 letters and digits of base32 */
    HUB_CODE_VALID_S = 3600,       /* how long a code can be used */
    HUB_DOOR_ADDRESS_DIGITS = 128, /* hexadecimal: signing and receiving public key of a door */
};

struct hub_door {
    struct iso_fleet_id id;
    char name[HUB_NAME_SIZE];
    int64_t joined_s, expelled_s; /* 0: not */
    int64_t code_until_s;         /* 0: no code is open */
    uint8_t signs[ISO_FLEET_PUBLIC_BYTES], receives[ISO_FLEET_PUBLIC_BYTES]; /* if joined */
    size_t n_zones;
    struct iso_fleet_id zones[ISO_FLEET_ZONES_MAX]; /* the first is its home */
    char zone_names[ISO_FLEET_ZONES_MAX][HUB_NAME_SIZE];
    bool online;
    int64_t reported_s, door_time_s; /* the last QUESTION; 0: none, and the door's clock */
    uint32_t algorithm;
    uint64_t last_event, acked;
    char health[ISO_FLEET_HEALTH_MAX + 1]; /* JSON, or "" */
};

/* Adds a door that has not joined, and makes its one-time code. 1 to ISO_FLEET_ZONES_MAX zones. */
int hub_door_add(struct hub_store *store, const char *name, const struct iso_fleet_id *zones,
                 size_t n_zones, struct iso_fleet_id *out, char code[HUB_CODE_SIZE],
                 struct iso_fault *fault) __attribute__((warn_unused_result));

/* Makes a new code in place of an earlier one; with it the same appliance may also join again.
 * -EACCES the door is expelled. */
int hub_door_new_code(struct hub_store *store, const struct iso_fleet_id *door,
                      char code[HUB_CODE_SIZE], struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Finds a door by its name or its id. Of doors with the same name all but one are expelled; the
 * name finds the one that is not, else the one that was expelled last. */
int hub_door_find(struct hub_store *store, const char *name_or_id, struct hub_door *out,
                  struct iso_fault *fault) __attribute__((warn_unused_result));
int hub_door_get(struct hub_store *store, const struct iso_fleet_id *door, struct hub_door *out,
                 struct iso_fault *fault) __attribute__((warn_unused_result));

/* All doors by name. */
int hub_door_each(struct hub_store *store, bool with_expelled,
                  int (*each)(void *context, const struct hub_door *door), void *context,
                  struct iso_fault *fault) __attribute__((warn_unused_result));

/* Moves a door to these zones. Each zone that it leaves begins a new epoch. */
int hub_door_move(struct hub_store *store, const struct iso_fleet_id *door,
                  const struct iso_fleet_id *zones, size_t n_zones, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Expels a door: its messages are refused from now on, and each of its zones begins a new epoch,
 * whose key it does not get. -EALREADY. */
int hub_door_expel(struct hub_store *store, const struct iso_fleet_id *door,
                   struct iso_fault *fault) __attribute__((warn_unused_result));

/* Stores whether the broker sees the door. Of unknown doors: nothing. No act is recorded. */
int hub_door_set_online(struct hub_store *store, const struct iso_fleet_id *door, bool online,
                        struct iso_fault *fault) __attribute__((warn_unused_result));

/* Stores that no door is online, for a hub that has lost the broker. */
int hub_door_all_offline(struct hub_store *store, struct iso_fault *fault)
    __attribute__((warn_unused_result));

struct hub_join {
    const char *code;
    const char *address; /* HUB_DOOR_ADDRESS_DIGITS digits: GetAddress of the appliance */
    const char *name;    /* by which the appliance calls itself; "": not said. The door keeps the
                          * name that it was added with; the act records this one */
};

/* Lets an appliance join with a code, which is used up. `membership` (empty) receives the bytes of
 * MEMBERSHIP; the caller frees it. -EACCES the code is unknown, used, or older than an hour;
 * -EINVAL the address is none; -EEXIST the appliance belongs to another door of this fleet, or the
 * door has another appliance. */
int hub_door_join(struct hub_store *store, const struct hub_join *join, struct iso_fleet_id *door,
                  struct iso_fleet_bytes *membership, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
