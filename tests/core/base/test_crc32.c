/* The checksum of files, compared with its published check value and with its definition bit by
 * bit. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "core/base/crc32.h"

static uint32_t bit_by_bit(const uint8_t *p, size_t n)
{
    uint32_t crc = ~0u;
    for (size_t i = 0; i < n; i++) {
        crc ^= p[i];
        for (int bit = 0; bit < 8; bit++) {
            crc = crc & 1u ? crc >> 1 ^ 0xEDB88320u : crc >> 1;
        }
    }
    return ~crc;
}

static void it_is_that_of_ieee_802_3(void **state)
{
    (void)state;
    assert_int_equal(iso_crc32(0, "123456789", 9), 0xCBF43926u);
    assert_int_equal(iso_crc32(0, "", 0), 0);
}

static void every_length_and_cut_gives_the_same(void **state)
{
    (void)state;
    enum { BYTES = 67 };
    uint8_t bytes[BYTES];
    for (int i = 0; i < BYTES; i++) {
        bytes[i] = (uint8_t)(i * 73 + i * i / 3);
    }
    for (size_t from = 0; from < 4; from++) { /* for every alignment */
        for (size_t n = 0; n <= BYTES - from; n++) {
            const uint32_t wanted = bit_by_bit(&bytes[from], n);
            assert_int_equal(iso_crc32(0, &bytes[from], n), wanted);
            for (size_t cut = 0; cut <= n; cut++) {
                const uint32_t first = iso_crc32(0, &bytes[from], cut);
                assert_int_equal(iso_crc32(first, &bytes[from + cut], n - cut), wanted);
            }
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_is_that_of_ieee_802_3),
        cmocka_unit_test(every_length_and_cut_gives_the_same),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
