/* Everything that holds in a zone at one place of its stream, as one file (SNAPSHOT of envelope.h).
 * Doors that are new or were away for long fetch it over HTTPS; it never goes through the broker.
 * Pure.
 *
 *   fields: place[64], time i64, stream header[24], then chunks: size u32, sealed bytes
 *
 * Each chunk is one change of change.h (PUT, POLICY, LOCKDOWN), sealed with the zone's key as a
 * part of a stream (crypto_secretstream of libsodium): no chunk can be left out, moved or repeated.
 * The last chunk is empty and marked as the last. The signature of the file is Ed25519ph (RFC 8032,
 * section 5.1), because the file is too long to be signed in one piece. */
#ifndef ISO_FIRMWARE_FLEET_MESSAGE_SNAPSHOT_H
#define ISO_FIRMWARE_FLEET_MESSAGE_SNAPSHOT_H

#include <sodium.h>

#include "firmware/fleet/message/change.h"
#include "firmware/fleet/message/place.h"

/* ---- writing: begin, add for each change, end ---- */

struct iso_fleet_snapshot_writer {
    /* Takes the next bytes of the file. A negative errno ends the writing. */
    int (*write)(void *context, const void *bytes, size_t size);
    void *context;
    crypto_secretstream_xchacha20poly1305_state stream;
    crypto_sign_state signature;
};

/* Writes the head. `write` and `context` are set. Errors of `write`; -ENOMEM. */
int iso_fleet_snapshot_begin(struct iso_fleet_snapshot_writer *writer,
                             const struct iso_fleet_place *place, int64_t time_s,
                             const struct iso_fleet_zone_key *key)
    __attribute__((warn_unused_result));

/* Adds a change: bytes of iso_fleet_put_change(). -EFBIG, -ENOMEM, errors of `write`. */
int iso_fleet_snapshot_add(struct iso_fleet_snapshot_writer *writer, const void *change,
                           size_t size) __attribute__((warn_unused_result));

/* Ends the file. The writer is wiped, also after an error. */
int iso_fleet_snapshot_end(struct iso_fleet_snapshot_writer *writer,
                           const struct iso_fleet_signer *signer)
    __attribute__((warn_unused_result));

/* ---- reading ---- */

/* Verifies the whole file, and reads its place. -EBADMSG; -EPROTONOSUPPORT the signer has made it,
 * of a newer version; -EKEYREJECTED. */
int iso_fleet_snapshot_verify(const uint8_t *bytes, size_t size,
                              const uint8_t signer[ISO_FLEET_PUBLIC_BYTES],
                              struct iso_fleet_place *place) __attribute__((warn_unused_result));

/* Passes each change of a verified file; its texts and templates are valid during the call. If
 * `each` returns a value other than 0, the function ends and returns it. -EKEYREJECTED the key is
 * another one, -EBADMSG, -EPROTONOSUPPORT, -ENOMEM. */
int iso_fleet_snapshot_each(const uint8_t *bytes, size_t size, const struct iso_fleet_zone_key *key,
                            int (*each)(void *context, const struct iso_fleet_change *change),
                            void *context) __attribute__((warn_unused_result));

#endif
