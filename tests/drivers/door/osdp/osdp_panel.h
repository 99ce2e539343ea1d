/* An access panel for the tests of OSDP. It is written from the standard (SIA OSDP 2.2) and shares
 * no code with the driver: its CRC is computed bit by bit, its AES is that of OpenSSL. */
#ifndef TESTS_DRIVERS_DOOR_OSDP_OSDP_PANEL_H
#define TESTS_DRIVERS_DOOR_OSDP_OSDP_PANEL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { PANEL_FRAME_BYTES = 1440 };

/* What the panel says, and what it wants to hear. */
struct panel {
    uint8_t address;
    bool checksum; /* instead of the CRC */
    bool secure;   /* the channel is open: all frames have a MAC */
    int sequence;  /* of the last frame; -1: the next one has 0 */
    uint8_t scbk[16], s_enc[16], s_mac1[16], s_mac2[16];
    uint8_t c_mac[16], r_mac[16];
    uint8_t rnd_a[8], rnd_b[8];
    uint8_t frame[PANEL_FRAME_BYTES]; /* the last frame, to be repeated */
    size_t n_frame;
};

/* A reply. */
struct panel_reply {
    int code;  /* -1: there was none, or it was wrong in some way */
    int block; /* 0: none */
    int block_data;
    uint8_t data[PANEL_FRAME_BYTES];
    size_t n;
};

/* Makes the frame of a command with the next sequence number. The frame is in the panel. */
void panel_make(struct panel *panel, uint8_t command, const void *data, size_t n);

/* The same in plain, with a security block (type and one byte), or none (type 0). */
void panel_make_plain(struct panel *panel, uint8_t command, int block, int block_data,
                      const void *data, size_t n);

/* Reads the reply to the last frame: checks address, sequence, CRC and MAC, and decrypts. */
void panel_read(struct panel *panel, const uint8_t *frame, size_t n, struct panel_reply *reply);

/* The steps of the handshake: the data of CHLNG; whether CCRYPT is right, and then the data of
 * SCRYPT; whether RMAC_I is right, after which the channel is open. */
void panel_challenge(struct panel *panel, const uint8_t scbk[16], const uint8_t rnd_a[8]);
bool panel_answer(struct panel *panel, const struct panel_reply *ccrypt, uint8_t proof[16]);
bool panel_begin(struct panel *panel, const struct panel_reply *rmac_i);

/* The CRC of the standard, bit by bit. */
uint16_t panel_crc(const uint8_t *bytes, size_t n);

/* Writes it after n bytes. */
void panel_put_crc(uint8_t *bytes, size_t n);

#endif
