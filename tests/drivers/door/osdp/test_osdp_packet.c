/* Frames of OSDP: known frames, damage, and frames in a stream. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "drivers/door/osdp/osdp_codes.h"
#include "drivers/door/osdp/osdp_packet.h"

/* Published frames: the first two from Annex E of SIA OSDP 2.2; a POLL with a CRC and with a check
 * sum, an ACK, a BUZ and a PDID that were taken off wires (tests of OSDP.Net). */
static const uint8_t comset[] = {0x53, 0x7F, 0x0D, 0x00, 0x04, 0x6E, 0x00,
                                 0x80, 0x25, 0x00, 0x00, 0x6E, 0x38};
static const uint8_t id[] = {0x53, 0x00, 0x09, 0x00, 0x04, 0x61, 0x00, 0xC0, 0x66};
static const uint8_t comset_sum[] = {0x53, 0x7F, 0x0C, 0x00, 0x00, 0x6E,
                                     0x00, 0x80, 0x25, 0x00, 0x00, 0x0F};
static const uint8_t id_sum[] = {0x53, 0x00, 0x08, 0x00, 0x00, 0x61, 0x00, 0x44};
static const uint8_t poll[] = {0x53, 0x00, 0x08, 0x00, 0x04, 0x60, 0xEB, 0xAA};
static const uint8_t poll_sum[] = {0x53, 0x00, 0x07, 0x00, 0x00, 0x60, 0x46};
static const uint8_t ack[] = {0x53, 0x80, 0x08, 0x00, 0x05, 0x40, 0x68, 0x9F};
static const uint8_t buz[] = {0x53, 0x00, 0x0D, 0x00, 0x06, 0x6A, 0x00,
                              0x02, 0x02, 0x02, 0x01, 0x59, 0x92};
static const uint8_t pdid[] = {0x53, 0x80, 0x14, 0x00, 0x06, 0x45, 0x00, 0x0E, 0xE3, 0x10,
                               0x10, 0x00, 0x00, 0x74, 0x97, 0x23, 0x06, 0x06, 0x1B, 0x88};

static const struct {
    const uint8_t *frame;
    size_t n;
    struct iso_osdp_header header;
    size_t n_data;
} known[] = {
    {comset, sizeof comset, {0x7F, 0, true, 0, -1, 0x6E}, 5},
    {id, sizeof id, {0x00, 0, true, 0, -1, 0x61}, 1},
    {comset_sum, sizeof comset_sum, {0x7F, 0, false, 0, -1, 0x6E}, 5},
    {id_sum, sizeof id_sum, {0x00, 0, false, 0, -1, 0x61}, 1},
    {poll, sizeof poll, {0x00, 0, true, 0, -1, 0x60}, 0},
    {poll_sum, sizeof poll_sum, {0x00, 0, false, 0, -1, 0x60}, 0},
    {ack, sizeof ack, {0x80, 1, true, 0, -1, 0x40}, 0},
    {buz, sizeof buz, {0x00, 2, true, 0, -1, 0x6A}, 5},
    {pdid, sizeof pdid, {0x80, 2, true, 0, -1, 0x45}, 12},
};

static void test_known_frames_are_read(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        struct iso_osdp_packet packet;
        assert_int_equal(iso_osdp_packet_parse(known[i].frame, known[i].n, &packet), 0);
        assert_int_equal(packet.address, known[i].header.address & 0x7F);
        assert_int_equal(packet.is_reply, known[i].header.address >> 7);
        assert_int_equal(packet.sequence, known[i].header.sequence);
        assert_int_equal(packet.has_crc, known[i].header.has_crc);
        assert_int_equal(packet.code, known[i].header.code);
        assert_int_equal(packet.n_data, known[i].n_data);
        assert_ptr_equal(packet.data, known[i].frame + 6);
        assert_null(packet.mac);
    }
}

static void test_known_frames_are_made(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        uint8_t frame[ISO_OSDP_FRAME_BYTES];
        const size_t n = iso_osdp_packet_begin(&known[i].header, known[i].frame + 6,
                                               known[i].n_data, frame);
        assert_int_equal(iso_osdp_packet_end(frame, n), known[i].n);
        assert_memory_equal(frame, known[i].frame, known[i].n);
    }
}

static void test_every_changed_bit_is_noticed(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        for (size_t bit = 0; bit < 8 * known[i].n; bit++) {
            uint8_t frame[32];
            struct iso_osdp_packet packet;
            memcpy(frame, known[i].frame, known[i].n);
            frame[bit / 8] ^= (uint8_t)(1 << bit % 8);
            /* The bit that says whether a CRC or a check sum follows is the only one for which a
             * check of one byte may be right by chance; it is not in these frames. */
            assert_int_equal(iso_osdp_packet_parse(frame, known[i].n, &packet), -EBADMSG);
        }
    }
}

static void test_blocks_and_macs_have_bounds(void **state)
{
    (void)state;
    static const uint8_t data[] = {1, 2, 3}, mac[] = {0xD1, 0xD2, 0xD3, 0xD4};
    struct iso_osdp_header header = {0x05, 1, true, ISO_OSDP_SCS_17, -1, 0x6B};
    uint8_t frame[ISO_OSDP_FRAME_BYTES];
    struct iso_osdp_packet packet;
    size_t n = iso_osdp_packet_begin(&header, data, sizeof data, frame);
    assert_int_equal(n, 5 + 2 + 1 + 3);
    memcpy(frame + n, mac, sizeof mac);
    n = iso_osdp_packet_end(frame, n + 4);
    assert_int_equal(iso_osdp_packet_parse(frame, n, &packet), 0);
    assert_int_equal(packet.block, ISO_OSDP_SCS_17);
    assert_int_equal(packet.n_block_data, 0);
    assert_int_equal(packet.n_data, 3);
    assert_int_equal(packet.n_signed, 11);
    assert_memory_equal(packet.mac, mac, sizeof mac);

    /* A block that reaches to the end of the frame or beyond it, or is shorter than its header. */
    static const uint8_t lengths[] = {0, 1, 10, 11, 200, 255};
    for (size_t i = 0; i < sizeof lengths; i++) {
        frame[5] = lengths[i];
        (void)iso_osdp_packet_end(frame, n - 2);
        assert_int_equal(iso_osdp_packet_parse(frame, n, &packet), -EBADMSG);
    }
    /* A frame that would be too long. */
    uint8_t much[ISO_OSDP_FRAME_BYTES] = {0};
    assert_int_equal(iso_osdp_packet_begin(&header, much, ISO_OSDP_FRAME_BYTES - 13, frame), 0);
    assert_int_not_equal(iso_osdp_packet_begin(&header, much, ISO_OSDP_FRAME_BYTES - 14, frame), 0);
}

/* ---- frames in a stream ---- */

/* Counts the frames that a receiver finds, and notes their codes. */
static size_t feed(struct iso_osdp_receiver *receiver, const uint8_t *bytes, size_t n,
                   uint8_t *codes)
{
    size_t found = 0;
    struct iso_osdp_packet packet;
    for (size_t i = 0; i < n; i++) {
        bool whole = iso_osdp_receiver_push(receiver, bytes[i], &packet);
        while (whole) {
            codes[found++] = packet.code;
            whole = iso_osdp_receiver_next(receiver, &packet);
        }
    }
    return found;
}

static void test_frames_are_found_after_noise(void **state)
{
    (void)state;
    static struct iso_osdp_receiver receiver;
    uint8_t stream[128], codes[8], *at = stream;
    memset(&receiver, 0, sizeof receiver);
    at = mempcpy(at, "\xFF\x00\x53\x53\xFF\xFF", 6); /* noise, and beginnings that are none */
    at = mempcpy(at, poll, sizeof poll);
    at = mempcpy(at, buz, sizeof buz - 3); /* cut off */
    at = mempcpy(at, id, sizeof id);
    at = mempcpy(at, "\x53\x05\xFF\xFF\x04", 5); /* a length that is not possible */
    at = mempcpy(at, ack, sizeof ack);
    assert_int_equal(feed(&receiver, stream, (size_t)(at - stream), codes), 3);
    assert_int_equal(codes[0], 0x60);
    assert_int_equal(codes[1], 0x61);
    assert_int_equal(codes[2], 0x40);
    assert_true(receiver.damaged >= 3);
}

static void test_good_frame_inside_a_long_wrong_one(void **state)
{
    (void)state;
    static struct iso_osdp_receiver receiver;
    uint8_t stream[256] = {0x53, 0x05, 0xFF, 0x00, 0x04}, codes[8];
    memset(&receiver, 0, sizeof receiver);
    memcpy(stream + 100, poll, sizeof poll);
    memcpy(stream + 120, comset, sizeof comset);
    assert_int_equal(feed(&receiver, stream, 254, codes), 0);
    assert_int_equal(feed(&receiver, stream + 254, 2, codes), 2);
    assert_int_equal(codes[0], 0x60);
    assert_int_equal(codes[1], 0x6E);
}

static void test_longest_frame(void **state)
{
    (void)state;
    static struct iso_osdp_receiver receiver;
    uint8_t frame[ISO_OSDP_FRAME_BYTES], data[ISO_OSDP_FRAME_BYTES], codes[8];
    memset(&receiver, 0, sizeof receiver);
    memset(data, 0x53, sizeof data);
    const struct iso_osdp_header header = {0x05, 1, true, 0, -1, 0x7C};
    size_t n = iso_osdp_packet_begin(&header, data, ISO_OSDP_FRAME_BYTES - 8, frame);
    n = iso_osdp_packet_end(frame, n);
    assert_int_equal(n, ISO_OSDP_FRAME_BYTES);
    for (int i = 0; i < 3; i++) {
        assert_int_equal(feed(&receiver, frame, n, codes), 1);
    }
    assert_int_equal(receiver.damaged, 0);
    frame[700] ^= 1;
    assert_int_equal(feed(&receiver, frame, n, codes), 0);
    iso_osdp_receiver_reset(&receiver);
    assert_int_equal(feed(&receiver, poll, sizeof poll, codes), 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_known_frames_are_read),
        cmocka_unit_test(test_known_frames_are_made),
        cmocka_unit_test(test_every_changed_bit_is_noticed),
        cmocka_unit_test(test_blocks_and_macs_have_bounds),
        cmocka_unit_test(test_frames_are_found_after_noise),
        cmocka_unit_test(test_good_frame_inside_a_long_wrong_one),
        cmocka_unit_test(test_longest_frame),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
