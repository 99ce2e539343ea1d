/* The secrets of a hub: the pair with which it signs, the pair for which the doors seal, and the
 * key with which templates and zone keys are sealed in the database. They are in one file that only
 * its owner can read:
 *
 *     0  magic "ISOHKEYS", version u32 = 1
 *    12  signing public[32], secret[64]; receiving public[32], secret[32]; storage[32]
 *   204  BLAKE2b-256 of everything before it
 *
 * Without this file a copy of the database contains no biometric data and no key of a zone. */
#ifndef ISO_ENROLL_HUB_STORE_HUB_KEYS_H
#define ISO_ENROLL_HUB_STORE_HUB_KEYS_H

#include "core/base/fault.h"
#include "firmware/fleet/message/envelope.h"
#include "firmware/fleet/message/fleet_id.h"

/* The owner wipes it. */
struct hub_keys {
    struct iso_fleet_signer signs;
    struct iso_fleet_receiver receives;
    uint8_t storage[ISO_FLEET_KEY_BYTES];
};

/* Makes new keys and writes them into a new file of mode 0600. -EEXIST the file exists, which is
 * never overwritten; the errors of iso_file_open and of storage. */
int hub_keys_make(const char *path, struct hub_keys *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Reads the file. -EACCES others than its owner may read or write it; -EBADMSG it is no file of
 * keys or damaged; -EPROTONOSUPPORT it is of a newer version; the errors of iso_file_open. */
int hub_keys_read(const char *path, struct hub_keys *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

void hub_keys_wipe(struct hub_keys *keys);

/* Seals bytes for the database with the storage key (XChaCha20-Poly1305, random nonce). What they
 * are ("template", "zone-key", ...) and whose they are is bound to them, so that a row cannot take
 * the place of another. -ENOMEM. */
int hub_keys_seal(const struct hub_keys *keys, const char *use, const struct iso_fleet_id *owner,
                  const void *plain, size_t size, struct iso_fleet_bytes *out)
    __attribute__((warn_unused_result));

/* Opens them; the caller frees the bytes. -EKEYREJECTED they were changed, belong to somebody else,
 * or another key has sealed them; -ENOMEM. */
int hub_keys_open(const struct hub_keys *keys, const char *use, const struct iso_fleet_id *owner,
                  const void *sealed, size_t size, struct iso_fleet_bytes *out)
    __attribute__((warn_unused_result));

#endif
