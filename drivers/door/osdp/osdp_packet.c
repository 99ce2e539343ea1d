#include "drivers/door/osdp/osdp_packet.h"

#include <errno.h>
#include <string.h>

#include "drivers/door/osdp/osdp_codes.h"

enum {
    HEADER_BYTES = 5,
    LEAST_BYTES = 7, /* header, code, check sum */
    SEQUENCE_BITS = 0x03,
    CRC_BIT = 0x04,
    BLOCK_BIT = 0x08,
};

uint16_t iso_osdp_crc(const uint8_t *bytes, size_t n)
{
    unsigned crc = 0x1D0F;
    for (size_t i = 0; i < n; i++) {
        /* Eight steps of the polynomial x^16 + x^12 + x^5 + 1 at once. */
        unsigned x = (crc >> 8 ^ bytes[i]) & 0xFF;
        x ^= x >> 4;
        crc = (crc << 8 ^ x << 12 ^ x << 5 ^ x) & 0xFFFF;
    }
    return (uint16_t)crc;
}

uint8_t iso_osdp_checksum(const uint8_t *bytes, size_t n)
{
    unsigned sum = 0;
    for (size_t i = 0; i < n; i++) {
        sum += bytes[i];
    }
    return (uint8_t)(0 - sum);
}

static size_t get_length(const uint8_t *frame)
{
    return frame[2] | (size_t)frame[3] << 8;
}

static size_t check_bytes(const uint8_t *frame)
{
    return frame[4] & CRC_BIT ? 2 : 1;
}

static bool is_intact(const uint8_t *frame, size_t n)
{
    if (check_bytes(frame) == 1) {
        return iso_osdp_checksum(frame, n) == 0;
    }
    const uint16_t crc = iso_osdp_crc(frame, n - 2);
    return frame[n - 2] == (crc & 0xFF) && frame[n - 1] == crc >> 8;
}

static bool has_mac(uint8_t block)
{
    return block >= ISO_OSDP_SCS_15 && block <= ISO_OSDP_SCS_18;
}

int iso_osdp_packet_parse(const uint8_t *frame, size_t n, struct iso_osdp_packet *out)
{
    if (n < LEAST_BYTES || n > ISO_OSDP_FRAME_BYTES || frame[0] != ISO_OSDP_SOM ||
        get_length(frame) != n || !is_intact(frame, n)) {
        return -EBADMSG;
    }
    struct iso_osdp_packet packet = {
        .address = frame[1] & (uint8_t)~ISO_OSDP_REPLY_BIT,
        .is_reply = frame[1] & ISO_OSDP_REPLY_BIT,
        .sequence = frame[4] & SEQUENCE_BITS,
        .has_crc = frame[4] & CRC_BIT,
        .frame = frame,
    };
    size_t at = HEADER_BYTES, end = n - check_bytes(frame);
    if (frame[4] & BLOCK_BIT) {
        const size_t n_block = frame[at];
        if (n_block < 2 || at + n_block >= end || frame[at + 1] == ISO_OSDP_SCS_NONE) {
            return -EBADMSG;
        }
        packet.block = frame[at + 1];
        packet.block_data = frame + at + 2;
        packet.n_block_data = n_block - 2;
        at += n_block;
    }
    if (has_mac(packet.block)) {
        if (end - at < 1 + ISO_OSDP_MAC_BYTES) {
            return -EBADMSG;
        }
        end -= ISO_OSDP_MAC_BYTES;
        packet.mac = frame + end;
    }
    if (at >= end) {
        return -EBADMSG;
    }
    packet.n_signed = end;
    packet.code = frame[at];
    packet.data = frame + at + 1;
    packet.n_data = end - at - 1;
    *out = packet;
    return 0;
}

size_t iso_osdp_packet_begin(const struct iso_osdp_header *header, const uint8_t *data,
                             size_t n_data, uint8_t *frame)
{
    const size_t n_block = header->block == ISO_OSDP_SCS_NONE ? 0 : header->block_data < 0 ? 2 : 3;
    const size_t n = HEADER_BYTES + n_block + 1 + n_data;
    const size_t length = n + (has_mac(header->block) ? ISO_OSDP_MAC_BYTES : 0) +
                          (header->has_crc ? 2 : 1);
    if (n_data > ISO_OSDP_FRAME_BYTES || length > ISO_OSDP_FRAME_BYTES) {
        return 0;
    }
    uint8_t *at = frame;
    *at++ = ISO_OSDP_SOM;
    *at++ = header->address;
    *at++ = (uint8_t)length;
    *at++ = (uint8_t)(length >> 8);
    *at++ = (uint8_t)((header->sequence & SEQUENCE_BITS) | (header->has_crc ? CRC_BIT : 0) |
                      (n_block ? BLOCK_BIT : 0));
    if (n_block) {
        *at++ = (uint8_t)n_block;
        *at++ = header->block;
    }
    if (n_block == 3) {
        *at++ = (uint8_t)header->block_data;
    }
    *at++ = header->code;
    if (n_data) {
        memcpy(at, data, n_data);
    }
    return n;
}

size_t iso_osdp_packet_end(uint8_t *frame, size_t n)
{
    if (check_bytes(frame) == 1) {
        frame[n] = iso_osdp_checksum(frame, n);
        return n + 1;
    }
    const uint16_t crc = iso_osdp_crc(frame, n);
    frame[n] = (uint8_t)crc;
    frame[n + 1] = (uint8_t)(crc >> 8);
    return n + 2;
}

/* ---- frames in a stream ---- */

void iso_osdp_receiver_reset(struct iso_osdp_receiver *receiver)
{
    receiver->n = receiver->taken = 0;
}

static void drop(struct iso_osdp_receiver *receiver, size_t n)
{
    receiver->n -= n;
    memmove(receiver->bytes, receiver->bytes + n, receiver->n);
}

/* Drops what is before the next byte that may begin a frame. */
static void drop_noise(struct iso_osdp_receiver *receiver)
{
    const uint8_t *som = memchr(receiver->bytes, ISO_OSDP_SOM, receiver->n);
    drop(receiver, som ? (size_t)(som - receiver->bytes) : receiver->n);
}

bool iso_osdp_receiver_next(struct iso_osdp_receiver *receiver, struct iso_osdp_packet *out)
{
    drop(receiver, receiver->taken);
    receiver->taken = 0;
    for (;;) {
        drop_noise(receiver);
        if (receiver->n < HEADER_BYTES) {
            return false;
        }
        const size_t length = get_length(receiver->bytes);
        if (length >= LEAST_BYTES && length <= ISO_OSDP_FRAME_BYTES) {
            if (receiver->n < length) {
                return false;
            }
            if (iso_osdp_packet_parse(receiver->bytes, length, out) == 0) {
                receiver->taken = length;
                return true;
            }
        }
        receiver->damaged++;
        drop(receiver, 1);
    }
}

bool iso_osdp_receiver_push(struct iso_osdp_receiver *receiver, uint8_t byte,
                            struct iso_osdp_packet *out)
{
    drop(receiver, receiver->taken);
    receiver->taken = 0;
    /* There is room: a frame that fills the buffer is given out or dropped as soon as it is whole.
     */
    receiver->bytes[receiver->n++] = byte;
    return iso_osdp_receiver_next(receiver, out);
}
