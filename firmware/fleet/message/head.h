/* How far a zone has come (HEAD of envelope.h), for doors that were away: the broker keeps the
 * newest one. Pure.
 *
 *   fields: place[64], time i64, snapshot sequence u64
 *
 * A HEAD may be old, because a broker can hold it back; what a door may rely on is in LEASE. */
#ifndef ISO_FIRMWARE_FLEET_MESSAGE_HEAD_H
#define ISO_FIRMWARE_FLEET_MESSAGE_HEAD_H

#include "firmware/fleet/message/place.h"

struct iso_fleet_head {
    struct iso_fleet_place place;
    int64_t time_s;             /* of the hub, for people */
    uint64_t snapshot_sequence; /* of the newest snapshot; 0: none. Older deltas may be gone */
};

/* -ENOMEM. */
int iso_fleet_make_head(const struct iso_fleet_head *head, const struct iso_fleet_signer *signer,
                        struct iso_fleet_bytes *out) __attribute__((warn_unused_result));

/* Errors of iso_fleet_verify(). */
int iso_fleet_read_head(const void *bytes, size_t size,
                        const uint8_t signer[ISO_FLEET_PUBLIC_BYTES], struct iso_fleet_head *out)
    __attribute__((warn_unused_result));

#endif
