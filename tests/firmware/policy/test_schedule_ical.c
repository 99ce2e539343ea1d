/* Every minute of the years 2024 and 2025 in five zones, against libical: the same schedules as
 * iCalendar events of ONVIF's form (weekly recurrence from a date in 1970), expanded once, and
 * libical's own conversion of UTC to local time.
 *
 * libical never returns from some rules that match nothing (FREQ=SECONDLY with the 30th of
 * February). All rules here are weekly. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <libical/ical.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/policy/calendar.h"
#include "firmware/policy/schedule.h"
#include "tests/firmware/policy/zone_rig.h"

#if defined(__SANITIZE_ADDRESS__)
enum { STEP_MINUTES = 11 };
#else
enum { STEP_MINUTES = 1 };
#endif

static const char *const zone_names[] = {
    "Europe/Berlin",       /* the north */
    "America/Santiago",    /* the south */
    "Australia/Lord_Howe", /* summer time of half an hour */
    "Asia/Kolkata",        /* no summer time, half an hour */
    "Asia/Almaty",         /* another offset from 2024-03-01 on */
};

/* ---- the schedules, in a form from which both sides are made */

struct event {
    const char *byday;
    int from_min, to_min;
};

struct special {
    const char *dates[4]; /* YYYYMMDD */
    int from_min, to_min; /* 0, 0: no hours */
};

struct plan {
    struct event events[8];
    struct special specials[3];
};

static const struct plan plans[] = {
    {.events = {{"MO,TU,WE,TH,FR", 450, 720}, {"MO,TU,WE,TH", 780, 1095}, {"SA", 541, 799}},
     .specials = {{{"20240101", "20241225", "20250101", "20251225"}, 0, 0},
                  {{"20241224", "20241225", "20250418"}, 420, 780}}},
    /* Through every night, in which the clocks change. */
    {.events = {{"SU,MO,TU,WE,TH,FR,SA", 0, 360}, {"MO,WE,FR", 1320, 1440}},
     .specials = {{{"20240407", "20250330", "20251026"}, 75, 165}}},
    {.events = {{"SU", 100, 131}, {"SU", 150, 181}, {"SA", 1410, 1440}, {"MO", 30, 31}},
     .specials = {{{"20240331"}, 125, 155}, {{"20241027", "20240331"}, 110, 126}}},
};

static int64_t first_s, last_s; /* of the two years, UTC */

/* ---- this project's side */

static struct iso_zone zone;
static struct iso_special_day_group groups[3];
static struct iso_schedule schedule;
static const struct iso_policy policy = {.zones = &zone,
                                         .n_zones = 1,
                                         .groups = groups,
                                         .n_groups = 3,
                                         .schedules = &schedule,
                                         .n_schedules = 1};

static void add_period(struct iso_day_hours *hours, int from_min, int to_min)
{
    hours->periods[hours->n++] = (struct iso_period){.from_min = (uint16_t)from_min,
                                                     .to_min = (uint16_t)to_min};
}

static int32_t day_of(const char *date)
{
    int year, month, day;
    assert_int_equal(sscanf(date, "%4d%2d%2d", &year, &month, &day), 3);
    return (int32_t)iso_calendar_day(year, month, day);
}

static void add_special(const struct special *special)
{
    const int n = schedule.n_special++;
    groups[n].n = 0;
    for (int i = 0; i < 4 && special->dates[i]; i++) {
        groups[n].days[groups[n].n++] = day_of(special->dates[i]);
    }
    for (int i = 1; i < groups[n].n; i++) { /* ascending */
        for (int k = i; k > 0 && groups[n].days[k] < groups[n].days[k - 1]; k--) {
            const int32_t day = groups[n].days[k];
            groups[n].days[k] = groups[n].days[k - 1];
            groups[n].days[k - 1] = day;
        }
    }
    schedule.special[n].group = (uint16_t)n;
    if (special->to_min != 0) {
        add_period(&schedule.special[n].hours, special->from_min, special->to_min);
    }
}

static void make_schedule(const struct plan *plan)
{
    static const char *const names[] = {"SU", "MO", "TU", "WE", "TH", "FR", "SA"};
    memset(&schedule, 0, sizeof schedule);
    for (int i = 0; i < 8 && plan->events[i].byday; i++) {
        for (int day = 0; day < ISO_WEEKDAYS; day++) {
            if (strstr(plan->events[i].byday, names[day])) {
                add_period(&schedule.weekly[day], plan->events[i].from_min, plan->events[i].to_min);
            }
        }
    }
    for (int i = 0; i < 3 && plan->specials[i].dates[0]; i++) {
        add_special(&plan->specials[i]);
    }
}

/* ---- libical's side: the state of every local minute, with two days before and after */

enum { LOCAL_MINUTES = (731 + 4) * 1440 };
static uint8_t expected[LOCAL_MINUTES];

static int64_t local_minute(struct icaltimetype local)
{
    return ((int64_t)icaltime_as_timet(local) - first_s) / 60 + 2 * 1440;
}

static struct icaltimetype start_of(const char *date)
{
    char text[32];
    (void)snprintf(text, sizeof text, "%sT000000", date);
    return icaltime_from_string(text);
}

static bool is_special_date(const struct plan *plan, struct icaltimetype t)
{
    for (int i = 0; i < 3; i++) {
        for (int d = 0; d < 4 && plan->specials[i].dates[d]; d++) {
            if (icaltime_compare_date_only(start_of(plan->specials[i].dates[d]), t) == 0) {
                return true;
            }
        }
    }
    return false;
}

static void mark(struct icaltimetype start, int minutes, uint8_t bits)
{
    const int64_t from = local_minute(start);
    for (int64_t m = from; m < from + minutes; m++) {
        if (m >= 0 && m < LOCAL_MINUTES) {
            expected[m] |= bits;
        }
    }
}

static void expand_event(const struct plan *plan, const struct event *event)
{
    char text[64];
    (void)snprintf(text, sizeof text, "FREQ=WEEKLY;BYDAY=%s", event->byday);
    /* A Sunday. A weekly rule passes over the weekdays that it does not name. */
    struct icaltimetype start = start_of("19700104");
    icaltime_adjust(&start, 0, 0, event->from_min, 0);
    icalrecur_iterator *iterator = icalrecur_iterator_new(icalrecurrencetype_from_string(text),
                                                          start);
    assert_non_null(iterator);
    for (struct icaltimetype t = icalrecur_iterator_next(iterator); !icaltime_is_null_time(t);
         t = icalrecur_iterator_next(iterator)) {
        if (t.year > 2026) {
            break;
        }
        if (t.year >= 2023 && !is_special_date(plan, t)) {
            mark(t, event->to_min - event->from_min, ISO_SCHEDULE_ACTIVE);
        }
    }
    icalrecur_iterator_free(iterator);
}

static void expand(const struct plan *plan)
{
    memset(expected, 0, sizeof expected);
    for (int i = 0; i < 8 && plan->events[i].byday; i++) {
        expand_event(plan, &plan->events[i]);
    }
    for (int i = 0; i < 3; i++) {
        const struct special *special = &plan->specials[i];
        for (int d = 0; d < 4 && special->dates[d]; d++) {
            struct icaltimetype start = start_of(special->dates[d]);
            mark(start, 1440, ISO_SCHEDULE_SPECIAL);
            icaltime_adjust(&start, 0, 0, special->from_min, 0);
            mark(start, special->to_min - special->from_min, ISO_SCHEDULE_ACTIVE);
        }
    }
}

/* ---- both */

static struct icaltimetype to_local(int64_t time_s, icaltimezone *ical_zone)
{
    struct icaltimetype t = icaltime_from_timet_with_zone((time_t)time_s, 0,
                                                          icaltimezone_get_utc_timezone());
    t = icaltime_convert_to_zone(t, ical_zone);
    t.zone = NULL; /* what the clock on the wall shows, as a time without a zone */
    return t;
}

/* The local minute of every minute of the two years, which is the same for every schedule. */
static int32_t *local_minutes(icaltimezone *ical_zone, int64_t n)
{
    int32_t *minutes = malloc((size_t)n * sizeof *minutes);
    assert_non_null(minutes);
    for (int64_t i = 0; i < n; i += STEP_MINUTES) {
        minutes[i] = (int32_t)local_minute(to_local(first_s + 60 * i, ical_zone));
    }
    return minutes;
}

static void test_every_minute(void **state)
{
    const char *name = *state;
    zone_rig_read(name, &zone);
    icaltimezone *ical_zone = icaltimezone_get_builtin_timezone(name);
    assert_non_null(ical_zone);
    const int64_t n = (last_s - first_s) / 60;
    int32_t *minutes = local_minutes(ical_zone, n);
    for (size_t p = 0; p < sizeof plans / sizeof *plans; p++) {
        make_schedule(&plans[p]);
        expand(&plans[p]);
        int64_t seen[ISO_SCHEDULE_STATES] = {0};
        for (int64_t i = 0; i < n; i += STEP_MINUTES) {
            const int64_t t_s = first_s + 60 * i;
            const int got = (int)iso_schedule_state_at(&policy, &schedule, t_s);
            seen[got]++;
            if (got != expected[minutes[i]]) {
                fail_msg("%s, plan %zu, at %lld: state %d, libical says %d", name, p,
                         (long long)t_s, got, expected[minutes[i]]);
            }
        }
        assert_true(seen[0] > 0 && seen[1] > 0 && seen[2] > 0 && seen[3] > 0);
    }
    free(minutes);
}

int main(void)
{
    first_s = iso_calendar_day(2024, 1, 1) * ISO_DAY_S;
    last_s = iso_calendar_day(2026, 1, 1) * ISO_DAY_S;
    struct CMUnitTest tests[sizeof zone_names / sizeof *zone_names];
    for (size_t i = 0; i < sizeof tests / sizeof *tests; i++) {
        tests[i] = (struct CMUnitTest){.name = zone_names[i],
                                       .test_func = test_every_minute,
                                       .initial_state = (void *)(uintptr_t)zone_names[i]};
    }
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    icaltimezone_free_builtin_timezones();
    icalmemory_free_ring();
    return failed;
}
