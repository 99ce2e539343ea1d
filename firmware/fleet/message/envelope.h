/* The envelope of every message of a fleet: what it is, its fields, and a signature. Pure.
 *
 *     0  magic "ISOF", version u8 = 1, kind u8 (enum iso_fleet_kind), 2 zero bytes
 *     8  the fields of the kind
 *   end  signature[64]: Ed25519 (RFC 8032) of everything before it
 *
 * The hub signs with the key of the fleet, which each door learns when it joins; a door signs with
 * the key of its appliance (firmware/transfer/transfer.h), which the hub learns then. A signature
 * covers the kind, so that no message can be taken for one of another kind.
 *
 *   hub -> door    MEMBERSHIP  once, over HTTPS, when the door joins
 *                  KEY         the key of a zone, sealed for one door
 *                  DELTA       one change of a zone, sealed with the zone's key
 *                  HEAD        how far a zone has come
 *                  LEASE       the answer to a QUESTION
 *                  ACK         up to which number the events of a door are stored
 *                  SNAPSHOT    all people of a zone; a file (snapshot.h)
 *                  UPDATE      which update of its image the door shall install
 *   door -> hub    QUESTION    what the door has; asks for a lease
 *                  EVENTS      records of the door's log, sealed for the hub
 *                  REQUEST     a person who was enrolled at the door, sealed for the hub
 *                  FETCH       asks over HTTPS for deltas, a snapshot, or a part of an update
 *
 * Versions. Magic, version and the place of the signature are the same in every version, so that a
 * program verifies a message that it cannot read, and believes the hub alone that it is older. A
 * version has exactly its fields: a message or a change with a further field, or with an unknown
 * flag, is refused as a whole. Only the health in a QUESTION, which is for people, may have further
 * members. So a new field is a new version. A new kind of change is refused by doors that do not
 * know it.
 *
 * A door that refuses a message does not skip it: the door stays at its place with what it has,
 * says what is wrong, and fetches the same again later. Its lease is not renewed, because a lease
 * counts for a door that has what the hub lists; so nobody is let in for long whom the unread
 * message may have revoked. A newer program reads the message, and nothing is lost. The health
 * tells the version that the door reads ("message-version"; without it: 1). A hub that can write a
 * newer version writes it in a zone when all doors of the zone read it. */
#ifndef ISO_FIRMWARE_FLEET_MESSAGE_ENVELOPE_H
#define ISO_FIRMWARE_FLEET_MESSAGE_ENVELOPE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/base/fault.h"
#include "firmware/fleet/message/wire.h"

/* The numbers are in the messages. */
enum iso_fleet_kind {
    ISO_FLEET_MEMBERSHIP = 1,
    ISO_FLEET_KEY = 2,
    ISO_FLEET_DELTA = 3,
    ISO_FLEET_HEAD = 4,
    ISO_FLEET_LEASE = 5,
    ISO_FLEET_ACK = 6,
    ISO_FLEET_SNAPSHOT = 7,
    ISO_FLEET_UPDATE = 8,
    ISO_FLEET_QUESTION = 16,
    ISO_FLEET_EVENTS = 17,
    ISO_FLEET_REQUEST = 18,
    ISO_FLEET_FETCH = 19,
};

enum {
    ISO_FLEET_VERSION = 1,
    ISO_FLEET_HEADER_BYTES = 8,
    ISO_FLEET_SIGNATURE_BYTES = 64,
    ISO_FLEET_PUBLIC_BYTES = 32,
    ISO_FLEET_SECRET_BYTES = 64, /* of a signing pair */
    ISO_FLEET_KEY_BYTES = 32,
    ISO_FLEET_DIGEST_BYTES = 32,
    ISO_FLEET_ZONES_MAX = 8,                /* of one door */
    ISO_FLEET_MESSAGE_MAX = 4 << 20,        /* bytes; a SNAPSHOT may be longer */
    ISO_FLEET_SNAPSHOT_CHUNK_MAX = 4 << 20, /* bytes of one change in a snapshot */
};

/* A pair that signs. The owner wipes it. */
struct iso_fleet_signer {
    uint8_t public[ISO_FLEET_PUBLIC_BYTES], secret[ISO_FLEET_SECRET_BYTES];
};

/* A pair for which others seal: X25519. The owner wipes it. */
struct iso_fleet_receiver {
    uint8_t public[ISO_FLEET_PUBLIC_BYTES], secret[ISO_FLEET_KEY_BYTES];
};

/* The key of a zone in one epoch. The owner wipes it. */
struct iso_fleet_zone_key {
    uint8_t bytes[ISO_FLEET_KEY_BYTES];
};

/* Starts libsodium. A program calls this function before any other of firmware/fleet/message; it
 * may call it several times. -EIO libsodium does not start. */
int iso_fleet_start(struct iso_fault *fault) __attribute__((warn_unused_result));

/* Begins a message in empty bytes. */
void iso_fleet_begin(struct iso_fleet_bytes *out, enum iso_fleet_kind kind);

/* Ends it with the signature. Returns out->error; after an error `out` is freed. */
int iso_fleet_sign(struct iso_fleet_bytes *out, const struct iso_fleet_signer *signer)
    __attribute__((warn_unused_result));

/* The kind of a message that has not been verified. -EBADMSG it is none, -EPROTONOSUPPORT a newer
 * version. */
int iso_fleet_kind_of(const void *bytes, size_t size, enum iso_fleet_kind *kind)
    __attribute__((warn_unused_result));

/* Whether the owner of the key has signed a message of a newer version; a SNAPSHOT is signed in
 * another way (snapshot.h). */
bool iso_fleet_is_newer(const void *bytes, size_t size,
                        const uint8_t signer[ISO_FLEET_PUBLIC_BYTES]);

/* Verifies the signature and the kind, and sets a reader to the fields. -EBADMSG it is no message
 * of this kind, -EPROTONOSUPPORT the signer has made it, of a newer version, -EKEYREJECTED somebody
 * else has signed it. */
int iso_fleet_verify(const void *bytes, size_t size, enum iso_fleet_kind kind,
                     const uint8_t signer[ISO_FLEET_PUBLIC_BYTES], struct iso_fleet_reader *fields)
    __attribute__((warn_unused_result));

/* BLAKE2b-256 of the bytes. */
void iso_fleet_digest(const void *bytes, size_t size, uint8_t digest[ISO_FLEET_DIGEST_BYTES]);

/* Seals bytes for the owner of a receiving pair (crypto_box_seal of libsodium) as a field: u32
 * length, sealed bytes. */
void iso_fleet_put_sealed(struct iso_fleet_bytes *out, const uint8_t to[ISO_FLEET_PUBLIC_BYTES],
                          const void *plain, size_t size);

/* Reads and opens such a field. The caller frees the bytes. -EBADMSG it is bad, -EKEYREJECTED it is
 * sealed for another receiver, -ENOMEM. */
int iso_fleet_take_sealed(struct iso_fleet_reader *in, const struct iso_fleet_receiver *receiver,
                          struct iso_fleet_bytes *plain) __attribute__((warn_unused_result));

#endif
