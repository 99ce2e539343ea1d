/* How often the clients on the bus may call. */
#include <stdio.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/base/times.h"
#include "firmware/bus/call_rate.h"

static struct iso_call_rate rate;
static int64_t now_ns;

static int setup(void **state)
{
    (void)state;
    now_ns = 5 * ISO_NS_PER_S;
    iso_call_rate_init(&rate, now_ns);
    return 0;
}

/* Returns how many of n calls are answered. */
static int call(const char *client, int n)
{
    int answered = 0;
    for (int i = 0; i < n; i++) {
        answered += iso_call_rate_take(&rate, client, now_ns);
    }
    return answered;
}

static void a_burst_and_then_a_rate(void **state)
{
    (void)state;
    assert_int_equal(call(":1.7", 500), 40);
    now_ns += ISO_NS_PER_S;
    assert_int_equal(call(":1.7", 500), 20);
    now_ns += 3600 * ISO_NS_PER_S;
    assert_int_equal(call(":1.7", 500), 40);
}

static void clients_do_not_share(void **state)
{
    (void)state;
    assert_int_equal(call(":1.7", 500), 40);
    assert_int_equal(call(":1.8", 5), 5);
}

/* A client that takes a new name for each call gets no more than all new clients together. */
static void new_names_do_not_help(void **state)
{
    int answered = 0;
    (void)state;
    for (int s = 0; s < 10; s++) {
        for (int i = 0; i < 1000; i++) {
            char name[16];
            (void)snprintf(name, sizeof name, ":2.%d", 1000 * s + i);
            answered += call(name, 1);
        }
        now_ns += ISO_NS_PER_S;
    }
    assert_in_range(answered, 120, 40 + 10 * 10);
}

static void a_name_that_is_too_long_is_refused(void **state)
{
    char name[ISO_CALL_RATE_NAME_SIZE + 1];
    (void)state;
    memset(name, 'x', sizeof name);
    name[ISO_CALL_RATE_NAME_SIZE] = '\0';
    assert_int_equal(call(name, 1), 0);
    name[ISO_CALL_RATE_NAME_SIZE - 1] = '\0';
    assert_int_equal(call(name, 1), 1);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup(f, setup)
    const struct CMUnitTest tests[] = {
        TEST(a_burst_and_then_a_rate),
        TEST(clients_do_not_share),
        TEST(new_names_do_not_help),
        TEST(a_name_that_is_too_long_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
