/* Definitions for both writing and reading a file of people (transfer.h describes its layout).
 * Internal to firmware/gallery. */
#ifndef ISO_FIRMWARE_GALLERY_TRANSFER_FORMAT_H
#define ISO_FIRMWARE_GALLERY_TRANSFER_FORMAT_H

#include <sodium.h>

#include "firmware/transfer/transfer.h"

enum {
    ISO__TRANSFER_KEY_AT = 32,
    ISO__TRANSFER_KEY_BYTES = ISO_SEAL_KEY_BYTES + crypto_box_SEALBYTES,
    ISO__TRANSFER_SIGNER_AT = ISO__TRANSFER_KEY_AT + ISO__TRANSFER_KEY_BYTES,
    ISO__TRANSFER_HEADER_BYTES = ISO__TRANSFER_SIGNER_AT + crypto_sign_PUBLICKEYBYTES,
    ISO__TRANSFER_LEAST_BYTES = ISO__TRANSFER_HEADER_BYTES + ISO_SEAL_OVERHEAD + 4 +
                                crypto_sign_BYTES,
    ISO__TRANSFER_PUBLIC_BYTES = 32, /* size of one half of an address */
};

_Static_assert(ISO__TRANSFER_HEADER_BYTES == 144 && ISO__TRANSFER_KEY_BYTES == 80,
               "as the header says");

/* One of the two key pairs of an appliance. */
struct iso__transfer_pair {
    uint8_t public[ISO__TRANSFER_PUBLIC_BYTES], secret[crypto_sign_SECRETKEYBYTES];
};

/* The pair for which others seal files; the caller wipes it. */
struct iso__transfer_pair iso__transfer_receiving_pair(const struct iso_key_ring *ring);
void iso__transfer_wipe_pair(struct iso__transfer_pair *pair);

/* Reads the two halves of an address: the key that verifies signatures, and the key for sealing.
 * -EINVAL. */
int iso__transfer_parse_address(const char *address, uint8_t halves[2][ISO__TRANSFER_PUBLIC_BYTES],
                                struct iso_fault *fault);

/* The label of the sealed people. */
struct iso_seal_label iso__transfer_body_label(const uint8_t header[ISO__TRANSFER_HEADER_BYTES]);

#endif
