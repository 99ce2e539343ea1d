/* People with their templates as one sealed, signed file, to be copied from door to door. Pure.
 *
 *     0  magic "ISOPEOP1"
 *     8  what opens the file u8: 1 a passphrase, 2 the key of one other appliance; 7 zero bytes
 *    16  salt[16] of the passphrase; else zeros
 *    32  key[80]: the file's key for the other appliance (X25519 sealed box); else zeros
 *   112  signer[32]: Ed25519 public key of the appliance that wrote it
 *   144  people, sealed (seal.h); bytes 0 to 143 are its label
 *   end  signature[64] (Ed25519) of everything before it
 *
 * A passphrase becomes the key by Argon2id with the salt (RFC 9106; firmware/contract/contract.h
 * says how), which the client does: a daemon that watches a door has no second to spare, and the
 * passphrase stays where it was typed. The sealed bytes are: n u32, then for each person name
 * length u16, name, enrolled, valid from, valid until i64, n u32, and for each template algorithm
 * u32, size u32, bytes.
 *
 * An appliance has two key pairs, made from seeds in its key ring; the public halves, the signing
 * one first, are its address. */
#ifndef ISO_FIRMWARE_GALLERY_TRANSFER_H
#define ISO_FIRMWARE_GALLERY_TRANSFER_H

#include <stddef.h>
#include <stdint.h>

#include "core/base/fault.h"
#include "firmware/gallery/gallery.h"
#include "firmware/keys/key_ring.h"
#include "firmware/keys/seal.h"

enum {
    ISO_TRANSFER_SALT_BYTES = 16,
    ISO_TRANSFER_MAX_BYTES = 64 << 20,
    ISO_TRANSFER_ADDRESS_SIZE = 2 * 64 + 1, /* hexadecimal digits and a NUL */
};

/* Who can open a file. */
struct iso_transfer_lock {
    const char *address; /* of an appliance; NULL: `key` opens it */
    struct iso_seal_key key;
    uint8_t salt[ISO_TRANSFER_SALT_BYTES];
};

/* The address of the appliance with this ring. */
void iso_transfer_address(const struct iso_key_ring *ring, char address[ISO_TRANSFER_ADDRESS_SIZE]);

/* The key pairs of the appliance, whose public halves are its address: the first signs, the second
 * receives. The caller wipes them. */
struct iso_transfer_keys {
    uint8_t signs[32], sign_secret[64], receives[32], receive_secret[32];
};

void iso_transfer_get_keys(const struct iso_key_ring *ring, struct iso_transfer_keys *out);

/* Writes people (NULL or an empty list: all; else a list that NULL ends) into memory, which
 * iso_transfer_free releases. *n is their number. The listener counts people. -EINVAL the address
 * is not valid, -ENOENT nobody has a name of the list, -EFBIG, -ENOMEM, or an error of the gallery.
 */
int iso_transfer_write(struct iso_gallery *gallery, const char *const *people,
                       const struct iso_key_ring *ring, const struct iso_transfer_lock *lock,
                       const struct iso_work_listener *listener, uint8_t **bytes, size_t *size,
                       size_t *n, struct iso_fault *fault) __attribute__((warn_unused_result));

/* Wipes and frees it. NULL is accepted. */
void iso_transfer_free(uint8_t *bytes, size_t size);

struct iso_transfer; /* people that were read from a file */

/* Reads a file. key: from the passphrase, NULL if there is none. sender: the address that has to
 * have signed it; NULL: any sender, for a file with a passphrase. A file for this appliance needs
 * an address, because anybody can seal for an appliance. -EBADMSG damaged or another kind of file,
 * -EKEYREJECTED it is for another appliance, the passphrase is wrong, or another appliance has
 * signed it, -EINVAL the key or the address is missing or bad, -ENOMEM. */
int iso_transfer_read(const uint8_t *bytes, size_t size, const struct iso_key_ring *ring,
                      const struct iso_seal_key *key, const char *sender, struct iso_transfer **out,
                      struct iso_fault *fault) __attribute__((warn_unused_result));

/* Valid until iso_transfer_done, which wipes them. */
const struct iso_gallery_item *iso_transfer_items(const struct iso_transfer *transfer, size_t *n);

/* Wipes and frees it. NULL is accepted. */
void iso_transfer_done(struct iso_transfer *transfer);

/* Reads the people of an opened file. -EBADMSG, -ENOMEM. */
int iso_transfer_parse(const uint8_t *plain, size_t size, struct iso_transfer **out)
    __attribute__((warn_unused_result));

#endif
