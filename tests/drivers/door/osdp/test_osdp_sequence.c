/* Sequence numbers, repeated frames, a panel that falls silent or starts anew. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "tests/drivers/door/osdp/osdp_bench.h"

static void queue_card(struct bench *bench, uint8_t number)
{
    const uint8_t card[4] = {0x12, 0x34, 0x56, number};
    assert_int_equal(iso_osdp_peripheral_card(bench->device, card, 32), 0);
}

static int poll(struct bench *bench, struct panel_reply *reply)
{
    return bench_ask(bench, 0x60, NULL, 0, reply);
}

static void test_repeated_frame_is_done_once(void **state)
{
    (void)state;
    for (int secure = 0; secure < 2; secure++) {
        struct bench bench;
        struct panel_reply reply;
        uint8_t first[ISO_OSDP_FRAME_BYTES], again[ISO_OSDP_FRAME_BYTES];
        const uint8_t text[] = {0, 1, 0, 2, 1, 1, 'x'}, key[18] = {1, 16, 7};
        bench_init(&bench, true, !secure);
        assert_true(!secure || bench_secure(&bench, bench_key));
        assert_int_equal(bench_ask(&bench, 0x61, "", 1, &reply), 0x45);
        assert_int_equal(bench_ask(&bench, 0x6B, text, sizeof text, &reply), 0x40);
        if (secure) {
            panel_make(&bench.panel, 0x75, key, sizeof key);
            const size_t n = iso_osdp_peripheral_receive(bench.device, bench.panel.frame,
                                                         bench.panel.n_frame, bench.now_ns, first);
            for (int i = 0; i < 5; i++) {
                assert_int_equal(iso_osdp_peripheral_receive(bench.device, bench.panel.frame,
                                                             bench.panel.n_frame, bench.now_ns,
                                                             again),
                                 n);
                assert_memory_equal(first, again, n);
            }
            assert_int_equal(bench.stores, 1);
            assert_int_equal(bench_status(&bench).keys_set, 1);
            panel_read(&bench.panel, again, n, &reply);
            assert_int_equal(reply.code, 0x40);
        }
        queue_card(&bench, 1);
        queue_card(&bench, 2);
        assert_int_equal(poll(&bench, &reply), 0x50);
        assert_int_equal(reply.data[7], 1);
        if (!secure) { /* the panel of the tests reads a MAC only once */
            for (int i = 0; i < 5; i++) {
                bench_exchange(&bench, &reply);
                assert_int_equal(reply.code, 0x50);
                assert_int_equal(reply.data[7], 1);
            }
        }
        assert_int_equal(bench_status(&bench).waiting, 2);
        assert_int_equal(poll(&bench, &reply), 0x50);
        assert_int_equal(reply.data[7], 2);
        assert_int_equal(bench_status(&bench).waiting, 1);
        assert_int_equal(poll(&bench, &reply), 0x40);
        assert_int_equal(bench_status(&bench).delivered, 2);
        assert_int_equal(bench_status(&bench).repeated, 5);
        bench_done(&bench);
    }
}

static void test_numbers_go_from_3_to_1(void **state)
{
    (void)state;
    struct bench bench;
    struct panel_reply reply;
    static const int numbers[] = {0, 1, 2, 3, 1, 2, 3, 1};
    bench_init(&bench, false, true);
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        assert_int_equal(poll(&bench, &reply), 0x40);
        assert_int_equal(bench.panel.sequence, numbers[i]);
    }
    bench_done(&bench);
}

static void test_wrong_numbers_are_refused(void **state)
{
    (void)state;
    struct bench bench;
    struct panel_reply reply;
    bench_init(&bench, false, true);
    /* A device that has just been switched on waits for 0. */
    for (int before = 0; before < 3; before++) {
        bench.panel.sequence = before;
        assert_int_equal(poll(&bench, &reply), 0x41);
        assert_int_equal(reply.data[0], 4);
    }
    bench.panel.sequence = -1;
    assert_int_equal(poll(&bench, &reply), 0x40);
    queue_card(&bench, 1);
    assert_int_equal(poll(&bench, &reply), 0x50); /* number 1 */
    bench.panel.sequence = 2;
    assert_int_equal(poll(&bench, &reply), 0x41); /* number 3 */
    assert_int_equal(reply.data[0], 4);
    /* The same number with another command is no repeated frame. */
    bench.panel.sequence = 0;
    assert_int_equal(bench_ask(&bench, 0x64, NULL, 0, &reply), 0x41);
    assert_int_equal(reply.data[0], 4);
    /* Nothing of this said that the panel has the card. */
    assert_int_equal(bench_status(&bench).waiting, 1);
    assert_int_equal(poll(&bench, &reply), 0x40); /* number 2 */
    assert_int_equal(bench_status(&bench).delivered, 1);
    bench_done(&bench);
}

static void test_new_start_drops_the_card_in_between(void **state)
{
    (void)state;
    struct bench bench;
    struct panel_reply reply;
    bench_init(&bench, false, true);
    assert_int_equal(poll(&bench, &reply), 0x40);
    queue_card(&bench, 1);
    queue_card(&bench, 2);
    assert_int_equal(poll(&bench, &reply), 0x50);
    bench.panel.sequence = -1;
    assert_int_equal(poll(&bench, &reply), 0x50); /* number 0 */
    assert_int_equal(reply.data[7], 2);
    assert_int_equal(poll(&bench, &reply), 0x40);
    assert_int_equal(bench_status(&bench).delivered, 1);
    assert_int_equal(bench_status(&bench).undelivered, 1);
    bench_done(&bench);
}

/* The first frame of a new start looks like that of the last one. It is repeated if it comes soon,
 * and a new start otherwise. */
static void test_repeated_first_frame(void **state)
{
    (void)state;
    struct bench bench;
    struct panel_reply reply;
    bench_init(&bench, false, true);
    assert_int_equal(poll(&bench, &reply), 0x40);
    queue_card(&bench, 1);
    queue_card(&bench, 2);
    bench.now_ns += ISO_OSDP_REPEAT_NS;
    bench.panel.sequence = -1;
    assert_int_equal(poll(&bench, &reply), 0x50);
    assert_int_equal(reply.data[7], 1);
    bench.now_ns += ISO_OSDP_REPEAT_NS - 1;
    bench.panel.sequence = -1;
    assert_int_equal(poll(&bench, &reply), 0x50);
    assert_int_equal(reply.data[7], 1);
    bench.now_ns += 1;
    bench.panel.sequence = -1;
    assert_int_equal(poll(&bench, &reply), 0x50);
    assert_int_equal(reply.data[7], 2);
    assert_int_equal(bench_status(&bench).undelivered, 1);
    bench_done(&bench);
}

static void test_new_start_repeats_a_state(void **state)
{
    (void)state;
    struct bench bench;
    struct panel_reply reply;
    bench_init(&bench, false, true);
    assert_int_equal(poll(&bench, &reply), 0x40);
    iso_osdp_peripheral_set_tamper(bench.device, true);
    assert_int_equal(poll(&bench, &reply), 0x48);
    bench.panel.sequence = -1;
    assert_int_equal(bench_ask(&bench, 0x61, "", 1, &reply), 0x45);
    assert_int_equal(poll(&bench, &reply), 0x48);
    assert_int_equal(reply.data[0], 1);
    assert_int_equal(poll(&bench, &reply), 0x40);
    bench_done(&bench);
}

static void test_silence(void **state)
{
    (void)state;
    struct bench bench;
    struct panel_reply reply;
    const uint8_t blue[14] = {0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 4, 0};
    bench_init(&bench, true, false);
    const uint8_t card[4] = {1, 2, 3, 4};
    /* Nobody is there yet. */
    assert_int_equal(iso_osdp_peripheral_card(bench.device, card, 32), -ENOTCONN);
    assert_int_equal(iso_osdp_peripheral_digits(bench.device, "12"), -ENOTCONN);
    assert_true(bench_secure(&bench, bench_key));
    assert_int_equal(bench_ask(&bench, 0x69, blue, 14, &reply), 0x40);
    queue_card(&bench, 1);
    queue_card(&bench, 2);
    assert_int_equal(poll(&bench, &reply), 0x50);
    struct panel last = bench.panel;
    bench.now_ns += ISO_OSDP_SILENCE_NS - 1;
    iso_osdp_peripheral_tick(bench.device, bench.now_ns);
    assert_true(bench_status(&bench).online);
    assert_true(bench_status(&bench).secure);
    assert_int_equal(bench_status(&bench).shown.lamp, ISO_OSDP_BLUE);
    /* Somebody repeats the last frame; this is no sign of the panel. */
    uint8_t answer[ISO_OSDP_FRAME_BYTES];
    assert_true(iso_osdp_peripheral_receive(bench.device, last.frame, last.n_frame, bench.now_ns,
                                            answer) > 0);
    bench.now_ns++;
    iso_osdp_peripheral_tick(bench.device, bench.now_ns);
    assert_false(bench_status(&bench).online);
    assert_false(bench_status(&bench).secure);
    assert_int_equal(bench_status(&bench).undelivered, 2);
    assert_int_equal(bench_status(&bench).waiting, 0);
    assert_int_equal(bench_status(&bench).shown.lamp, ISO_OSDP_BLACK);
    assert_int_equal(iso_osdp_peripheral_card(bench.device, card, 32), -ENOTCONN);
    /* Its frames are worth nothing any more; a new handshake is. */
    assert_int_equal(poll(&bench, &reply), 0x41);
    assert_int_equal(reply.data[0], 4);
    assert_true(bench_secure(&bench, bench_key));
    assert_int_equal(poll(&bench, &reply), 0x40);
    assert_true(bench_status(&bench).online);
    bench_done(&bench);
}

static void test_cards_need_the_own_key(void **state)
{
    (void)state;
    struct bench bench;
    struct panel_reply reply;
    const uint8_t card[4] = {1, 2, 3, 4};
    bench_init(&bench, false, false);
    iso_osdp_peripheral_install(bench.device, bench.now_ns);
    assert_int_equal(bench_ask(&bench, 0x61, "", 1, &reply), 0x45);
    assert_true(bench_status(&bench).online);
    assert_int_equal(iso_osdp_peripheral_card(bench.device, card, 32), -ENOTCONN);
    assert_true(bench_secure(&bench, bench_default_key));
    assert_int_equal(iso_osdp_peripheral_card(bench.device, card, 32), -ENOTCONN);
    bench_done(&bench);
    /* A card that waits does not leave by a channel with the default key. */
    bench_init(&bench, true, false);
    assert_true(bench_secure(&bench, bench_key));
    assert_int_equal(iso_osdp_peripheral_card(bench.device, card, 32), 0);
    iso_osdp_peripheral_install(bench.device, bench.now_ns);
    assert_true(bench_secure(&bench, bench_default_key));
    assert_int_equal(poll(&bench, &reply), 0x40);
    assert_true(bench_secure(&bench, bench_key));
    assert_int_equal(poll(&bench, &reply), 0x50);
    bench_done(&bench);
}

static void test_bits_and_digits(void **state)
{
    (void)state;
    struct bench bench;
    struct panel_reply reply;
    uint8_t bits[17];
    memset(bits, 0xFF, sizeof bits);
    bench_init(&bench, false, true);
    assert_int_equal(poll(&bench, &reply), 0x40);
    assert_int_equal(iso_osdp_peripheral_card(bench.device, bits, 26), 0);
    assert_int_equal(iso_osdp_peripheral_card(bench.device, bits, 128), 0);
    assert_int_equal(iso_osdp_peripheral_card(bench.device, bits, 129), -EINVAL);
    assert_int_equal(iso_osdp_peripheral_card(bench.device, bits, 0), -EINVAL);
    assert_int_equal(iso_osdp_peripheral_digits(bench.device, "0*9#"), 0);
    assert_int_equal(iso_osdp_peripheral_digits(bench.device, ""), -EINVAL);
    assert_int_equal(iso_osdp_peripheral_digits(bench.device, "12a"), -EINVAL);
    assert_int_equal(iso_osdp_peripheral_digits(bench.device, "01234567890123456"), -EINVAL);
    assert_int_equal(poll(&bench, &reply), 0x50);
    assert_int_equal(reply.n, 8);
    assert_memory_equal(reply.data, "\0\1\x1A\0\xFF\xFF\xFF\xC0", 8);
    assert_int_equal(poll(&bench, &reply), 0x50);
    assert_int_equal(reply.n, 20);
    assert_memory_equal(reply.data, "\0\1\x80\0", 4);
    assert_memory_equal(reply.data + 4, bits, 16);
    assert_int_equal(poll(&bench, &reply), 0x53);
    assert_int_equal(reply.n, 6);
    assert_memory_equal(reply.data,
                        "\0\4"
                        "0\x7F"
                        "9\x0D",
                        6);
    for (int i = 0; i < ISO_OSDP_EVENTS; i++) {
        assert_int_equal(iso_osdp_peripheral_card(bench.device, bits, 34), i < 31 ? 0 : -ENOBUFS);
    }
    assert_int_equal(poll(&bench, &reply), 0x50); /* the digits have arrived: one place is free */
    assert_int_equal(iso_osdp_peripheral_card(bench.device, bits, 34), 0);
    assert_int_equal(iso_osdp_peripheral_card(bench.device, bits, 34), -ENOBUFS);
    bench_done(&bench);
}

/* Frames of others on the same wire, replies, and frames in pieces. */
static void test_other_frames_on_the_wire(void **state)
{
    (void)state;
    struct bench bench;
    struct panel_reply reply;
    uint8_t answer[ISO_OSDP_FRAME_BYTES];
    bench_init(&bench, false, true);
    struct panel other = {.address = 6, .sequence = -1};
    panel_make(&other, 0x60, NULL, 0);
    assert_int_equal(
        iso_osdp_peripheral_receive(bench.device, other.frame, other.n_frame, bench.now_ns, answer),
        0);
    other.address = 0x85; /* what this device itself sends */
    panel_make(&other, 0x60, NULL, 0);
    assert_int_equal(
        iso_osdp_peripheral_receive(bench.device, other.frame, other.n_frame, bench.now_ns, answer),
        0);
    assert_false(bench_status(&bench).online);
    /* One byte after the other. */
    panel_make(&bench.panel, 0x60, NULL, 0);
    for (size_t i = 0; i < bench.panel.n_frame; i++) {
        bench.now_ns += ISO_OSDP_GAP_NS - 1;
        const size_t n = iso_osdp_peripheral_receive(bench.device, bench.panel.frame + i, 1,
                                                     bench.now_ns, answer);
        assert_int_equal(n > 0, i == bench.panel.n_frame - 1);
    }
    /* A frame that was cut off does not hold up the next one. */
    panel_make(&bench.panel, 0x61, "", 1);
    assert_int_equal(
        iso_osdp_peripheral_receive(bench.device, bench.panel.frame, 5, bench.now_ns, answer), 0);
    bench.now_ns += ISO_OSDP_GAP_NS;
    bench_exchange(&bench, &reply);
    assert_int_equal(reply.code, 0x45);
    bench_done(&bench);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_repeated_frame_is_done_once),
        cmocka_unit_test(test_numbers_go_from_3_to_1),
        cmocka_unit_test(test_wrong_numbers_are_refused),
        cmocka_unit_test(test_new_start_drops_the_card_in_between),
        cmocka_unit_test(test_repeated_first_frame),
        cmocka_unit_test(test_new_start_repeats_a_state),
        cmocka_unit_test(test_silence),
        cmocka_unit_test(test_cards_need_the_own_key),
        cmocka_unit_test(test_bits_and_digits),
        cmocka_unit_test(test_other_frames_on_the_wire),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
