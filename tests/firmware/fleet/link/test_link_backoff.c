/* The wait before another try: its limits, and that it is spread over the whole of them. */
#include "firmware/fleet/link/link_backoff.h"

#include <sodium.h>

#include "tests/firmware/rigs/cmocka_headers.h"

static void the_limit_doubles_up_to_the_cap(void **state)
{
    struct link_backoff backoff = {.base_ms = 1000, .cap_ms = 60000};
    const uint64_t expected[] = {1000, 2000, 4000, 8000, 16000, 32000, 60000, 60000};

    (void)state;
    for (size_t i = 0; i < sizeof expected / sizeof *expected; i++) {
        assert_int_equal(link_backoff_limit_ms(&backoff), expected[i]);
        (void)link_backoff_next_us(&backoff, 0);
    }
    link_backoff_reset(&backoff);
    assert_int_equal(link_backoff_limit_ms(&backoff), 1000);
}

static void the_limit_never_overflows(void **state)
{
    struct link_backoff backoff = {
        .base_ms = UINT32_MAX, .cap_ms = UINT32_MAX, .failures = UINT32_MAX};

    (void)state;
    assert_int_equal(link_backoff_limit_ms(&backoff), UINT32_MAX);
    (void)link_backoff_next_us(&backoff, UINT64_MAX);
    assert_int_equal(backoff.failures, UINT32_MAX);
}

/* 20,000 doors lose the broker at the same moment. In each tenth of the limit about a tenth of them
 * comes back. */
static void doors_do_not_come_back_together(void **state)
{
    enum { DOORS = 20000, PARTS = 10 };
    unsigned parts[PARTS] = {0};

    (void)state;
    for (int i = 0; i < DOORS; i++) {
        struct link_backoff backoff = {.base_ms = 2000, .cap_ms = 64000, .failures = 2};
        uint64_t random = 0;
        randombytes_buf(&random, sizeof random);
        const uint64_t wait = link_backoff_next_us(&backoff, random);
        assert_true(wait <= 8000000);
        parts[wait * PARTS / 8000001]++;
    }
    for (int i = 0; i < PARTS; i++) {
        assert_in_range(parts[i], DOORS / PARTS * 8 / 10, DOORS / PARTS * 12 / 10);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_limit_doubles_up_to_the_cap),
        cmocka_unit_test(the_limit_never_overflows),
        cmocka_unit_test(doors_do_not_come_back_together),
    };

    return sodium_init() < 0 ? 1 : cmocka_run_group_tests(tests, NULL, NULL);
}
