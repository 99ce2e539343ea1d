/* Cards and keys from the pulses of a Wiegand reader. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "drivers/door/wiegand.h"
#include "drivers/reader/wiegand_frame.h"

enum { INTERVAL_NS = 2000000 };

/* Sends the lowest bits of a code, the most significant first, and waits for the end. The two lines
 * are read one after the other: first all pulses of D0, then all of D1. */
static struct iso_reader_event send(uint64_t code, int bits, bool in_order)
{
    static int64_t now_ns = 1000;
    struct iso_wiegand_frame frame = {.n = 0};
    const int64_t begin_ns = now_ns;
    for (int line = 0; line < 2; line++) {
        for (int i = 0; i < bits; i++) {
            const bool one = code >> (bits - 1 - i) & 1;
            if (in_order ? line == 0 : one == (line == 1)) {
                iso_wiegand_frame_pulse(&frame, one, begin_ns + i * (int64_t)INTERVAL_NS);
            }
        }
    }
    const int64_t last_ns = begin_ns + (bits - 1) * (int64_t)INTERVAL_NS;
    now_ns = last_ns + ISO_WIEGAND_GAP_NS;
    assert_int_equal(iso_wiegand_frame_due_ns(&frame), now_ns);
    assert_int_equal(iso_wiegand_frame_time(&frame, now_ns - 1).kind, ISO_READER_NOTHING);
    const struct iso_reader_event event = iso_wiegand_frame_time(&frame, now_ns);
    assert_int_equal(iso_wiegand_frame_due_ns(&frame), INT64_MAX);
    assert_int_equal(iso_wiegand_frame_time(&frame, now_ns).kind, ISO_READER_NOTHING);
    return event;
}

static void every_card_comes_back(void **state)
{
    (void)state;
    srandom(3);
    for (int round = 0; round < 10000; round++) {
        const int bits = round % 2 ? 26 : 34;
        const struct iso_wiegand_card card = {(unsigned)(random() % (bits == 26 ? 256 : 65536)),
                                              (unsigned)(random() % 65536)};
        uint64_t code = 0;
        assert_int_equal(iso_wiegand_encode(bits, &card, &code), 0);
        const struct iso_reader_event event = send(code, bits, round % 3 == 0);
        assert_int_equal(event.kind, ISO_READER_CARD);
        assert_int_equal(event.bits, bits);
        assert_int_equal(event.code, code);
        /* One wrong bit is never a card: each bit is in one of the parities. */
        const uint64_t flipped = code ^ UINT64_C(1) << (random() % bits);
        assert_int_equal(send(flipped, bits, false).kind, ISO_READER_DAMAGED);
    }
}

static void keys_have_four_or_eight_bits(void **state)
{
    static const char keys[] = "0123456789*#";
    (void)state;
    for (unsigned i = 0; i < 16; i++) {
        const struct iso_reader_event four = send(i, 4, false);
        const struct iso_reader_event eight = send((~i & 15) << 4 | i, 8, false);
        if (i < sizeof keys - 1) {
            assert_int_equal(four.kind, ISO_READER_KEY);
            assert_int_equal(four.key, keys[i]);
            assert_int_equal(eight.kind, ISO_READER_KEY);
            assert_int_equal(eight.key, keys[i]);
        } else {
            assert_int_equal(four.kind, ISO_READER_DAMAGED);
            assert_int_equal(eight.kind, ISO_READER_DAMAGED);
        }
        assert_int_equal(send((i & 15) << 4 | i, 8, false).kind, ISO_READER_DAMAGED);
    }
}

static void other_lengths_are_codes(void **state)
{
    (void)state;
    for (int bits = 1; bits <= 80; bits++) {
        const uint64_t code = bits < 64
                                  ? (UINT64_C(0xa5a5a5a5a5a5a5a5) & ((UINT64_C(1) << bits) - 1))
                                  : UINT64_C(0xa5a5a5a5a5a5a5a5);
        if (bits == 4 || bits == 8 || bits == 26 || bits == 34) {
            continue;
        }
        if (bits > 64) {
            struct iso_wiegand_frame frame = {.n = 0};
            for (int i = 0; i < bits; i++) {
                iso_wiegand_frame_pulse(&frame, true, i);
            }
            assert_int_equal(iso_wiegand_frame_time(&frame, INT64_C(1000000000)).kind,
                             ISO_READER_DAMAGED);
            continue;
        }
        const struct iso_reader_event event = send(code, bits, false);
        const bool damaged = bits < 26 || bits == 33;
        assert_int_equal(event.kind, damaged ? ISO_READER_DAMAGED : ISO_READER_CARD);
        assert_true(damaged || (event.bits == bits && event.code == code));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_card_comes_back),
        cmocka_unit_test(keys_have_four_or_eight_bits),
        cmocka_unit_test(other_lengths_are_codes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
