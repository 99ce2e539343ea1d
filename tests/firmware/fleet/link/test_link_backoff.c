/* The wait before another try: its limits, and that it is spread over the whole of them. */
#include "firmware/fleet/link/link_backoff.h"

#include <sodium.h>

#include "firmware/fleet/link/link_inner.h"
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

/* How many of 20,000 doors, which have all asked at the same moment, ask again in each tenth of a
 * minute. */
static void count_parts(bool had_reason, unsigned parts[10])
{
    for (int i = 0; i < 20000; i++) {
        uint64_t random = 0;
        randombytes_buf(&random, sizeof random);
        const uint64_t period = link_period_us(86400, had_reason, random);
        assert_in_range(period, 6000000, 60000000);
        parts[(period - 1) / 6000000]++;
    }
}

/* A change makes all doors ask at once; the next time they do not. A door that has asked because
 * the time was over keeps its own moment. */
static void doors_do_not_go_on_asking_together(void **state)
{
    unsigned after_change[10] = {0}, at_rest[10] = {0};

    (void)state;
    count_parts(true, after_change);
    count_parts(false, at_rest);
    for (int i = 1; i < 10; i++) {
        assert_in_range(after_change[i], 20000 / 9 * 8 / 10, 20000 / 9 * 12 / 10);
    }
    assert_in_range(at_rest[9], 19900, 20000);
}

static void the_period_follows_the_lease(void **state)
{
    (void)state;
    assert_int_equal(link_period_us(86400, false, 0), 60000000);
    assert_int_equal(link_period_us(80, false, 0), 10000000);
    assert_int_equal(link_period_us(0, false, 0), 5000000);
    assert_int_equal(link_period_us(4, false, 0), 1000000);
    for (uint64_t random = 0; random < 6000000; random += 9973) {
        assert_in_range(link_period_us(0, true, random), 1000000, 5000000);
        assert_int_equal(link_period_us(4, true, random), 1000000);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_limit_doubles_up_to_the_cap),
        cmocka_unit_test(the_limit_never_overflows),
        cmocka_unit_test(doors_do_not_come_back_together),
        cmocka_unit_test(doors_do_not_go_on_asking_together),
        cmocka_unit_test(the_period_follows_the_lease),
    };

    return sodium_init() < 0 ? 1 : cmocka_run_group_tests(tests, NULL, NULL);
}
