/* Ten thousand cards over a bad line, in plain and in the secure channel: each arrives exactly
 * once, in order. The line loses, cuts off and damages frames in both directions. The panel repeats
 * a frame until it has a right reply. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "tests/drivers/door/osdp/osdp_bench.h"

enum { CARDS = 10000 };

static uint32_t dice = 20250917;

static uint32_t throw_dice(uint32_t sides)
{
    dice = dice * 1664525 + 1013904223;
    return (dice >> 8) % sides;
}

/* What arrives of a frame: all of it (2 of 3), nothing, a part, or all with a changed bit. */
static size_t pass(const uint8_t *in, size_t n, uint8_t *out)
{
    memcpy(out, in, n);
    switch (throw_dice(9)) {
    case 0:
        return 0;
    case 1:
        return throw_dice((uint32_t)n);
    case 2:
        out[throw_dice((uint32_t)n)] ^= (uint8_t)(1 << throw_dice(8));
        return n;
    default:
        return n;
    }
}

/* Repeats the panel's frame until the reply is right. The line is at rest for a while in between,
 * as after a panel's 200 ms. */
static void insist(struct bench *bench, struct panel_reply *reply)
{
    uint8_t frame[ISO_OSDP_FRAME_BYTES], answer[ISO_OSDP_FRAME_BYTES];
    do {
        size_t n = pass(bench->panel.frame, bench->panel.n_frame, frame);
        n = iso_osdp_peripheral_receive(bench->device, frame, n, bench->now_ns, answer);
        (void)iso_osdp_peripheral_sent(bench->device);
        n = n ? pass(answer, n, frame) : 0;
        panel_read(&bench->panel, frame, n, reply);
        bench->now_ns += BENCH_SECOND_NS / 5;
        /* The time of the repetitions must not count as silence in this test. */
        if (reply->code < 0) {
            bench->now_ns -= BENCH_SECOND_NS / 10;
        }
    } while (reply->code < 0);
}

static void deliver(struct bench *bench)
{
    struct panel_reply reply;
    unsigned queued = 0, arrived = 0;
    while (arrived < CARDS) {
        for (unsigned more = throw_dice(5); more > 0 && queued < CARDS; more--) {
            const uint8_t card[4] = {0xC0, 0xDE, (uint8_t)(queued >> 8), (uint8_t)queued};
            if (bench_status(bench).waiting < ISO_OSDP_EVENTS) {
                assert_int_equal(iso_osdp_peripheral_card(bench->device, card, 32), 0);
                queued++;
            }
        }
        const bool text = throw_dice(4) == 0;
        panel_make(&bench->panel, text ? 0x6B : 0x60, "\0\1\0\1\1\2ok", text ? 8 : 0);
        insist(bench, &reply);
        if (reply.code == 0x50) {
            assert_int_equal(reply.n, 8);
            assert_memory_equal(reply.data, "\0\1\x20\0\xC0\xDE", 6);
            assert_int_equal(reply.data[6] << 8 | reply.data[7], arrived);
            arrived++;
        } else {
            assert_int_equal(reply.code, 0x40);
        }
    }
    panel_make(&bench->panel, 0x60, NULL, 0);
    insist(bench, &reply);
    assert_int_equal(reply.code, 0x40);
    const struct iso_osdp_status status = bench_status(bench);
    assert_int_equal(status.delivered, CARDS);
    assert_int_equal(status.undelivered, 0);
    assert_int_equal(status.waiting, 0);
    assert_true(status.repeated > CARDS / 10); /* the line was a bad one */
    print_message("%u cards, %u repeated frames, %u damaged ones\n", arrived,
                  (unsigned)status.repeated, (unsigned)status.damaged);
}

static void test_plain(void **state)
{
    (void)state;
    struct bench bench;
    struct panel_reply reply;
    bench_init(&bench, false, true);
    assert_int_equal(bench_ask(&bench, 0x60, NULL, 0, &reply), 0x40);
    deliver(&bench);
    bench_done(&bench);
}

static void test_secure(void **state)
{
    (void)state;
    struct bench bench;
    bench_init(&bench, true, false);
    assert_true(bench_secure(&bench, bench_key));
    deliver(&bench);
    assert_true(bench_status(&bench).secure);
    bench_done(&bench);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_plain),
        cmocka_unit_test(test_secure),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
