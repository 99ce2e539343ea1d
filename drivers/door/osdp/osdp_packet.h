/* Frames of OSDP: reading, making, and finding them in a stream of bytes. Pure: no device and no
 * clock is used.
 *
 *   0x53 | address, 0x80 added in a reply | length u16 | control | security block | code | data |
 *   MAC (4 bytes, with the blocks SCS_15 to SCS_18) | CRC-16 or check sum
 *
 * The length counts all bytes of the frame, numbers have their lowest byte first. Control: bits 0
 * and 1 are the sequence number, bit 2 says that a CRC-16 ends the frame (else a check sum of one
 * byte), bit 3 says that there is a security block. A security block begins with its own length and
 * its type. */
#ifndef ISO_DRIVERS_DOOR_OSDP_OSDP_PACKET_H
#define ISO_DRIVERS_DOOR_OSDP_OSDP_PACKET_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    ISO_OSDP_SOM = 0x53,
    ISO_OSDP_BROADCAST = 0x7F, /* every device answers this address */
    ISO_OSDP_REPLY_BIT = 0x80,
    ISO_OSDP_FRAME_BYTES = 1440, /* the longest frame */
    ISO_OSDP_MAC_BYTES = 4,      /* of a MAC, in a frame */
};

/* A frame that has been read. The pointers point into the frame. */
struct iso_osdp_packet {
    uint8_t address; /* without ISO_OSDP_REPLY_BIT */
    bool is_reply;
    uint8_t sequence; /* 0 to 3 */
    bool has_crc;
    uint8_t block; /* enum iso_osdp_block; ISO_OSDP_SCS_NONE: there is none */
    const uint8_t *block_data;
    size_t n_block_data;
    uint8_t code;
    const uint8_t *data;
    size_t n_data;
    const uint8_t *mac;   /* [ISO_OSDP_MAC_BYTES], or NULL */
    const uint8_t *frame; /* where the frame begins, and so what a MAC covers */
    size_t n_signed;      /* the number of bytes that a MAC covers: all before it */
};

/* The CRC-16 of OSDP (polynomial 0x1021, start value 0x1D0F) and the check sum: the value with
 * which the sum of all bytes becomes 0. */
uint16_t iso_osdp_crc(const uint8_t *bytes, size_t n);
uint8_t iso_osdp_checksum(const uint8_t *bytes, size_t n);

/* Reads one frame of n bytes. -EBADMSG the length, the CRC or a block is wrong. */
int iso_osdp_packet_parse(const uint8_t *frame, size_t n, struct iso_osdp_packet *out)
    __attribute__((warn_unused_result));

/* What a new frame begins with. */
struct iso_osdp_header {
    uint8_t address; /* with ISO_OSDP_REPLY_BIT in a reply */
    uint8_t sequence;
    bool has_crc;
    uint8_t block;  /* enum iso_osdp_block */
    int block_data; /* the one byte of the block's data, or -1: it has none */
    uint8_t code;
};

/* Writes header, code and data into frame[ISO_OSDP_FRAME_BYTES], with the length that the frame
 * will have with a MAC if its block needs one. Returns the number of bytes so far, or 0 if the
 * frame would be too long. The caller adds the MAC and then calls iso_osdp_packet_end. */
size_t iso_osdp_packet_begin(const struct iso_osdp_header *header, const uint8_t *data,
                             size_t n_data, uint8_t *frame);

/* Adds CRC or check sum after the n bytes of a frame. Returns the number of bytes of the frame. */
size_t iso_osdp_packet_end(uint8_t *frame, size_t n);

/* ---- frames in a stream ---- */

/* Collects bytes until a frame is whole. After damage it looks for the next frame within the bytes
 * that it has. So a frame with a wrong length does not lose the good frame that follows it. */
struct iso_osdp_receiver {
    uint8_t bytes[ISO_OSDP_FRAME_BYTES];
    size_t n;
    size_t taken; /* the bytes of the frame that was given out last; they are still in `bytes` */
    uint64_t damaged; /* beginnings of frames that proved to be none, or frames with a wrong CRC */
};

/* An all-zero receiver is empty. Forgets the bytes of an unfinished frame. */
void iso_osdp_receiver_reset(struct iso_osdp_receiver *receiver);

/* Takes one byte. Returns true when a frame is whole; *out then points into the receiver until the
 * next call. Further frames may be in the bytes that follow damage: call
 * iso_osdp_receiver_next until it returns false. */
bool iso_osdp_receiver_push(struct iso_osdp_receiver *receiver, uint8_t byte,
                            struct iso_osdp_packet *out);
bool iso_osdp_receiver_next(struct iso_osdp_receiver *receiver, struct iso_osdp_packet *out);

#endif
