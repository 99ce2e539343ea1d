/* The secure channel of OSDP (SIA OSDP 2.2, Annex D), for both of its sides: the device, and the
 * panel that asks it. Pure.
 *
 *   device: closed --challenge--> challenged --prove--> open
 *   panel:  closed --request--> requested --answer--> challenged --confirm--> open
 *                                                     any state --close--> closed
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
    ISO_OSDP_REQUESTED,  /* a panel only: the device has not proved yet that it has the key */
    ISO_OSDP_CHALLENGED, /* the panel has not proved yet that it has the key */
    ISO_OSDP_OPEN,
};

/* An all-zero channel is closed. */
struct iso_osdp_secure {
    enum iso_osdp_secure_state state;
    uint8_t s_enc[ISO_OSDP_KEY_BYTES], s_mac1[ISO_OSDP_KEY_BYTES], s_mac2[ISO_OSDP_KEY_BYTES];
    uint8_t rnd_a[ISO_OSDP_RANDOM_BYTES], rnd_b[ISO_OSDP_RANDOM_BYTES];
    bool is_panel;                         /* this side sends commands */
    uint8_t heard_mac[ISO_OSDP_KEY_BYTES]; /* of the other side's last frame */
    uint8_t sent_mac[ISO_OSDP_KEY_BYTES];  /* of our last frame */
};

/* The default key SCBK-D, which everyone knows. */
extern const uint8_t iso_osdp_default_key[ISO_OSDP_KEY_BYTES];

/* Closes the channel and wipes its keys. */
void iso_osdp_secure_close(struct iso_osdp_secure *secure);

/* ---- the device's side of the handshake ---- */

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

/* ---- the panel's side of it ---- */

/* Begins a new channel, whatever the old one was, with the random number of CHLNG. */
void iso_osdp_secure_request(struct iso_osdp_secure *secure, const uint8_t scbk[ISO_OSDP_KEY_BYTES],
                             const uint8_t rnd_a[ISO_OSDP_RANDOM_BYTES]);

/* Checks the client cryptogram of CCRYPT, and writes the server cryptogram for SCRYPT. -EACCES it
 * is wrong, so the device has another key, or nothing was requested; the channel is closed then. */
int iso_osdp_secure_answer(struct iso_osdp_secure *secure,
                           const uint8_t rnd_b[ISO_OSDP_RANDOM_BYTES],
                           const uint8_t client[ISO_OSDP_KEY_BYTES],
                           uint8_t server[ISO_OSDP_KEY_BYTES]) __attribute__((warn_unused_result));

/* Opens the channel if the device's first R-MAC (RMAC_I) is right. -EACCES it is wrong, or there
 * was no answer; the channel is closed then. */
int iso_osdp_secure_confirm(struct iso_osdp_secure *secure,
                            const uint8_t rmac_i[ISO_OSDP_KEY_BYTES])
    __attribute__((warn_unused_result));

/* ---- frames, on both sides ---- */

/* Checks the MAC of a frame of the other side, decrypts its data into data[ISO_OSDP_FRAME_BYTES] if
 * its block is SCS_17 or SCS_18, and copies the data of SCS_15 or SCS_16. A device takes commands
 * only, a panel replies only. -EACCES the channel is not open, or the block or the MAC is wrong:
 * the channel is unchanged then, so that a frame that somebody else has put on the line does no
 * harm. -EBADMSG the MAC is right and the padding is wrong. */
int iso_osdp_secure_open(struct iso_osdp_secure *secure, const struct iso_osdp_packet *packet,
                         uint8_t *data, size_t *n_data) __attribute__((warn_unused_result));

enum { ISO_OSDP_SEALED_BYTES = 128 }; /* the most data that iso_osdp_secure_frame takes */

/* Makes a whole frame of the open channel in frame[ISO_OSDP_FRAME_BYTES]: chooses the block by
 * side and data, encrypts n bytes of data (0 to ISO_OSDP_SEALED_BYTES), and adds MAC and CRC or
 * check sum. The block in `header` is not used. Returns the number of bytes of the frame. */
size_t iso_osdp_secure_frame(struct iso_osdp_secure *secure, const struct iso_osdp_header *header,
                             const uint8_t *data, size_t n, uint8_t *frame);

#endif
