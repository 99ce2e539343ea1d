/* One change of a zone on its way to the doors (DELTA of envelope.h). Pure.
 *
 *   fields: zone[16], epoch u64, sequence u64, time i64, before[32], sealed u32 + bytes
 *
 * `before` is the digest of the delta before (place.h); the digest of a delta is that of all its
 * bytes, with the signature. The change is sealed with the key of the zone's epoch
 * (XChaCha20-Poly1305 with a random nonce; the envelope's header and the fields before it are bound
 * to it), so that a broker and a database see who changes when, and nothing else. */
#ifndef ISO_FIRMWARE_FLEET_MESSAGE_DELTA_H
#define ISO_FIRMWARE_FLEET_MESSAGE_DELTA_H

#include "firmware/fleet/message/change.h"
#include "firmware/fleet/message/place.h"

struct iso_fleet_delta {
    struct iso_fleet_place place; /* after the delta; read: with the digest of the message */
    uint8_t before[ISO_FLEET_DIGEST_BYTES];
    int64_t time_s; /* of the hub, for people; the sequence orders */
};

/* Makes a delta of the bytes of a change. delta->place.digest is written. -ENOMEM, -EFBIG. */
int iso_fleet_make_delta(struct iso_fleet_delta *delta, const void *change, size_t size,
                         const struct iso_fleet_zone_key *key,
                         const struct iso_fleet_signer *signer, struct iso_fleet_bytes *out)
    __attribute__((warn_unused_result));

/* Verifies a delta, and reads what is not sealed. Errors of iso_fleet_verify(). */
int iso_fleet_read_delta(const void *bytes, size_t size,
                         const uint8_t signer[ISO_FLEET_PUBLIC_BYTES], struct iso_fleet_delta *out)
    __attribute__((warn_unused_result));

/* Decrypts the change in a delta that iso_fleet_read_delta() has verified. The caller frees the
 * bytes. -EKEYREJECTED the delta is sealed with another key, -EBADMSG it is too short, -ENOMEM. */
int iso_fleet_open_delta(const void *bytes, size_t size, const struct iso_fleet_zone_key *key,
                         struct iso_fleet_bytes *change) __attribute__((warn_unused_result));

/* What a delta is for one who is at `here`, an earlier place of the zone. */
enum iso_fleet_step {
    ISO_FLEET_STEP_NEXT,    /* the one that comes next */
    ISO_FLEET_STEP_KNOWN,   /* an earlier one of this history, or from before it */
    ISO_FLEET_STEP_GAP,     /* deltas before it are missing */
    ISO_FLEET_STEP_EPOCH,   /* its epoch is a later one, whose key is missing */
    ISO_FLEET_STEP_FOREIGN, /* another zone, an old epoch, or another history */
};

enum iso_fleet_step iso_fleet_step_of(const struct iso_fleet_place *here,
                                      const struct iso_fleet_delta *delta);

#endif
