/* The secure channel of OSDP, as the device has it (SIA OSDP 2.2, Annex D). Pure.
 *
 *   closed --challenge--> challenged --prove--> open        any state --close--> closed
 *
 * From the base key (SCBK) and the panel's random number RND.A come three session keys: S-ENC,
 * S-MAC1 and S-MAC2, each the AES-128 of a constant and RND.A under the SCBK. Both sides prove that
 * they have them by encrypting both random numbers under S-ENC.
 *
 * Each frame of an open channel has a MAC: AES-CBC over the frame under S-MAC1, the last block
 * under S-MAC2, and the MAC of the other side's last frame as the initial vector. So no frame can
 * be changed, left out, repeated or sent back. The frame carries the first four bytes of the MAC.
 * Data is encrypted by AES-CBC under S-ENC, with the inverted MAC of the other side's last frame as
 * the initial vector, and ends with 0x80 and zeros up to a whole block. */
#ifndef ISO_DRIVERS_DOOR_OSDP_OSDP_SECURE_H
#define ISO_DRIVERS_DOOR_OSDP_OSDP_SECURE_H

#include "drivers/door/osdp/osdp_aes.h"
#include "drivers/door/osdp/osdp_packet.h"

enum { ISO_OSDP_RANDOM_BYTES = 8 };

enum iso_osdp_secure_state {
    ISO_OSDP_CLOSED = 0,
    ISO_OSDP_CHALLENGED, /* the panel has not proved yet that it has the key */
    ISO_OSDP_OPEN,
};

/* An all-zero channel is closed. */
struct iso_osdp_secure {
    enum iso_osdp_secure_state state;
    uint8_t s_enc[ISO_OSDP_KEY_BYTES], s_mac1[ISO_OSDP_KEY_BYTES], s_mac2[ISO_OSDP_KEY_BYTES];
    uint8_t rnd_a[ISO_OSDP_RANDOM_BYTES], rnd_b[ISO_OSDP_RANDOM_BYTES];
    uint8_t c_mac[ISO_OSDP_KEY_BYTES]; /* of the panel's last frame */
    uint8_t r_mac[ISO_OSDP_KEY_BYTES]; /* of our last frame */
};

/* The default key SCBK-D, which everyone knows. */
extern const uint8_t iso_osdp_default_key[ISO_OSDP_KEY_BYTES];

/* Closes the channel and wipes its keys. */
void iso_osdp_secure_close(struct iso_osdp_secure *secure);

/* Begins a new channel, whatever the old one was, and writes the client cryptogram. */
void iso_osdp_secure_challenge(struct iso_osdp_secure *secure,
                               const uint8_t scbk[ISO_OSDP_KEY_BYTES],
                               const uint8_t rnd_a[ISO_OSDP_RANDOM_BYTES],
                               const uint8_t rnd_b[ISO_OSDP_RANDOM_BYTES],
                               uint8_t cryptogram[ISO_OSDP_KEY_BYTES]);

/* Opens the channel if the server cryptogram is right, and writes the first R-MAC. -EACCES it is
 * wrong, or there was no challenge; the channel is closed then. */
int iso_osdp_secure_prove(struct iso_osdp_secure *secure,
                          const uint8_t cryptogram[ISO_OSDP_KEY_BYTES],
                          uint8_t rmac_i[ISO_OSDP_KEY_BYTES]) __attribute__((warn_unused_result));

/* Checks the MAC of a command with a block SCS_15 or SCS_17, decrypts the data of SCS_17 into
 * data[ISO_OSDP_FRAME_BYTES], and copies the data of SCS_15. -EACCES the channel is not open, or
 * the MAC is wrong: the channel is unchanged then, so that a frame that somebody else has put on
 * the line does no harm. -EBADMSG the MAC is right and the padding is wrong. */
int iso_osdp_secure_open(struct iso_osdp_secure *secure, const struct iso_osdp_packet *packet,
                         uint8_t *data, size_t *n_data) __attribute__((warn_unused_result));

/* Encrypts data of a reply into out[n rounded up to the next whole block, at least one byte more
 * than n]. Returns the number of bytes. */
size_t iso_osdp_secure_encrypt(const struct iso_osdp_secure *secure, const uint8_t *data, size_t n,
                               uint8_t *out);

/* Adds the MAC of a reply after the n bytes of its frame. */
void iso_osdp_secure_sign(struct iso_osdp_secure *secure, uint8_t *frame, size_t n);

#endif
