/* AES-128 of one block, by nettle. The only header behind which the library is used. Nettle is the
 * cryptographic library of GnuTLS; it reads no configuration and loads no provider at run time. */
#ifndef ISO_DRIVERS_DOOR_OSDP_OSDP_AES_H
#define ISO_DRIVERS_DOOR_OSDP_OSDP_AES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { ISO_OSDP_KEY_BYTES = 16 }; /* of a key, and of a block */

/* Encrypts or decrypts one block; `in` and `out` may be the same. The schedule of the key is wiped
 * before the function returns. */
void iso_osdp_aes_encrypt(const uint8_t key[ISO_OSDP_KEY_BYTES],
                          const uint8_t in[ISO_OSDP_KEY_BYTES], uint8_t out[ISO_OSDP_KEY_BYTES]);
void iso_osdp_aes_decrypt(const uint8_t key[ISO_OSDP_KEY_BYTES],
                          const uint8_t in[ISO_OSDP_KEY_BYTES], uint8_t out[ISO_OSDP_KEY_BYTES]);

/* Compares n bytes in a time that depends on n alone. */
bool iso_osdp_equal(const void *a, const void *b, size_t n);

#endif
