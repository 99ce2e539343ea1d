/* The KEY of a zone for one door, from rows of the database. Internal to the answers. */
#ifndef ISO_ENROLL_HUB_ANSWER_HUB_GRANT_H
#define ISO_ENROLL_HUB_ANSWER_HUB_GRANT_H

#include "enroll/hub/answer/hub_answer.h"
#include "enroll/hub/store/hub_door.h"

/* A zone of a door, and what the door has of it. */
struct hub__door_zone {
    struct iso_fleet_place place, base; /* of the hub */
    uint64_t reset_epoch, reset_sequence;
    bool behind, local_people;
    uint32_t lease_s;
    struct iso_fleet_zone_key key; /* the owner wipes it */
    bool known;                    /* the door has reported a place */
    struct iso_fleet_place reported;
};

struct hub__door_zones {
    size_t n;
    struct hub__door_zone zones[ISO_FLEET_ZONES_MAX]; /* in the door's order */
};

/* Reads the zones of a door with their keys. */
int hub__door_zones(struct hub_store *store, const struct iso_fleet_id *door,
                    struct hub__door_zones *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Reads a zone with its key; what a door has of it is not known. -ENOENT: there is none. */
int hub__key_zone(struct hub_store *store, const struct iso_fleet_id *zone,
                  struct hub__door_zone *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

void hub__door_zones_wipe(struct hub__door_zones *zones);

/* Whether the door lacks the key of the zone's epoch. */
bool hub__wants_key(const struct hub__door_zone *zone);

/* Emits KEY on the door's `in` topic. */
int hub__emit_key(struct hub_store *store, const struct hub_door *door,
                  const struct hub__door_zone *zone, const struct hub_emit *emit,
                  struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
