/* Bouncing switches, judged by the times of their edges. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "drivers/door/debounce.h"

static struct iso_debounce debounce;

static int setup(void **state)
{
    (void)state;
    iso_debounce_init(&debounce, 20, false, 1000);
    return 0;
}

static void a_level_counts_when_it_has_lasted(void **state)
{
    (void)state;
    iso_debounce_edge(&debounce, true, 1100);
    assert_int_equal(iso_debounce_due_ns(&debounce), 1120);
    iso_debounce_advance(&debounce, 1119);
    assert_false(debounce.level);
    iso_debounce_advance(&debounce, 1120);
    assert_true(debounce.level);
    assert_int_equal(iso_debounce_due_ns(&debounce), INT64_MAX);
    assert_true(iso_debounce_take(&debounce));
    assert_true(iso_debounce_take(&debounce)); /* still pressed */
}

/* The contacts bounce for about 15 ns at both ends of a press. */
static void bounces_are_one_press(void **state)
{
    static const int64_t edges[] = {1100, 1103, 1105, 1112, 1115, 1300, 1302, 1309, 1311, 1314};
    int changes = 0;
    (void)state;
    size_t next = 0;
    for (int64_t t = 1000; t < 1500; t++) {
        const bool before = debounce.level;
        while (next < sizeof edges / sizeof *edges && edges[next] == t) {
            iso_debounce_edge(&debounce, next % 2 == 0, t);
            next++;
        }
        iso_debounce_advance(&debounce, t);
        if (debounce.level != before) {
            assert_int_equal(t, changes == 0 ? 1135 : 1334);
            changes++;
        }
    }
    assert_int_equal(changes, 2);
}

static void a_spike_is_ignored(void **state)
{
    (void)state;
    iso_debounce_edge(&debounce, true, 1100);
    iso_debounce_edge(&debounce, false, 1119);
    iso_debounce_advance(&debounce, 5000);
    assert_false(debounce.level);
    assert_false(iso_debounce_take(&debounce));
}

/* The level was not read before the press was over. */
static void a_press_that_has_ended_counts(void **state)
{
    (void)state;
    iso_debounce_edge(&debounce, true, 1100);
    iso_debounce_edge(&debounce, false, 1120);
    iso_debounce_advance(&debounce, 5000);
    assert_false(debounce.level);
    assert_true(iso_debounce_take(&debounce));
    assert_false(iso_debounce_take(&debounce));
}

static void edges_that_were_lost_do_no_harm(void **state)
{
    (void)state;
    iso_debounce_edge(&debounce, true, 1100);
    iso_debounce_edge(&debounce, true,
                      1110); /* an edge between them was lost: pressed since 1100 */
    iso_debounce_advance(&debounce, 1120);
    assert_true(debounce.level);
    iso_debounce_edge(&debounce, false, 1050); /* earlier than the last edge: counts as now */
    assert_int_equal(iso_debounce_due_ns(&debounce), 1120);
    iso_debounce_advance(&debounce, 1120);
    assert_false(debounce.level);
}

static void without_a_window_every_edge_counts(void **state)
{
    (void)state;
    iso_debounce_init(&debounce, 0, true, 1000);
    assert_true(iso_debounce_take(&debounce));
    iso_debounce_edge(&debounce, false, 1001);
    iso_debounce_advance(&debounce, 1001);
    assert_false(debounce.level);
    assert_true(iso_debounce_take(&debounce)); /* it was active after the last call */
    assert_false(iso_debounce_take(&debounce));
    iso_debounce_edge(&debounce, true, 1002);
    iso_debounce_edge(&debounce, false, 1002);
    iso_debounce_advance(&debounce, 1002);
    assert_true(iso_debounce_take(&debounce));
    assert_false(iso_debounce_take(&debounce));
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup(f, setup)
    const struct CMUnitTest tests[] = {
        TEST(a_level_counts_when_it_has_lasted),
        TEST(bounces_are_one_press),
        TEST(a_spike_is_ignored),
        TEST(a_press_that_has_ended_counts),
        TEST(edges_that_were_lost_do_no_harm),
        TEST(without_a_window_every_edge_counts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
