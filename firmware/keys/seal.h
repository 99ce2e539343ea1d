/* Sealing: without its key nobody can read or change a record, and no record can stand in the
 * place of another.
 *
 * XChaCha20-Poly1305 (draft-irtf-cfrg-xchacha-03, with the IETF construction of RFC 8439) by
 * libsodium; a sealed record is nonce[24] | ciphertext | tag[16]. The nonce is random: with 192
 * bits no nonce occurs twice. The label tells what the record is. It is bound to the record and not
 * stored: under another label the record does not open. */
#ifndef ISO_FIRMWARE_KEYS_SEAL_H
#define ISO_FIRMWARE_KEYS_SEAL_H

#include <stddef.h>
#include <stdint.h>

#include "core/base/fault.h"

enum {
    ISO_SEAL_KEY_BYTES = 32,
    ISO_SEAL_OVERHEAD = 24 + 16, /* how much longer a sealed record is */
    ISO_SEAL_DIGEST_BYTES = 32,
    ISO_SEAL_LABEL_BYTES = 128,
};

/* The bytes of a key, not sealed; the owner wipes them. */
struct iso_seal_key {
    uint8_t bytes[ISO_SEAL_KEY_BYTES];
};

/* The place and kind of a record: a kind, then numbers and bytes of fixed width, so that different
 * labels of one kind never have the same bytes. */
struct iso_seal_label {
    uint8_t bytes[ISO_SEAL_LABEL_BYTES];
    size_t size;
};

/* Must be called before any other function of this header; may be called again. -EIO: the library
 * does not start. */
int iso_seal_start(struct iso_fault *fault) __attribute__((warn_unused_result));

/* Begins a label with its kind (a constant of the source, below 64 characters), and adds a number
 * of 8 bytes or some bytes to it. The whole label has at most ISO_SEAL_LABEL_BYTES bytes. */
struct iso_seal_label iso_seal_label_of(const char *kind);
void iso_seal_label_number(struct iso_seal_label *label, uint64_t number);
void iso_seal_label_bytes(struct iso_seal_label *label, const void *bytes, size_t size);

/* Makes a random key, or derives a key for one purpose from another key (BLAKE2b as crypto_kdf uses
 * it; context: 8 characters). */
struct iso_seal_key iso_seal_key_random(void);
struct iso_seal_key iso_seal_key_derive(const struct iso_seal_key *from, uint64_t number,
                                        const char context[8]);
void iso_seal_key_wipe(struct iso_seal_key *key);

/* Seals `size` bytes into size + ISO_SEAL_OVERHEAD bytes. The two must not overlap. */
void iso_seal_close(const struct iso_seal_key *key, const struct iso_seal_label *label,
                    const void *plain, size_t size, uint8_t *sealed);

/* Opens `size` sealed bytes into size - ISO_SEAL_OVERHEAD. -EBADMSG: cut short, changed, or sealed
 * with another key or another label; the earlier content of *plain is lost. */
int iso_seal_open(const struct iso_seal_key *key, const struct iso_seal_label *label,
                  const uint8_t *sealed, size_t size, void *plain)
    __attribute__((warn_unused_result));

/* A keyed digest (BLAKE2b, RFC 7693) of a label and bytes. */
void iso_seal_digest(const struct iso_seal_key *key, const struct iso_seal_label *label,
                     const void *bytes, size_t size, uint8_t digest[ISO_SEAL_DIGEST_BYTES]);

#endif
