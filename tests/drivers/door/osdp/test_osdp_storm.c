/* A million frames: random bytes, changed frames, and well-formed frames with random contents,
 * whose CRC is right. The device must stay within its bounds (run this under the sanitizers), must
 * answer with well-formed frames only, must never store a key, and must work afterwards. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "tests/drivers/door/osdp/osdp_bench.h"

enum { FRAMES = 1000000 };

static uint64_t dice = 88172645463325252;

static uint32_t throw_dice(uint32_t sides)
{
    dice ^= dice << 13;
    dice ^= dice >> 7;
    dice ^= dice << 17;
    return (uint32_t)(dice >> 16) % sides;
}

static size_t make_noise(uint8_t *bytes)
{
    const size_t n = throw_dice(24);
    for (size_t i = 0; i < n; i++) {
        bytes[i] = throw_dice(4) ? (uint8_t)throw_dice(256) : 0x53;
    }
    return n;
}

/* A frame whose length and CRC are right and whose other bytes are anything. */
static size_t make_frame(uint8_t *bytes)
{
    static const uint8_t codes[] = {0x60, 0x61, 0x62, 0x64, 0x65, 0x66, 0x67, 0x68,
                                    0x69, 0x6A, 0x6B, 0x6E, 0x75, 0x76, 0x77, 0x80};
    const size_t n = 6 + throw_dice(throw_dice(20) ? 40 : 1400);
    for (size_t i = 0; i < n; i++) {
        bytes[i] = (uint8_t)throw_dice(256);
    }
    bytes[0] = 0x53;
    bytes[1] = throw_dice(8) ? 5 : bytes[1];
    bytes[2] = (uint8_t)(n + 2);
    bytes[3] = (uint8_t)((n + 2) >> 8);
    bytes[4] = (uint8_t)(4 | throw_dice(4) | (throw_dice(3) ? 0 : 8));
    bytes[5] = codes[throw_dice(sizeof codes)];
    if ((bytes[4] & 8) && n > 9) {
        bytes[5] = (uint8_t)(2 + throw_dice(2));
        bytes[6] = (uint8_t)(0x10 + throw_dice(10));
        bytes[5 + bytes[5]] = codes[throw_dice(sizeof codes)];
    }
    panel_put_crc(bytes, n);
    return n + 2;
}

/* A right frame of the panel, one bit of which is changed in half of the cases. */
static size_t make_changed(struct bench *bench, uint8_t *bytes)
{
    struct panel panel = bench->panel;
    panel.sequence = (int)throw_dice(5) - 1;
    panel_make(&panel, (uint8_t)(0x60 + throw_dice(0x18)), "\0\1\0\1\1\2ok", throw_dice(9));
    memcpy(bytes, panel.frame, panel.n_frame);
    if (throw_dice(2)) {
        bytes[throw_dice((uint32_t)panel.n_frame)] ^= (uint8_t)(1 << throw_dice(8));
    }
    return panel.n_frame;
}

static void check_reply(const uint8_t *frame, size_t n)
{
    assert_true(n >= 8 || (n == 7 && !(frame[4] & 4)) || n == 8);
    assert_int_equal(frame[0], 0x53);
    assert_true(frame[1] & 0x80);
    assert_int_equal(frame[2] | frame[3] << 8, n);
    if (frame[4] & 4) {
        assert_int_equal(panel_crc(frame, n - 2), frame[n - 2] | frame[n - 1] << 8);
    }
}

static void storm(struct bench *bench, int frames)
{
    uint8_t bytes[PANEL_FRAME_BYTES + 8] = {0}, reply[ISO_OSDP_FRAME_BYTES];
    unsigned replies = 0;
    for (int i = 0; i < frames; i++) {
        const uint32_t kind = throw_dice(3);
        size_t n = kind == 0   ? make_noise(bytes)
                   : kind == 1 ? make_frame(bytes)
                               : make_changed(bench, bytes);
        bench->now_ns += throw_dice(50) ? 1000000 : 150000000;
        n = iso_osdp_peripheral_receive(bench->device, bytes, n, bench->now_ns, reply);
        if (n > 0) {
            check_reply(reply, n);
            replies++;
        }
    }
    print_message("%d frames, %u replies\n", frames, replies);
    assert_true(replies > (unsigned)frames / 100);
}

static void test_storm(void **state)
{
    (void)state;
    for (int plain = 0; plain < 2; plain++) {
        struct bench bench;
        struct panel_reply reply;
        bench_init(&bench, true, plain);
        if (!plain) {
            iso_osdp_peripheral_install(bench.device, bench.now_ns);
        }
        storm(&bench, FRAMES / 2);
        assert_false(bench_status(&bench).secure);
        assert_false(bench_status(&bench).default_key);
        assert_int_equal(bench_status(&bench).keys_set, 0);
        /* The panel comes back, at the address that the device has now. */
        (void)iso_osdp_peripheral_sent(bench.device);
        bench.now_ns += ISO_OSDP_SILENCE_NS;
        bench.panel.address = bench_status(&bench).address;
        assert_true(bench_secure(&bench, bench_key));
        assert_int_equal(bench_ask(&bench, 0x60, NULL, 0, &reply), 0x40);
        bench_done(&bench);
    }
}

/* The same while the channel is open: nothing that has no right MAC is done. Frames with the number
 * 0 are left out, because they close the channel by intention. */
static void test_storm_on_an_open_channel(void **state)
{
    (void)state;
    struct bench bench;
    struct panel_reply reply;
    uint8_t bytes[PANEL_FRAME_BYTES + 8] = {0}, answer[ISO_OSDP_FRAME_BYTES];
    bench_init(&bench, true, false);
    assert_true(bench_secure(&bench, bench_key));
    const struct iso_osdp_status before = bench_status(&bench);
    for (int i = 0; i < FRAMES / 10; i++) {
        const size_t n = make_frame(bytes);
        const bool restart = (bytes[4] & 3) == 0, challenge = memchr(bytes, 0x76, 9) != NULL;
        if (!restart && !challenge) {
            (void)iso_osdp_peripheral_receive(bench.device, bytes, n, bench.now_ns, answer);
        }
    }
    const struct iso_osdp_status after = bench_status(&bench);
    assert_true(after.secure);
    assert_int_equal(after.commands, before.commands);
    assert_true(after.refused > before.refused + 1000);
    assert_int_equal(bench_ask(&bench, 0x60, NULL, 0, &reply), 0x40);
    bench_done(&bench);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_storm),
        cmocka_unit_test(test_storm_on_an_open_channel),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
