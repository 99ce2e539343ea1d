/* A door for tests of the hub: it plays the door's side of the messages with
 * firmware/fleet/message, and keeps the people of its zones. Failures fail the running cmocka test.
 */
#ifndef TESTS_ENROLL_STORE_RIGS_PLAYED_DOOR_H
#define TESTS_ENROLL_STORE_RIGS_PLAYED_DOOR_H

#include "enroll/hub/answer/hub_answer.h"
#include "firmware/fleet/message/lease.h"
#include "firmware/fleet/order/update_order.h"
#include "tests/enroll/hub/rigs/store_rig.h"

enum { PLAYED_DOOR_PEOPLE = 512 };

struct played_door_person {
    struct iso_fleet_id id, zone;
    uint64_t revision;
    char name[80];
    uint8_t templates[ISO_FLEET_DIGEST_BYTES];
    bool offline_ok;
};

struct played_door_zone {
    struct iso_fleet_place place;
    struct iso_fleet_zone_key key, old_key;
    struct iso_fleet_place base; /* of the key */
    bool wants_snapshot;
    bool lockdown;
    char policy[4096];
};

struct played_door {
    struct iso_fleet_id id;
    struct iso_fleet_signer signs;
    struct iso_fleet_receiver receives;
    uint8_t hub_signs[ISO_FLEET_PUBLIC_BYTES], hub_receives[ISO_FLEET_PUBLIC_BYTES];
    uint8_t nonce[ISO_FLEET_NONCE_BYTES];
    uint32_t algorithm;
    uint64_t last_event, acked;
    size_t n_zones, n_people;
    struct played_door_zone zones[ISO_FLEET_ZONES_MAX];
    struct played_door_person people[PLAYED_DOOR_PEOPLE];
    /* What came. */
    unsigned keys, leases, acks, applied, known, refused;
    struct iso_fleet_lease lease;
    const char *health; /* of its questions; NULL: any */
    bool is_ordered;    /* the last message was an UPDATE, which comes behind all others */
    struct iso_fleet_update update;
};

/* Adds a door to the hub and lets it join. */
void played_door_join(struct played_door *door, struct store_rig *rig, const char *name,
                      const struct iso_fleet_id *zones, size_t n_zones);

/* Joins with a code; returns the result of hub_door_join. */
int played_door_join_with(struct played_door *door, struct hub_store *store, const char *code,
                          struct iso_fault *fault);

/* Takes what the hub emits: messages on the door's own topic, deltas and heads. */
struct hub_emit played_door_emit(struct played_door *door);

/* Asks the hub, and takes the answers. Returns the result of hub_take. */
int played_door_ask(struct played_door *door, struct hub_store *store, struct iso_fault *fault);

/* Fetches what the zones of the door lack, until nothing is missing. */
void played_door_fetch(struct played_door *door, struct hub_store *store);

/* One FETCH for a zone, without taking the answer; returns the result of hub_answer_fetch. The
 * caller frees `out`. */
int played_door_fetch_raw(struct played_door *door, struct hub_store *store,
                          const struct iso_fleet_id *zone, uint64_t after,
                          enum iso_fleet_wanted what, struct iso_fleet_bytes *out,
                          enum hub_fetch_answer *answer, struct iso_fault *fault);

/* Sends records `first` to `last` of its log. Returns the result of hub_take. */
int played_door_send_events(struct played_door *door, struct hub_store *store, uint64_t first,
                            uint64_t last, struct iso_fault *fault);

/* Sends a request for a person. */
int played_door_request(struct played_door *door, struct hub_store *store,
                        const struct iso_fleet_person *person, struct iso_fault *fault);

struct played_door_zone *played_door_zone(struct played_door *door,
                                          const struct iso_fleet_id *zone);

/* The person in a zone, or NULL. */
struct played_door_person *played_door_person(struct played_door *door,
                                              const struct iso_fleet_id *zone,
                                              const struct iso_fleet_id *person);

/* How many people the door has in a zone. */
size_t played_door_count(const struct played_door *door, const struct iso_fleet_id *zone);

/* Whether two doors have the same people in a zone, with the same contents. */
bool played_door_is_same(const struct played_door *a, const struct played_door *b,
                         const struct iso_fleet_id *zone);

#endif
