/* A door of a fleet without an appliance: a real gallery, a hub made of keys and zones, and a host
 * whose clocks and faults the test sets. */
#ifndef TESTS_FIRMWARE_FLEET_DOOR_DOOR_RIG_H
#define TESTS_FIRMWARE_FLEET_DOOR_DOOR_RIG_H

#include "firmware/fleet/door/fleet.h"
#include "firmware/fleet/message/delta.h"
#include "firmware/fleet/message/head.h"
#include "firmware/fleet/message/snapshot.h"
#include "firmware/fleet/message/zone_key.h"
#include "tests/firmware/rigs/cmocka_headers.h"

enum { DOOR_RIG_NOTES = 512 };

/* A zone as the hub has it. */
struct rig_zone {
    struct iso_fleet_place place;
    struct iso_fleet_place base; /* of its epoch */
    bool reset;
    struct iso_fleet_zone_key key;
};

struct door_rig {
    const char *directory;
    struct iso_gallery *gallery;
    struct iso_fleet *fleet;
    struct iso_fleet_store store; /* of the gallery; fleet's store calls it */
    struct iso_fault fault;       /* of the last call */
    /* the host */
    struct iso_fleet_signer door_signs;
    struct iso_fleet_receiver door_receives;
    struct iso_fleet_clocks now;
    char notes[DOOR_RIG_NOTES][1400]; /* "reason person before -> after (note)" */
    int n_notes;
    int fail_applies; /* the store refuses from the n-th apply on; 0: never */
    int applies;
    bool fails_notes; /* the log cannot be written */
    bool lockdown;
    char policy[256];
    int policy_error;
    int policies; /* how often one was stored */
    /* the hub */
    struct iso_fleet_signer hub;
    struct iso_fleet_receiver hub_receives;
    struct iso_fleet_id door;
    struct rig_zone zone[3];
    uint32_t lease_s;
    bool local_people;
    uint64_t acked;
};

int door_rig_setup(void **state); /* *state: struct door_rig of a door that has joined */
int door_rig_teardown(void **state);

/* Makes the keys and the zones of the hub, and lets the door join; for a door of another kind,
 * whose fleet and public keys (door_signs, door_receives) the caller sets. */
void door_rig_make_hub(struct door_rig *rig);
void door_rig_join(struct door_rig *rig);

/* Closes and opens gallery and fleet, as a kill and a restart. */
void door_rig_restart(struct door_rig *rig);

/* The membership of the rig's hub for the rig's door. The caller frees it. */
struct iso_fleet_bytes door_rig_membership(const struct door_rig *rig);

/* Hands a message over and frees it. */
enum iso_fleet_outcome door_rig_give(struct door_rig *rig, struct iso_fleet_bytes message);

/* Asks, and answers with the first n zones. */
enum iso_fleet_outcome door_rig_answer(struct door_rig *rig, size_t n);
struct iso_fleet_bytes door_rig_lease(struct door_rig *rig,
                                      size_t n); /* asks, and makes the answer */

struct iso_fleet_bytes door_rig_key(const struct door_rig *rig, int zone);

/* A door that has n zones with their keys and a lease. */
void door_rig_begin(struct door_rig *rig, size_t n);

/* The id of a person by a small number. */
struct iso_fleet_id door_rig_id(int person);

/* Makes the next delta of a zone. face 0: no template. */
struct iso_fleet_bytes door_rig_put(struct door_rig *rig, int zone, int person, uint64_t revision,
                                    const char *name, int face, bool offline_ok);
struct iso_fleet_bytes door_rig_remove(struct door_rig *rig, int zone, int person,
                                       uint64_t revision);
struct iso_fleet_bytes door_rig_policy(struct door_rig *rig, int zone, const char *json);
struct iso_fleet_bytes door_rig_lock(struct door_rig *rig, int zone, bool on);

/* A change as it lies in a delta or a snapshot. The caller frees it. */
struct iso_fleet_bytes door_rig_change(int person, uint64_t revision, const char *name, int face);

/* A snapshot of a zone at its place, with changes that are freed. */
struct iso_fleet_bytes door_rig_snapshot(const struct door_rig *rig, int zone,
                                         struct iso_fleet_bytes *changes, size_t n);
enum iso_fleet_outcome door_rig_give_snapshot(struct door_rig *rig, struct iso_fleet_bytes file);

/* The number of somebody at the door, 0: nobody; the credential. */
int64_t door_rig_person(const struct door_rig *rig, const char *name);
struct iso_credential_record door_rig_credential(const struct door_rig *rig, const char *name);
enum iso_fleet_admission door_rig_admission(const struct door_rig *rig, const char *name);

struct iso_fleet_status door_rig_status(struct door_rig *rig);

/* Whether a record of the log contains this text. */
bool door_rig_noted(const struct door_rig *rig, const char *text);

#endif
