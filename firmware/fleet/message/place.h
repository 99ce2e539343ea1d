/* How far a zone has come. A zone is a group of doors with the same people. Its changes are one
 * stream of deltas (delta.h), numbered 1, 2, 3, ... without a gap. Each delta contains the digest
 * of the one before, so that equal places mean equal histories.
 *
 * An epoch is the time of one key of the zone. A new epoch begins when a door leaves, or when the
 * hub has lost a part of the stream. The numbers go on. */
#ifndef ISO_FIRMWARE_FLEET_MESSAGE_PLACE_H
#define ISO_FIRMWARE_FLEET_MESSAGE_PLACE_H

#include "firmware/fleet/message/envelope.h"
#include "firmware/fleet/message/fleet_id.h"

struct iso_fleet_place {
    struct iso_fleet_id zone;
    uint64_t epoch;                         /* 1, 2, ... */
    uint64_t sequence;                      /* of the last delta; 0: there was none */
    uint8_t digest[ISO_FLEET_DIGEST_BYTES]; /* of the last delta; zeros before the first */
};

/* A place as 64 bytes: zone, epoch, sequence, digest. */
void iso_fleet_put_place(struct iso_fleet_bytes *out, const struct iso_fleet_place *place);
struct iso_fleet_place iso_fleet_take_place(struct iso_fleet_reader *in);

/* A list: n u8, then the places. take: a list of more than ISO_FLEET_ZONES_MAX is bad. */
void iso_fleet_put_places(struct iso_fleet_bytes *out, const struct iso_fleet_place *places,
                          size_t n);
size_t iso_fleet_take_places(struct iso_fleet_reader *in,
                             struct iso_fleet_place places[ISO_FLEET_ZONES_MAX]);

#endif
