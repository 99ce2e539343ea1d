/* Schedules: the hour that comes twice, the hour that does not come, special days, edges. The same
 * against iCalendar: test_schedule_ical.c. */
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/policy/calendar.h"
#include "firmware/policy/schedule.h"
#include "tests/firmware/policy/zone_rig.h"

static struct iso_zone zones[2]; /* Europe/Berlin, Australia/Lord_Howe */
static struct iso_special_day_group groups[2];
static struct iso_schedule schedule;
static const struct iso_policy policy = {.zones = zones,
                                         .n_zones = 2,
                                         .groups = groups,
                                         .n_groups = 2,
                                         .schedules = &schedule,
                                         .n_schedules = 1};

static int setup(void **state)
{
    (void)state;
    zone_rig_read("Europe/Berlin", &zones[0]);
    zone_rig_read("Australia/Lord_Howe", &zones[1]);
    memset(groups, 0, sizeof groups);
    memset(&schedule, 0, sizeof schedule);
    return 0;
}

static int64_t utc(int year, int month, int day, int hour, int minute)
{
    return iso_calendar_day(year, month, day) * ISO_DAY_S + 3600 * hour + 60 * minute;
}

static void add_period(struct iso_day_hours *hours, int from_min, int to_min)
{
    hours->periods[hours->n++] = (struct iso_period){.from_min = (uint16_t)from_min,
                                                     .to_min = (uint16_t)to_min};
}

static bool is_active(int64_t time_s)
{
    return iso_schedule_state_is_active(iso_schedule_state_at(&policy, &schedule, time_s));
}

static int active_minutes(int64_t from_s, int64_t to_s)
{
    int n = 0;
    for (int64_t t_s = from_s; t_s < to_s; t_s += 60) {
        n += is_active(t_s);
    }
    return n;
}

/* The end of a period is not in it, to the second; other weekdays do not count. */
static void test_edges(void **state)
{
    (void)state;
    add_period(&schedule.weekly[3], 8 * 60, 17 * 60); /* Wednesday; 2026-11-25 is one */
    assert_false(is_active(utc(2026, 11, 25, 7, 0) - 1));
    assert_true(is_active(utc(2026, 11, 25, 7, 0))); /* 8:00 in Berlin */
    assert_true(is_active(utc(2026, 11, 25, 16, 0) - 1));
    assert_false(is_active(utc(2026, 11, 25, 16, 0)));
    assert_false(is_active(utc(2026, 11, 24, 12, 0)));
    assert_false(is_active(utc(2026, 11, 26, 12, 0)));
    assert_true(is_active(utc(2026, 7, 1, 6, 0))); /* a Wednesday in summer */
    assert_false(is_active(utc(2026, 7, 1, 6, 0) - 1));
}

/* 2026-10-25 at 3:00 the clock in Berlin goes back to 2:00. */
static void test_an_hour_that_comes_twice_is_active_twice(void **state)
{
    (void)state;
    add_period(&schedule.weekly[0], 2 * 60 + 15, 2 * 60 + 45);
    const int64_t first_s = utc(2026, 10, 25, 0, 15), second_s = utc(2026, 10, 25, 1, 15);
    assert_int_equal(iso_wall_clock_at(&zones[0], first_s).minute, 135);
    assert_int_equal(iso_wall_clock_at(&zones[0], second_s).minute, 135);
    assert_true(is_active(first_s) && is_active(first_s + 1799));
    assert_false(is_active(first_s + 1800));
    assert_true(is_active(second_s) && is_active(second_s + 1799));
    assert_false(is_active(second_s + 1800));
    assert_int_equal(active_minutes(utc(2026, 10, 24, 22, 0), utc(2026, 10, 25, 23, 0)), 60);
    assert_int_equal(active_minutes(utc(2026, 11, 1, 0, 0), utc(2026, 11, 2, 0, 0)), 30);
}

/* 2026-03-29 at 2:00 the clock in Berlin goes on to 3:00. */
static void test_an_hour_that_does_not_come_is_missing(void **state)
{
    (void)state;
    add_period(&schedule.weekly[0], 1 * 60, 2 * 60 + 15);
    add_period(&schedule.weekly[0], 2 * 60 + 20, 2 * 60 + 40);
    add_period(&schedule.weekly[0], 2 * 60 + 50, 3 * 60 + 10);
    const int64_t day_s = utc(2026, 3, 28, 23, 0);
    assert_int_equal(active_minutes(day_s, day_s + 60 * 60), 0);
    assert_int_equal(active_minutes(day_s + 60 * 60, day_s + 120 * 60), 60);  /* 1:00 to 2:00 */
    assert_int_equal(active_minutes(day_s + 120 * 60, day_s + 130 * 60), 10); /* 3:00 to 3:10 */
    assert_int_equal(active_minutes(day_s + 130 * 60, day_s + 23 * 60 * 60), 0);
    assert_int_equal(active_minutes(day_s - 7 * 86400, day_s - 6 * 86400), 75 + 20 + 20);
}

/* On Lord Howe the clock moves by half an hour: 2026-04-05 at 2:00 back to 1:30, 2026-10-04 at 2:00
 * on to 2:30. */
static void test_half_an_hour(void **state)
{
    (void)state;
    schedule.zone = 1;
    add_period(&schedule.weekly[0], 1 * 60 + 20, 2 * 60 + 40);
    assert_int_equal(active_minutes(utc(2026, 4, 4, 13, 0), utc(2026, 4, 5, 13, 30)), 80 + 30);
    assert_int_equal(active_minutes(utc(2026, 10, 3, 13, 30), utc(2026, 10, 4, 13, 0)), 80 - 30);
    assert_int_equal(active_minutes(utc(2026, 10, 10, 13, 0), utc(2026, 10, 11, 13, 0)), 80);
}

static void test_special_days_replace_the_weekday(void **state)
{
    (void)state;
    for (int day = 0; day < ISO_WEEKDAYS; day++) {
        add_period(&schedule.weekly[day], 8 * 60, 17 * 60);
    }
    const int32_t christmas = (int32_t)iso_calendar_day(2026, 12, 25);
    groups[0] = (struct iso_special_day_group){.n = 2, .days = {christmas, christmas + 1}};
    groups[1] = (struct iso_special_day_group){.n = 3,
                                               .days = {christmas - 1, christmas, christmas + 7}};
    schedule.n_special = 2;
    schedule.special[0].group = 0; /* no hours */
    schedule.special[1].group = 1;
    add_period(&schedule.special[1].hours, 9 * 60, 11 * 60);
    const struct {
        int day_of_month, hour;
        enum iso_schedule_state state;
    } expected[] = {
        {23, 9, ISO_SCHEDULE_ACTIVE},
        {23, 18, ISO_SCHEDULE_INACTIVE},
        {24, 8, ISO_SCHEDULE_SPECIAL},
        {24, 9, ISO_SCHEDULE_SPECIAL_ACTIVE},
        {25, 8, ISO_SCHEDULE_SPECIAL},
        {25, 10, ISO_SCHEDULE_SPECIAL_ACTIVE}, /* of both groups */
        {26, 10, ISO_SCHEDULE_SPECIAL},
        {27, 10, ISO_SCHEDULE_ACTIVE},
        {32, 10, ISO_SCHEDULE_SPECIAL_ACTIVE},
        {33, 8, ISO_SCHEDULE_ACTIVE},
    };
    for (size_t i = 0; i < sizeof expected / sizeof *expected; i++) {
        const int64_t t_s = utc(2026, 12, expected[i].day_of_month, expected[i].hour - 1, 30);
        assert_int_equal(iso_schedule_state_at(&policy, &schedule, t_s), expected[i].state);
    }
}

/* A special day begins and ends at midnight by the clock on the wall, not by UTC. */
static void test_special_days_are_local(void **state)
{
    (void)state;
    for (int day = 0; day < ISO_WEEKDAYS; day++) {
        add_period(&schedule.weekly[day], 0, ISO_DAY_MINUTES);
    }
    groups[0] = (struct iso_special_day_group){.n = 1,
                                               .days = {(int32_t)iso_calendar_day(2026, 7, 1)}};
    schedule.n_special = 1;
    assert_true(is_active(utc(2026, 6, 30, 22, 0) - 1));
    assert_false(is_active(utc(2026, 6, 30, 22, 0)));
    assert_false(is_active(utc(2026, 7, 1, 22, 0) - 1));
    assert_true(is_active(utc(2026, 7, 1, 22, 0)));
}

/* Long before and after what the zone's table holds. */
static void test_far_years(void **state)
{
    (void)state;
    add_period(&schedule.weekly[5], 8 * 60, 9 * 60);
    assert_int_equal(active_minutes(utc(2399, 1, 1, 7, 0), utc(2399, 1, 1, 8, 0)), 60); /* Friday */
    assert_int_equal(active_minutes(utc(2399, 7, 2, 6, 0), utc(2399, 7, 2, 7, 0)), 60);
    assert_int_equal(active_minutes(utc(1965, 1, 1, 7, 0), utc(1965, 1, 1, 8, 0)), 60);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(test_edges, setup),
        cmocka_unit_test_setup(test_an_hour_that_comes_twice_is_active_twice, setup),
        cmocka_unit_test_setup(test_an_hour_that_does_not_come_is_missing, setup),
        cmocka_unit_test_setup(test_half_an_hour, setup),
        cmocka_unit_test_setup(test_special_days_replace_the_weekday, setup),
        cmocka_unit_test_setup(test_special_days_are_local, setup),
        cmocka_unit_test_setup(test_far_years, setup),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
