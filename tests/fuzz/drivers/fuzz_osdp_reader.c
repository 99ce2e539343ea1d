/* A reader of OSDP: replies of anyone on the wire, in pieces. The input leads the conversation: a
 * piece may be bytes as they are, or the code and data of a reply whose frame is right, so that the
 * content of replies is reached, too. With a key, the other side knows it. */
#include <stdlib.h>
#include <string.h>

#include "drivers/door/osdp/osdp_codes.h"
#include "drivers/door/osdp/osdp_secure.h"
#include "drivers/reader/osdp_reader.h"
#include "tests/fuzz/fuzz.h"

static const uint8_t key[ISO_OSDP_KEY_BYTES] = {1, 2, 3};

/* The other side. */
struct peer {
    struct iso_osdp_secure secure;
    uint8_t command[ISO_OSDP_FRAME_BYTES]; /* the last one */
    size_t n_command;
};

static int make_random(void *context, void *bytes, size_t n)
{
    (void)context;
    memset(bytes, 0x5A, n);
    return 0;
}

/* Answers the steps of the handshake. Returns the number of bytes of the reply, or 0. */
static size_t shake_hands(struct peer *peer, struct iso_osdp_header *header,
                          const struct iso_osdp_packet *command, uint8_t *frame)
{
    uint8_t data[8 + ISO_OSDP_RANDOM_BYTES + ISO_OSDP_KEY_BYTES] = {0};
    size_t n = sizeof data;
    header->block_data = 1;
    if (command->code == ISO_OSDP_CHLNG) {
        header->code = ISO_OSDP_CCRYPT;
        header->block = ISO_OSDP_SCS_12;
        iso_osdp_secure_challenge(&peer->secure, key, command->data, data + 8, data + 16);
    } else if (command->code == ISO_OSDP_SCRYPT &&
               iso_osdp_secure_prove(&peer->secure, command->data, data) == 0) {
        header->code = ISO_OSDP_RMAC_I;
        header->block = ISO_OSDP_SCS_14;
        n = ISO_OSDP_KEY_BYTES;
    } else {
        return 0;
    }
    return iso_osdp_packet_end(frame, iso_osdp_packet_begin(header, data, n, frame));
}

/* Makes a right frame of a reply with this code and data. */
static size_t make_reply(struct peer *peer, const uint8_t *bytes, size_t n, uint8_t *frame)
{
    struct iso_osdp_packet command;
    uint8_t ignored[ISO_OSDP_FRAME_BYTES];
    size_t n_ignored;
    if (iso_osdp_packet_parse(peer->command, peer->n_command, &command)) {
        return 0;
    }
    struct iso_osdp_header header = {.address = 5 | ISO_OSDP_REPLY_BIT,
                                     .sequence = command.sequence,
                                     .has_crc = true,
                                     .code = bytes[0]};
    const size_t n_hands = n % 4 ? shake_hands(peer, &header, &command, frame) : 0;
    if (n_hands > 0) {
        return n_hands;
    }
    const size_t n_data = n - 1 < ISO_OSDP_SEALED_BYTES ? n - 1 : ISO_OSDP_SEALED_BYTES;
    if (command.mac && iso_osdp_secure_open(&peer->secure, &command, ignored, &n_ignored) == 0) {
        return iso_osdp_secure_frame(&peer->secure, &header, bytes + 1, n_data, frame);
    }
    header.block = ISO_OSDP_SCS_NONE;
    return iso_osdp_packet_end(frame, iso_osdp_packet_begin(&header, bytes + 1, n_data, frame));
}

static void check_events(struct iso_osdp_reader *reader, bool has_key)
{
    struct iso_reader_event event;
    struct iso_osdp_reader_status status;
    iso_osdp_reader_status(reader, &status);
    fuzz_check(!has_key || !status.online || status.secure, "with a key, online is secure");
    while (iso_osdp_reader_take(reader, &event)) {
        fuzz_check(event.kind == ISO_READER_DAMAGED ||
                       (event.kind == ISO_READER_CARD && event.bits >= 5 && event.bits <= 64 &&
                        (event.bits == 64 || event.code >> event.bits == 0)) ||
                       (event.kind == ISO_READER_KEY && event.key != '\0' &&
                        strchr("0123456789*#", event.key)),
                   "an event is a card, a key or damaged");
    }
}

static void feed(struct iso_osdp_reader *reader, struct peer *peer, bool has_key,
                 const uint8_t *bytes, size_t size)
{
    uint8_t frame[ISO_OSDP_FRAME_BYTES] = {0};
    int64_t now_ns = 0;
    while (size > 1) {
        /* The first byte of a piece is its length and its kind. */
        const size_t n = 1 + (bytes[0] & 31) % (size - 1);
        now_ns = bytes[0] & 64 ? now_ns + 1000000 : iso_osdp_reader_due_ns(reader);
        const size_t n_sent = iso_osdp_reader_send(reader, now_ns, frame);
        if (n_sent > 0) {
            memcpy(peer->command, frame, n_sent);
            peer->n_command = n_sent;
        }
        if (bytes[0] & 128) {
            const size_t n_reply = make_reply(peer, bytes + 1, n, frame);
            iso_osdp_reader_receive(reader, frame, n_reply, now_ns);
        } else {
            iso_osdp_reader_receive(reader, bytes + 1, n, now_ns);
        }
        if (bytes[0] & 32) {
            iso_osdp_reader_show(reader, n % 2);
        }
        check_events(reader, has_key);
        bytes += 1 + n;
        size -= 1 + n;
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct iso_osdp_reader *reader;
    struct peer peer = {.n_command = 0};
    uint8_t *bytes = fuzz_copy(data, size);
    struct iso_osdp_reader_setup setup = {
        .address = 5, .baud = 9600, .has_key = size % 2, .random = make_random};
    memcpy(setup.key, key, sizeof key);
    if (iso_osdp_reader_new(&setup, 0, &reader) == 0) {
        feed(reader, &peer, setup.has_key, bytes, size);
        iso_osdp_reader_free(reader);
    }
    free(bytes);
    return 0;
}
