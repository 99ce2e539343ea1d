/* Local time: every zone of the system's tzdata against the C library; rules; files that are wrong.
 */
#include <errno.h>
#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/policy/calendar.h"
#include "tests/firmware/policy/zone_rig.h"

static int n_zones;
static uint64_t seed = 20261125;

static uint64_t random_bits(void)
{
    seed = seed * 6364136223846793005U + 1442695040888963407U;
    return seed >> 20;
}

static long c_library_offset_s(int64_t time_s)
{
    struct tm fields;
    const time_t time = (time_t)time_s;
    assert_non_null(localtime_r(&time, &fields));
    return fields.tm_gmtoff;
}

static void compare_at(const struct iso_zone *zone, int64_t time_s)
{
    const long expected = c_library_offset_s(time_s);
    const long got = iso_zone_offset_s(zone, time_s);
    if (got != expected) {
        fail_msg("%s at %lld: offset %ld, the C library says %ld", zone->name, (long long)time_s,
                 got, expected);
    }
}

/* Each change, the seconds around it, and random times of the years 1900 to 2500. */
static void compare_zone(const struct iso_zone *zone)
{
    for (int i = 0; i < zone->n; i++) {
        for (int64_t d = -1; d <= 1; d++) {
            compare_at(zone, zone->at_s[i] + d);
        }
    }
    const int64_t first_s = iso_calendar_year_day(1900) * ISO_DAY_S;
    const int64_t span_s = (iso_calendar_year_day(2500) - iso_calendar_year_day(1900)) * ISO_DAY_S;
    for (int i = 0; i < 2000; i++) {
        compare_at(zone, first_s + (int64_t)(random_bits() % (uint64_t)span_s));
    }
    /* The turns of the years, where a rule changes its year. */
    for (int64_t year = 2030; year < 2110; year++) {
        for (int64_t hour = -24; hour <= 24; hour++) {
            compare_at(zone, iso_calendar_year_day(year) * ISO_DAY_S + 3600 * hour);
        }
    }
}

static int visit_file(const char *path, const struct stat *status, int kind, struct FTW *place)
{
    (void)status, (void)place;
    const char *name = path + strlen(ZONE_RIG_FOLDER "/");
    if (kind != FTW_F || strncmp(name, "right/", 6) == 0 || strncmp(name, "posix/", 6) == 0) {
        return 0;
    }
    size_t size = 0;
    uint8_t *bytes = zone_rig_bytes(name, &size);
    assert_non_null(bytes);
    if (size > 4 && memcmp(bytes, "TZif", 4) == 0) {
        struct iso_zone zone;
        zone_rig_read(name, &zone);
        char variable[300];
        (void)snprintf(variable, sizeof variable, ":%s", name);
        assert_int_equal(setenv("TZ", variable, 1), 0);
        tzset();
        compare_zone(&zone);
        n_zones++;
    }
    free(bytes);
    return 0;
}

static void test_every_zone_agrees_with_the_c_library(void **state)
{
    (void)state;
    n_zones = 0;
    assert_int_equal(nftw(ZONE_RIG_FOLDER, visit_file, 16, FTW_PHYS), 0);
    print_message("%d zones\n", n_zones);
    assert_true(n_zones > 300);
}

/* Rules that tzdata does not use, against the C library, which reads the same text from TZ. */
static void test_rules(void **state)
{
    (void)state;
    static const char *const rules[] = {
        "UTC0",
        "CET-1CEST,M3.5.0,M10.5.0/3",
        "EST5EDT,J60/1:30,J300",            /* a day that ignores the 29th of February */
        "EST+5EDT4:15:30,59/-1,299/25",     /* a day that counts it; times beyond the day */
        "<-03>3<-02>,M10.3.6/24,M2.4.6/24", /* the south: summer over the turn of the year */
        "<+1030>-10:30<+11>-11,M10.1.0,M4.1.0",
        "IST-1GMT0,M10.5.0,M3.5.0/1", /* the summer clock is behind the standard one */
    };
    for (size_t i = 0; i < sizeof rules / sizeof *rules; i++) {
        struct iso_zone zone = {.name = "rule"};
        assert_int_equal(iso_zone_rule_read(rules[i], strlen(rules[i]), &zone.rule), 0);
        assert_int_equal(setenv("TZ", rules[i], 1), 0);
        tzset();
        for (int64_t half_hour = 0; half_hour < 48 * 366 * 5; half_hour++) {
            const int64_t t_s = iso_calendar_year_day(2027) * ISO_DAY_S + 1800 * half_hour;
            compare_at(&zone, t_s - 1);
            compare_at(&zone, t_s);
        }
    }
}

/* RFC 8536, 3.3.1: this rule has summer time all year. The C library takes the year of UTC and is
 * wrong for some hours at each turn of the year. */
static void test_summer_all_year(void **state)
{
    (void)state;
    static const char text[] = "XXX3EDT4,0/0,J365/23";
    struct iso_zone_rule rule;
    assert_int_equal(iso_zone_rule_read(text, strlen(text), &rule), 0);
    for (int64_t hour = 0; hour < 24 * 366 * 5; hour++) {
        assert_int_equal(
            iso_zone_rule_offset_s(&rule, iso_calendar_year_day(2027) * ISO_DAY_S + 3600 * hour),
            -4 * 3600);
    }
}

static void test_rules_that_are_refused(void **state)
{
    (void)state;
    static const char *const rules[] = {
        "",
        "UT0",                           /* two letters */
        "CET",                           /* no offset */
        "CET-25",                        /* beyond a day */
        "CET-1CEST",                     /* no days: each system has its own */
        "CET-1CEST,M3.5.0",              /* one day */
        "CET-1CEST,M13.5.0,M10.5.0/3",   /* month */
        "CET-1CEST,M3.6.0,M10.5.0/3",    /* week */
        "CET-1CEST,M3.5.7,M10.5.0/3",    /* weekday */
        "CET-1CEST,M3.5.0/168,M10.5.0",  /* time */
        "CET-1CEST,J0,J365",             /* Julian days begin with 1 */
        "CET-1CEST,0,366",               /* other days end with 365 */
        "CET-1CEST,M3.5.0,M10.5.0/3 ",   /* a byte too much */
        "<CET-1",                        /* bracket */
        "C1T-1",                         /* a digit outside brackets */
        "CET-1:60",                      /* minutes */
        "CET-99999999999999999999999999" /* a number that fits nowhere */
    };
    for (size_t i = 0; i < sizeof rules / sizeof *rules; i++) {
        struct iso_zone_rule rule = {.standard_s = 4711};
        assert_int_equal(iso_zone_rule_read(rules[i], strlen(rules[i]), &rule), -EINVAL);
        assert_int_equal(rule.standard_s, 4711);
    }
    /* The size counts, not the end of a string. */
    struct iso_zone_rule rule = {0};
    assert_int_equal(iso_zone_rule_read("UTC0xxx", 4, &rule), 0);
}

static const struct zone_file good = {.version = '2',
                                      .n = 2,
                                      .at_s = {1000, 2000},
                                      .type_of = {1, 0},
                                      .n_types = 2,
                                      .offset_s = {3600, 7200},
                                      .footer = "\nABC-5\n"};

static int read_file(const struct zone_file *file, struct iso_fault *fault)
{
    uint8_t bytes[ZONE_FILE_SIZE];
    struct iso_zone zone = {.n = 77};
    const size_t size = zone_file_write(file, bytes);
    const int error = iso_zone_read("Test/Zone", bytes, size, &zone, fault);
    assert_int_equal(zone.n == 77, error != 0);
    return error;
}

static void test_a_built_file(void **state)
{
    (void)state;
    uint8_t bytes[ZONE_FILE_SIZE];
    struct iso_zone zone;
    const size_t size = zone_file_write(&good, bytes);
    assert_int_equal(iso_zone_read("Test/Zone", bytes, size, &zone, NULL), 0);
    assert_string_equal(zone.name, "Test/Zone");
    assert_int_equal(iso_zone_offset_s(&zone, -5), 3600);
    assert_int_equal(iso_zone_offset_s(&zone, 999), 3600);
    assert_int_equal(iso_zone_offset_s(&zone, 1000), 7200);
    assert_int_equal(iso_zone_offset_s(&zone, 1999), 7200);
    assert_int_equal(iso_zone_offset_s(&zone, 2000), 18000);
}

static void test_files_that_are_refused(void **state)
{
    (void)state;
    struct zone_file files[12];
    for (size_t i = 0; i < 12; i++) {
        files[i] = good;
    }
    int expected[12] = {0};
    files[0].version = '\0', expected[0] = -EOPNOTSUPP;
    files[1].version = '5', expected[1] = -EOPNOTSUPP;
    files[2].n_leap = 1, expected[2] = -EOPNOTSUPP;
    files[3].footer = "\n\n", expected[3] = -EOPNOTSUPP;
    files[4].footer = "\nABC-5", expected[4] = -EBADMSG;
    files[5].footer = "", expected[5] = -EBADMSG;
    files[6].footer = "\nABC\n", expected[6] = -EBADMSG;
    files[7].at_s[1] = 1000, expected[7] = -EBADMSG; /* not ascending */
    files[8].type_of[1] = 2, expected[8] = -EBADMSG; /* no such type */
    files[9].offset_s[1] = 93600, expected[9] = -EBADMSG;
    files[10].offset_s[0] = -90000, expected[10] = -EBADMSG;
    files[11].n_types = 0, files[11].n = 0, expected[11] = -EBADMSG;
    for (size_t i = 0; i < 12; i++) {
        struct iso_fault fault = {0};
        assert_int_equal(read_file(&files[i], &fault), expected[i]);
        assert_memory_equal(fault.text, "zone Test/Zone: ", 16);
    }
}

/* Zones as they were never read. In each of them one thing is wrong. */
static void test_stored_zones(void **state)
{
    (void)state;
    const int time_max_s = 167 * 3600 + 3599;
    static struct iso_zone zone;
    const struct {
        struct iso_zone_change change;
        bool sound;
    } changes[] = {
        {{ISO_ZONE_DAY_OF_WEEK, 12, 5, 6, 0, time_max_s}, true},
        {{ISO_ZONE_DAY_OF_WEEK, 1, 1, 0, 0, -time_max_s}, true},
        {{ISO_ZONE_DAY_OF_WEEK, 0, 1, 0, 0, 0}, false},
        {{ISO_ZONE_DAY_OF_WEEK, 13, 1, 0, 0, 0}, false},
        {{ISO_ZONE_DAY_OF_WEEK, 1, 0, 0, 0, 0}, false},
        {{ISO_ZONE_DAY_OF_WEEK, 1, 6, 0, 0, 0}, false},
        {{ISO_ZONE_DAY_OF_WEEK, 1, 1, 7, 0, 0}, false},
        {{ISO_ZONE_DAY_JULIAN, 0, 0, 0, 1, 0}, true},
        {{ISO_ZONE_DAY_JULIAN, 0, 0, 0, 0, 0}, false},
        {{ISO_ZONE_DAY_JULIAN, 0, 0, 0, 366, 0}, false},
        {{ISO_ZONE_DAY_OF_YEAR, 0, 0, 0, 365, 0}, true},
        {{ISO_ZONE_DAY_OF_YEAR, 0, 0, 0, 366, 0}, false},
        {{ISO_ZONE_DAY_OF_YEAR, 0, 0, 0, -1, 0}, false},
        {{ISO_ZONE_DAY_OF_YEAR, 0, 0, 0, 0, time_max_s + 1}, false},
        {{ISO_ZONE_DAY_OF_YEAR, 0, 0, 0, 0, -time_max_s - 1}, false},
        {{3, 1, 1, 1, 1, 0}, false},
    };
    for (size_t i = 0; i < sizeof changes / sizeof *changes; i++) {
        for (int end = 0; end < 2; end++) {
            zone_rig_fixed(0, &zone);
            zone.rule.has_summer = true;
            zone.rule.to_standard = zone.rule.to_summer = (struct iso_zone_change){
                .kind = ISO_ZONE_DAY_OF_YEAR};
            assert_true(iso_zone_is_sound(&zone));
            *(end ? &zone.rule.to_standard : &zone.rule.to_summer) = changes[i].change;
            assert_int_equal(iso_zone_is_sound(&zone), changes[i].sound);
        }
    }
    zone.rule = (struct iso_zone_rule){.has_summer = true, .summer_s = 93600};
    zone.rule.to_standard.day = zone.rule.to_summer.day = 1;
    assert_false(iso_zone_is_sound(&zone));
    zone.rule.summer_s = 93599;
    assert_true(iso_zone_is_sound(&zone));
    zone.rule.standard_s = 90000;
    assert_false(iso_zone_is_sound(&zone));
}

static void test_stored_tables(void **state)
{
    (void)state;
    static struct iso_zone zones[6];
    for (int i = 0; i < 6; i++) {
        zone_rig_fixed(0, &zones[i]);
        zones[i].n = 2;
        zones[i].at_s[1] = 1;
        assert_true(iso_zone_is_sound(&zones[i]));
    }
    zones[0].name[0] = '\0';
    memset(zones[1].name, 'x', ISO_ZONE_NAME_SIZE);
    for (int i = 0; i < ISO_ZONE_CHANGES_MAX; i++) {
        zones[2].at_s[i] = i;
        zones[2].offset_s[i] = 1; /* what lies behind at_s would ascend, too */
    }
    zones[2].n = ISO_ZONE_CHANGES_MAX;
    assert_true(iso_zone_is_sound(&zones[2]));
    zones[2].n++;
    zones[3].at_s[0] = 1;
    zones[4].offset_s[1] = ISO_ZONE_OFFSET_MAX_S + 1;
    zones[5].first_offset_s = ISO_ZONE_OFFSET_MIN_S - 1;
    for (int i = 0; i < 6; i++) {
        assert_false(iso_zone_is_sound(&zones[i]));
    }
}

static void test_too_many_changes(void **state)
{
    (void)state;
    /* The counts alone decide; the file has as many bytes as they ask for. */
    static uint8_t bytes[20000];
    struct zone_file file = good;
    const size_t size = zone_file_write(&file, bytes);
    const size_t count_at = 44 + 7 + 32; /* the first header and its data; the count of changes */
    bytes[count_at + 2] = 3;             /* 3 * 256 + 2 */
    struct iso_zone zone;
    struct iso_fault fault = {0};
    assert_int_equal(iso_zone_read("Test/Zone", bytes, size, &zone, &fault), -EBADMSG);
    assert_int_equal(iso_zone_read("Test/Zone", bytes, sizeof bytes, &zone, &fault), -E2BIG);
    assert_string_equal(fault.text, "zone Test/Zone: 770 changes of its clock, at most 512");
}

static void test_names(void **state)
{
    (void)state;
    uint8_t bytes[ZONE_FILE_SIZE];
    const size_t size = zone_file_write(&good, bytes);
    char name[ISO_ZONE_NAME_SIZE + 1];
    memset(name, 'x', sizeof name);
    name[ISO_ZONE_NAME_SIZE] = '\0';
    struct iso_zone zone;
    struct iso_fault fault = {0};
    assert_int_equal(iso_zone_read(name, bytes, size, &zone, &fault), -EINVAL);
    assert_int_equal(iso_zone_read("", bytes, size, &zone, &fault), -EINVAL);
    name[ISO_ZONE_NAME_SIZE - 1] = '\0';
    assert_int_equal(iso_zone_read(name, bytes, size, &zone, &fault), 0);
}

/* Every file that ends too early is refused, whatever is missing. */
static void test_cut_files(void **state)
{
    (void)state;
    size_t size = 0;
    uint8_t *whole = zone_rig_bytes("Europe/Berlin", &size);
    assert_non_null(whole);
    for (size_t cut = 0; cut < size; cut++) {
        uint8_t *part = malloc(cut + 1); /* of this size, so that a sanitizer sees what is beyond */
        assert_non_null(part);
        memcpy(part, whole, cut);
        struct iso_zone zone;
        struct iso_fault fault = {0};
        const int error = iso_zone_read("Europe/Berlin", part, cut, &zone, &fault);
        if (error != -EBADMSG) {
            fail_msg("%zu of %zu bytes: %d", cut, size, error);
        }
        free(part);
    }
    free(whole);
}

/* The calendar against the C library, day by day. */
static void test_calendar(void **state)
{
    (void)state;
    for (int64_t day = -200000; day < 400000; day += day % 2 ? 1 : 2) {
        const time_t time = (time_t)(day * ISO_DAY_S);
        struct tm fields;
        assert_non_null(gmtime_r(&time, &fields));
        assert_int_equal(iso_calendar_year(day), 1900 + fields.tm_year);
        assert_int_equal(iso_calendar_weekday(day), fields.tm_wday);
        assert_int_equal(iso_calendar_year_day(1900 + fields.tm_year), day - fields.tm_yday);
        assert_int_equal(iso_calendar_day(1900 + fields.tm_year, fields.tm_mon + 1, fields.tm_mday),
                         day);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_zone_agrees_with_the_c_library),
        cmocka_unit_test(test_rules),
        cmocka_unit_test(test_summer_all_year),
        cmocka_unit_test(test_rules_that_are_refused),
        cmocka_unit_test(test_a_built_file),
        cmocka_unit_test(test_files_that_are_refused),
        cmocka_unit_test(test_stored_zones),
        cmocka_unit_test(test_stored_tables),
        cmocka_unit_test(test_too_many_changes),
        cmocka_unit_test(test_names),
        cmocka_unit_test(test_cut_files),
        cmocka_unit_test(test_calendar),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
