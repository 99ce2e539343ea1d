/* Converts the count and the clock of a device to ours: gaps, delays, drift, and devices that start
 * again. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "drivers/sensor/contract/timeline.h"

#define MS INT64_C(1000000)

static void a_gap_in_the_count_is_a_gap_in_the_sequence(void **state)
{
    struct iso_timeline timeline = {0};
    (void)state;
    iso_timeline_advance(&timeline, 7, 100 * MS, 5000 * MS);
    assert_int_equal(timeline.sequence, 0);
    iso_timeline_advance(&timeline, 8, 133 * MS, 5033 * MS);
    assert_int_equal(timeline.sequence, 1);
    iso_timeline_advance(&timeline, 11, 233 * MS, 5133 * MS);
    assert_int_equal(timeline.sequence, 4);
}

static void a_caller_who_wants_few_frames_sees_no_gaps(void **state)
{
    struct iso_timeline timeline = {.gapless = true};
    (void)state;
    iso_timeline_advance(&timeline, 7, 100 * MS, 5000 * MS);
    iso_timeline_advance(&timeline, 10, 200 * MS, 5100 * MS);
    assert_int_equal(timeline.sequence, 1);
    timeline.gapless = false;
    iso_timeline_advance(&timeline, 12, 266 * MS, 5166 * MS);
    assert_int_equal(timeline.sequence, 3);
}

static void the_least_delay_is_what_counts(void **state)
{
    struct iso_timeline timeline = {0};
    (void)state;
    iso_timeline_advance(&timeline, 1, 0, 1000 * MS + 9 * MS); /* 9 ms late */
    assert_int_equal(timeline.t_ns, 1009 * MS);
    iso_timeline_advance(&timeline, 2, 40 * MS, 1040 * MS + 3 * MS); /* 3 ms late */
    assert_int_equal(timeline.t_ns, 1043 * MS);
    iso_timeline_advance(&timeline, 3, 80 * MS, 1080 * MS + 30 * MS); /* too late: not used */
    assert_true(timeline.t_ns >= 1083 * MS);
    assert_true(timeline.t_ns <= 1083 * MS + 40 * MS * ISO_TIMELINE_DRIFT_PPM / 1000000);
}

static void no_frame_lies_in_the_future_and_time_rises(void **state)
{
    struct iso_timeline timeline = {0};
    int64_t last_ns = 0;
    uint32_t random = 1;
    (void)state;
    for (int i = 1; i < 1000; i++) {
        random = random * 1664525U + 1013904223U;
        const int64_t now_ns = 2000 * MS + i * 33 * MS + (int64_t)(random >> 8) % (80 * MS);
        iso_timeline_advance(&timeline, i, i * 33 * MS, now_ns);
        assert_true(timeline.t_ns <= now_ns);
        assert_true(timeline.t_ns > last_ns);
        last_ns = timeline.t_ns;
    }
}

/* Two clocks differ by `ppm`, for ten hours at 30 Hz. */
static void follows_a_clock_that_drifts(int64_t ppm)
{
    struct iso_timeline timeline = {0};
    for (int64_t i = 1; i < 10 * 3600 * 30; i++) {
        const int64_t now_ns = i * 33333333;
        const int64_t device_ns = now_ns + now_ns / 1000000 * ppm;
        iso_timeline_advance(&timeline, i, device_ns, now_ns + (i % 5) * MS);
        assert_true(timeline.t_ns - now_ns < 5 * MS && now_ns - timeline.t_ns < 5 * MS);
    }
}

static void follows_clocks_that_drift(void **state)
{
    (void)state;
    follows_a_clock_that_drifts(100);
    follows_a_clock_that_drifts(-100);
}

static void begins_anew(void **state)
{
    struct iso_timeline timeline = {0};
    (void)state;
    iso_timeline_advance(&timeline, 900, 30000 * MS, 50000 * MS);
    iso_timeline_advance(&timeline, 1, 10 * MS, 50100 * MS); /* the device was reset */
    assert_int_equal(timeline.sequence, 1);
    assert_int_equal(timeline.t_ns, 50100 * MS);
    iso_timeline_restart(&timeline); /* stopped and started: the device kept counting */
    iso_timeline_advance(&timeline, 200, 7000 * MS, 60000 * MS);
    assert_int_equal(timeline.sequence, 2);
    assert_int_equal(timeline.t_ns, 60000 * MS);
    iso_timeline_advance(&timeline, 201, 7000 * MS, 60000 * MS); /* and a clock that stands still */
    assert_int_equal(timeline.sequence, 3);
    assert_int_equal(timeline.t_ns, 60000 * MS + 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_gap_in_the_count_is_a_gap_in_the_sequence),
        cmocka_unit_test(a_caller_who_wants_few_frames_sees_no_gaps),
        cmocka_unit_test(the_least_delay_is_what_counts),
        cmocka_unit_test(no_frame_lies_in_the_future_and_time_rises),
        cmocka_unit_test(follows_clocks_that_drift),
        cmocka_unit_test(begins_anew),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
