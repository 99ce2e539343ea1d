/* What the tests of the messages of a fleet share: pairs of keys, a person, and a zone's first
 * deltas. */
#ifndef TESTS_FIRMWARE_FLEET_MESSAGE_MESSAGE_RIG_H
#define TESTS_FIRMWARE_FLEET_MESSAGE_MESSAGE_RIG_H

#include "firmware/fleet/message/delta.h"
#include "firmware/fleet/message/envelope.h"

struct message_rig {
    struct iso_fleet_signer hub, other, door;
    struct iso_fleet_receiver hub_box, door_box;
    struct iso_fleet_zone_key key;
    struct iso_fleet_place here; /* the zone after the deltas that were made */
};

/* Makes the keys; the zone has epoch 1 and no delta. */
void message_rig_start(struct message_rig *rig);

/* A person with two templates of different sizes. The bytes live as long as the program. */
struct iso_fleet_person message_rig_person(void);

/* Makes the next delta, which puts that person. The caller frees it. */
struct iso_fleet_bytes message_rig_next(struct message_rig *rig);

/* Calls `read` with the message changed in one bit of each byte, cut short at each length, and with
 * a byte more. Each must be refused: `read` returns a negative errno. */
void message_rig_damage(const struct iso_fleet_bytes *message,
                        int (*read)(void *context, const uint8_t *bytes, size_t size),
                        void *context);

#endif
