/* The key of a zone's epoch for one door (KEY of envelope.h). Pure.
 *
 *   fields: door[16], zone[16], epoch u64, base sequence u64, base digest[32], reset u8, sealed key
 *
 * The epoch goes on from the base: the last delta of the epoch before. A door that is there takes
 * the key and goes on. With `reset` the hub has lost the history that some doors have: a door then
 * takes a snapshot of the new epoch in place of what it has of the zone. */
#ifndef ISO_FIRMWARE_FLEET_MESSAGE_ZONE_KEY_H
#define ISO_FIRMWARE_FLEET_MESSAGE_ZONE_KEY_H

#include <stdbool.h>

#include "firmware/fleet/message/place.h"

struct iso_fleet_key_grant {
    struct iso_fleet_id door;
    struct iso_fleet_place base; /* zone, the new epoch, and where it begins */
    bool reset;
    struct iso_fleet_zone_key key; /* the owner wipes it */
};

/* -ENOMEM. */
int iso_fleet_make_key(const struct iso_fleet_key_grant *grant,
                       const uint8_t to[ISO_FLEET_PUBLIC_BYTES],
                       const struct iso_fleet_signer *signer, struct iso_fleet_bytes *out)
    __attribute__((warn_unused_result));

/* Errors of iso_fleet_verify() and iso_fleet_take_sealed(). The caller compares the door. */
int iso_fleet_read_key(const void *bytes, size_t size, const uint8_t signer[ISO_FLEET_PUBLIC_BYTES],
                       const struct iso_fleet_receiver *receiver, struct iso_fleet_key_grant *out)
    __attribute__((warn_unused_result));

#endif
