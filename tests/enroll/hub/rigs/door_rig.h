/* A door as the hub sees it, played with the library of messages, libcurl and libmosquitto.
 * Failures fail the running cmocka test. */
#ifndef TESTS_HUB_RIGS_DOOR_RIG_H
#define TESTS_HUB_RIGS_DOOR_RIG_H

#include <jansson.h>

#include "firmware/fleet/message/delta.h"
#include "firmware/fleet/message/door_mail.h"
#include "firmware/fleet/message/membership.h"
#include "firmware/fleet/message/zone_key.h"
#include "tests/enroll/hub/rigs/broker_rig.h"

struct door_rig {
    const char *folder; /* of its files */
    struct iso_fleet_signer signs;
    struct iso_fleet_receiver receives;
    struct iso_fleet_membership membership;
    char id[ISO_FLEET_ID_TEXT_SIZE];
    struct iso_fleet_zone_key key; /* of its zone */
    struct iso_fleet_place place;
    char broker_host[64];
    int broker_port;
    struct broker_client client;
};

struct door_reply {
    long status; /* of HTTP; 0: the connection failed */
    char *bytes; /* with a NUL after them */
    size_t size;
};

/* CURLOPT_WRITEFUNCTION: adds to a struct door_reply. */
size_t door_reply_add(char *bytes, size_t size, size_t n, void *reply);

/* Makes the keys and a certificate request: FOLDER/door.key, FOLDER/door.csr. */
void door_rig_make(struct door_rig *door, const char *folder);

/* Posts to the hub, whose authority is in FOLDER/ca.pem. The caller frees reply->bytes. */
void door_rig_post(const struct door_rig *door, uint16_t port, const char *path, const char *type,
                   const void *bytes, size_t size, struct door_reply *reply);

/* Joins with a code; returns the status of HTTP. After 200 the membership is verified and stored.
 */
long door_rig_join(struct door_rig *door, uint16_t port, const char *code);

/* Connects to the broker and subscribes to its mail and to its zone; false: it is refused. */
bool door_rig_connect(struct door_rig *door, const struct iso_fleet_id *zone);

/* Asks a question at its place, and reads the answer. Takes the key of the zone if one comes.
 * Returns whether a lease came in time. */
bool door_rig_ask(struct door_rig *door, const char *health, uint64_t last_event,
                  struct iso_fleet_lease *lease, double seconds);

/* Goes on with the deltas that have come, from the message `from` on: each must be the next one or
 * known. Returns the number of deltas that were delivered more than once. */
unsigned door_rig_follow(struct door_rig *door, size_t from);

#endif
