/* That a door belongs to a fleet (MEMBERSHIP of envelope.h), and the topics of the broker. Pure.
 *
 *   fields: door[16], signs[32], receives[32], door signs[32], hub name text, door name text
 *
 * The hub signs it with the key that it names. The door trusts that key because it asked for it
 * over HTTPS with the one-time code, and because its administrator has given it to the daemon. */
#ifndef ISO_FIRMWARE_FLEET_MESSAGE_MEMBERSHIP_H
#define ISO_FIRMWARE_FLEET_MESSAGE_MEMBERSHIP_H

#include "firmware/fleet/message/envelope.h"
#include "firmware/fleet/message/fleet_id.h"

enum { ISO_FLEET_TITLE_SIZE = 65, ISO_FLEET_TOPIC_SIZE = 80 };

struct iso_fleet_membership {
    struct iso_fleet_id door;
    uint8_t hub_signs[ISO_FLEET_PUBLIC_BYTES], hub_receives[ISO_FLEET_PUBLIC_BYTES];
    uint8_t door_signs[ISO_FLEET_PUBLIC_BYTES]; /* for which door it was made */
    char hub_name[ISO_FLEET_TITLE_SIZE], door_name[ISO_FLEET_TITLE_SIZE]; /* UTF-8, for people */
};

/* `signer` is the pair of hub_signs. -ENOMEM. */
int iso_fleet_make_membership(const struct iso_fleet_membership *membership,
                              const struct iso_fleet_signer *signer, struct iso_fleet_bytes *out)
    __attribute__((warn_unused_result));

/* Errors of iso_fleet_verify(). */
int iso_fleet_read_membership(const void *bytes, size_t size, struct iso_fleet_membership *out)
    __attribute__((warn_unused_result));

/* ---- topics, MQTT 5. Everything has QoS 1 ---- */

/* DELTA of a zone; and its HEAD, which the broker retains. */
const char *iso_fleet_topic_delta(const struct iso_fleet_id *zone,
                                  char topic[ISO_FLEET_TOPIC_SIZE]);
const char *iso_fleet_topic_head(const struct iso_fleet_id *zone, char topic[ISO_FLEET_TOPIC_SIZE]);

/* KEY, LEASE and ACK for a door; QUESTION, EVENTS and REQUEST from it; and whether it is connected:
 * "1" or "0", which the broker retains. */
const char *iso_fleet_topic_in(const struct iso_fleet_id *door, char topic[ISO_FLEET_TOPIC_SIZE]);
const char *iso_fleet_topic_out(const struct iso_fleet_id *door, char topic[ISO_FLEET_TOPIC_SIZE]);
const char *iso_fleet_topic_online(const struct iso_fleet_id *door,
                                   char topic[ISO_FLEET_TOPIC_SIZE]);

/* What the hub subscribes to. */
#define ISO_FLEET_TOPIC_ALL_OUT    "isotherm/door/+/out"
#define ISO_FLEET_TOPIC_ALL_ONLINE "isotherm/door/+/online"

#endif
