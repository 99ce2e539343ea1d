/* A device of OSDP: bytes of anyone on the wire, in pieces. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/door/osdp/osdp_peripheral.h"
#include "tests/fuzz/fuzz.h"

static int make_random(void *context, void *bytes, size_t n)
{
    (void)context;
    memset(bytes, 0x5A, n);
    return 0;
}

static int store(void *context, const struct iso_osdp_saved *saved)
{
    (void)context;
    fuzz_check(saved->address < ISO_OSDP_BROADCAST && iso_osdp_is_baud(saved->baud),
               "what is stored can be used");
    return 0;
}

static void give(struct iso_osdp_peripheral *device, const uint8_t *bytes, size_t n, int64_t now_ns)
{
    uint8_t reply[ISO_OSDP_FRAME_BYTES] = {0};
    const size_t n_reply = iso_osdp_peripheral_receive(device, bytes, n, now_ns, reply);
    if (n_reply > 0) {
        struct iso_osdp_packet packet;
        fuzz_check(iso_osdp_packet_parse(reply, n_reply, &packet) == 0 && packet.is_reply,
                   "a reply is a frame");
        (void)iso_osdp_peripheral_sent(device);
    }
    (void)!iso_osdp_peripheral_card(device, reply, 1 + n % ISO_OSDP_CARD_BITS);
}

/* Gives a frame with a right length and a right CRC, which the fuzzer would hardly find: control,
 * block, its data and code are the first four bytes. */
static void give_frame(struct iso_osdp_peripheral *device, const uint8_t *bytes, size_t n,
                       int64_t now_ns)
{
    uint8_t frame[ISO_OSDP_FRAME_BYTES];
    const struct iso_osdp_header header = {
        .address = bytes[0] & 0x80 ? ISO_OSDP_BROADCAST : 0,
        .sequence = bytes[0] & 3,
        .has_crc = bytes[0] & 4,
        .block = bytes[0] & 8 ? bytes[1] : 0,
        .block_data = bytes[0] & 16 ? bytes[2] : -1,
        .code = bytes[3],
    };
    size_t length = iso_osdp_packet_begin(&header, bytes + 4, n - 4, frame);
    if (header.block >= 0x15 && header.block <= 0x18) {
        memset(frame + length, bytes[2], ISO_OSDP_MAC_BYTES);
        length += ISO_OSDP_MAC_BYTES;
    }
    give(device, frame, iso_osdp_packet_end(frame, length), now_ns);
}

static void feed(struct iso_osdp_peripheral *device, const uint8_t *bytes, size_t size)
{
    int64_t now_ns = 0;
    while (size > 0) {
        /* The first byte of a piece is its length, its kind, and the time before it. */
        const size_t n = (bytes[0] & 63) % size;
        now_ns += INT64_C(20000000) * (bytes[0] % 7);
        if (bytes[0] & 128 || n < 4) {
            give(device, bytes + 1, n, now_ns);
        } else {
            give_frame(device, bytes + 1, n, now_ns);
        }
        bytes += 1 + n;
        size -= 1 + n;
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct iso_osdp_peripheral *device;
    uint8_t *bytes = fuzz_copy(data, size);
    const struct iso_osdp_setup setup = {
        .saved = {.address = 0, .baud = 9600, .has_key = true, .key = {1, 2, 3}},
        .plain = size % 2,
        .inputs = ISO_OSDP_INPUTS,
        .random = make_random,
        .store = store,
    };
    if (iso_osdp_peripheral_new(&setup, &device) == 0) {
        if (size % 3 == 0) {
            iso_osdp_peripheral_install(device, 0);
        }
        feed(device, bytes, size);
        iso_osdp_peripheral_free(device);
    }
    free(bytes);
    return 0;
}
