/* The instructions of a processor for the smaller and the larger of four depths equal their plain
 * twins, to the bit. On a processor for which there are none, both are the twins. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "core/frame/depth_lanes.h"

static const float values[] = {0.0f,      -0.0f,  1.0f,    -1.0f,     0.5f,    499.99f,
                               500.0f,    1e-40f, -1e-40f, 1e6f,      3.4e38f, INFINITY,
                               -INFINITY, NAN,    -NAN,    1.17e-38f, -500.0f, 500.00003f};

enum { VALUES = sizeof values / sizeof values[0] };

static void every_pair_is_the_same(void **state)
{
    (void)state;
    for (int i = 0; i < VALUES * VALUES; i++) {
        iso_depths a, b;
        for (int lane = 0; lane < ISO_DEPTHS; lane++) { /* another pair in each lane */
            const int pair = (i + lane * 37) % (VALUES * VALUES);
            a[lane] = values[pair / VALUES];
            b[lane] = values[pair % VALUES];
        }
        const iso_depths low = ISO_DEPTHS_MIN(a, b), high = ISO_DEPTHS_MAX(a, b);
        const iso_depths plain_low = ISO_DEPTHS_MIN_PLAIN(a, b);
        const iso_depths plain_high = ISO_DEPTHS_MAX_PLAIN(a, b);
        assert_memory_equal(&low, &plain_low, sizeof low);
        assert_memory_equal(&high, &plain_high, sizeof high);
    }
}

static void they_are_the_smaller_and_the_larger(void **state)
{
    (void)state;
    const iso_depths a = {0.0f, 512.5f, 700.0f, 3.0f}, b = {480.0f, 512.25f, 700.0f, 0.0f};
    const iso_depths low = {0.0f, 512.25f, 700.0f, 0.0f}, high = {480.0f, 512.5f, 700.0f, 3.0f};
    const iso_depths found_low = ISO_DEPTHS_MIN(a, b), found_high = ISO_DEPTHS_MAX(a, b);
    assert_memory_equal(&found_low, &low, sizeof low);
    assert_memory_equal(&found_high, &high, sizeof high);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_pair_is_the_same),
        cmocka_unit_test(they_are_the_smaller_and_the_larger),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
