/* Points in time as people say them. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdlib.h>
#include <time.h>

#include "enroll/cli/arguments/when_next.h"

/* Thursday 2026-11-26, 10:30 in Berlin, which is 09:30 UTC. */
#define NOW_S  INT64_C(1795685400)
#define HOUR_S 3600
#define DAY_S  86400

static void reads(const char *text, int64_t expected)
{
    int64_t unix_s = -1;

    if (!cli_when_parse_next(text, NOW_S, &unix_s)) {
        fail_msg("'%s' is not read", text);
    }
    if (unix_s != expected) {
        fail_msg("'%s' is %lld, not %lld", text, (long long)unix_s, (long long)expected);
    }
}

static void days_and_times(void **state)
{
    const int64_t midnight = NOW_S - 10 * HOUR_S - HOUR_S / 2;

    (void)state;
    reads("now", NOW_S);
    reads("9:00", midnight + 9 * HOUR_S);
    reads("today 17:30", midnight + 17 * HOUR_S + HOUR_S / 2);
    reads("Today 00:00", midnight);
    reads("tomorrow 8:00", midnight + DAY_S + 8 * HOUR_S);
    reads("sunday 9:00", midnight + 3 * DAY_S + 9 * HOUR_S);
    reads("SundayT09:00", midnight + 3 * DAY_S + 9 * HOUR_S);
    reads("wednesday 23:59", midnight + 7 * DAY_S - 60);
    reads("thursday 10:30", NOW_S);
    reads("thursday 10:29", NOW_S + 7 * DAY_S - 60); /* it has passed this week */
    reads("2026-12-31T18:00", INT64_C(1798736400));
    reads("2026-12-31 18:00Z", INT64_C(1798740000));
    reads("@1000", 1000);
}

static void what_is_no_time(void **state)
{
    static const char *const texts[] = {
        "",    "sunday", "sunday 24:00", "sunday 9:60", "sunday 9",       "sunday9:00", "sun 9:00",
        "9:0", "9:000",  ":30",          "2026-02-30",  "yesterday 9:00", "sunday  9",  "9:00 x"};

    (void)state;
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        int64_t unix_s = 7;
        if (cli_when_parse_next(texts[i], NOW_S, &unix_s)) {
            fail_msg("'%s' is read as %lld", texts[i], (long long)unix_s);
        }
        assert_int_equal(unix_s, 7);
    }
}

/* On 2027-03-28 the clock in Berlin goes from 2:00 to 3:00. */
static void a_time_that_does_not_come(void **state)
{
    const int64_t saturday = INT64_C(1806141600); /* 2027-03-27, 11:00 in Berlin */
    int64_t unix_s = 7;

    (void)state;
    assert_false(cli_when_parse_next("sunday 2:30", saturday, &unix_s));
    assert_int_equal(unix_s, 7);
    assert_true(cli_when_parse_next("sunday 3:30", saturday, &unix_s));
    assert_int_equal(unix_s, saturday + 15 * HOUR_S + HOUR_S / 2);
}

static void a_day_is_written_with_its_name(void **state)
{
    char text[CLI_WHEN_DAY_SIZE];

    (void)state;
    cli_when_format_day(NOW_S, text);
    assert_string_equal(text, "Thursday 2026-11-26 at 10:30");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(days_and_times),
        cmocka_unit_test(what_is_no_time),
        cmocka_unit_test(a_time_that_does_not_come),
        cmocka_unit_test(a_day_is_written_with_its_name),
    };

    setenv("TZ", "Europe/Berlin", 1);
    tzset();
    return cmocka_run_group_tests(tests, NULL, NULL);
}
