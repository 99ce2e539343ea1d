/* What the reader of files makes of a calendar, and what it refuses with which line. The expected
 * documents are written by hand from RFC 5545. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/policy_reader/reader_input.h"
#include "tests/support/programs/run.h"

enum { TODAY = 20261126, TEXT_SIZE = 8192 };

/* One line of iCalendar. */
#define LINE(text) text "\r\n"
#define BERLIN     ";TZID=Europe/Berlin:"
#define BEGIN      LINE("BEGIN:VEVENT") LINE("UID:1")
#define END        LINE("END:VEVENT")
/* Monday 2026-01-05. */
#define WORK LINE("SUMMARY:Work") LINE("DTSTART" BERLIN "20260105T090000")

static const char *calendar(const char *events)
{
    static char text[TEXT_SIZE];

    (void)snprintf(text, sizeof text,
                   LINE("BEGIN:VCALENDAR") LINE("VERSION:2.0")
                       LINE("PRODID:-//t") "%s" LINE("END:VCALENDAR"),
                   events);
    return text;
}

static void becomes(const char *events, const char *expected)
{
    struct reader_line line = {.text = ""};
    const char *text = calendar(events);
    json_t *document = reader_ics(text, strlen(text), NULL, TODAY, &line);

    if (!document) {
        fail_msg("%s\n%s", line.text, text);
    }
    char *json = json_dumps(document, JSON_COMPACT);
    assert_string_equal(json, expected);
    free(json);
    json_decref(document);
}

static void is_refused(const char *events, const char *expected)
{
    struct reader_line line = {.text = ""};
    const char *text = calendar(events);

    if (reader_ics(text, strlen(text), NULL, TODAY, &line) != NULL) {
        fail_msg("it is not refused: %s", text);
    }
    assert_string_equal(line.text, expected);
}

static void hours_of_a_week(void **state)
{
    (void)state;
    becomes(BEGIN WORK LINE("DTEND" BERLIN "20260105T173000") LINE("RRULE:FREQ=WEEKLY;BYDAY=MO,WE")
                END,
            "{\"special_day_groups\":[],\"schedules\":[{\"token\":\"Work\",\"zone\":"
            "\"Europe/Berlin\",\"weekly\":{\"monday\":[\"09:00-17:30\"],\"wednesday\":[\"09:00-"
            "17:30\"]},\"special_days\":[]}]}");
    /* The day of DTSTART, a DURATION, UTC. */
    becomes(BEGIN LINE("SUMMARY:Tea") LINE("DTSTART:20260106T150000Z") LINE("DURATION:PT45M")
                LINE("RRULE:FREQ=WEEKLY") END,
            "{\"special_day_groups\":[],\"schedules\":[{\"token\":\"Tea\",\"zone\":\"UTC\","
            "\"weekly\":{\"tuesday\":[\"15:00-15:45\"]},\"special_days\":[]}]}");
    /* Every day; until midnight; WKST has no effect. */
    becomes(BEGIN WORK LINE("DTEND" BERLIN "20260106T000000") LINE("RRULE:FREQ=DAILY;WKST=SU") END,
            "{\"special_day_groups\":[],\"schedules\":[{\"token\":\"Work\",\"zone\":"
            "\"Europe/Berlin\",\"weekly\":{\"sunday\":[\"09:00-24:00\"],\"monday\":[\"09:00-24:00\""
            "],\"tuesday\":[\"09:00-24:00\"],\"wednesday\":[\"09:00-24:00\"],\"thursday\":[\"09:00-"
            "24:00\"],\"friday\":[\"09:00-24:00\"],\"saturday\":[\"09:00-24:00\"]},"
            "\"special_days\":[]}]}");
}

static void past_midnight(void **state)
{
    (void)state;
    becomes(BEGIN LINE("SUMMARY:Guard") LINE("DTSTART" BERLIN "20260110T220000")
                LINE("DTEND" BERLIN "20260111T063000") LINE("RRULE:FREQ=WEEKLY;BYDAY=SA") END,
            "{\"special_day_groups\":[],\"schedules\":[{\"token\":\"Guard\",\"zone\":"
            "\"Europe/Berlin\",\"weekly\":{\"sunday\":[\"00:00-06:30\"],\"saturday\":[\"22:00-"
            "24:00\"]},\"special_days\":[]}]}");
    /* A whole day from 10 to 10. */
    becomes(BEGIN LINE("SUMMARY:Guard") LINE("DTSTART" BERLIN "20260110T100000")
                LINE("DTEND" BERLIN "20260111T100000") LINE("RRULE:FREQ=WEEKLY") END,
            "{\"special_day_groups\":[],\"schedules\":[{\"token\":\"Guard\",\"zone\":"
            "\"Europe/Berlin\",\"weekly\":{\"sunday\":[\"00:00-10:00\"],\"saturday\":[\"10:00-"
            "24:00\"]},\"special_days\":[]}]}");
}

#define MORNING                                                            \
    BEGIN LINE("SUMMARY:Morning") LINE("DTSTART" BERLIN "20260105T080000") \
        LINE("DTEND" BERLIN "20260105T120000") LINE("RRULE:FREQ=WEEKLY;BYDAY=MO,TU")
#define NOON                                                            \
    BEGIN LINE("SUMMARY:Noon") LINE("DTSTART" BERLIN "20260105T113000") \
        LINE("DTEND" BERLIN "20260105T140000") LINE("RRULE:FREQ=WEEKLY;BYDAY=MO")

static void a_named_calendar_is_one_schedule(void **state)
{
    (void)state;
    becomes(LINE("X-WR-CALNAME:office") MORNING END NOON END BEGIN LINE("SUMMARY:Christmas")
                LINE("DTSTART;VALUE=DATE:20261225") LINE("DTEND;VALUE=DATE:20261227")
                    END BEGIN LINE("SUMMARY:New Year") LINE("DTSTART;VALUE=DATE:20260101") END,
            "{\"special_day_groups\":[{\"token\":\"office\",\"days\":[\"2026-01-01\",\"2026-12-25\""
            ",\"2026-12-26\"]}],\"schedules\":[{\"token\":\"office\",\"zone\":\"Europe/Berlin\","
            "\"weekly\":{\"monday\":[\"08:00-14:00\"],\"tuesday\":[\"08:00-12:00\"]},"
            "\"special_days\":[{\"group\":\"office\"}]}]}");
}

static void a_calendar_of_holidays_is_a_group(void **state)
{
    (void)state;
    becomes(BEGIN LINE("SUMMARY:Christmas") LINE("DTSTART;VALUE=DATE:20261225") END,
            "{\"special_day_groups\":[{\"token\":\"holidays\",\"days\":[\"2026-12-25\"]}],"
            "\"schedules\":[]}");
    /* Across the end of February of a leap year. */
    becomes(BEGIN LINE("SUMMARY:Closed") LINE("DTSTART;VALUE=DATE:20280228")
                LINE("DTEND;VALUE=DATE:20280302") END,
            "{\"special_day_groups\":[{\"token\":\"holidays\",\"days\":[\"2028-02-28\",\"2028-02-"
            "29\",\"2028-03-01\"]}],\"schedules\":[]}");
}

static void exceptions_are_special_days(void **state)
{
    (void)state;
    becomes(MORNING LINE("EXDATE" BERLIN "20261229T080000")
                LINE("EXDATE" BERLIN "20261222T080000,20261223T080000") END,
            "{\"special_day_groups\":[{\"token\":\"Morning exceptions\",\"days\":[\"2026-12-22\","
            "\"2026-12-29\"]}],\"schedules\":[{\"token\":\"Morning\",\"zone\":\"Europe/Berlin\","
            "\"weekly\":{\"monday\":[\"08:00-12:00\"],\"tuesday\":[\"08:00-12:00\"]},"
            "\"special_days\":[{\"group\":\"Morning exceptions\"}]}]}");
    /* Both events of a Monday leave it out. */
    becomes(LINE("NAME:o") MORNING LINE("EXDATE" BERLIN "20261228T080000")
                END NOON LINE("EXDATE" BERLIN "20261228T113000") END,
            "{\"special_day_groups\":[{\"token\":\"o exceptions\",\"days\":[\"2026-12-28\"]}],"
            "\"schedules\":[{\"token\":\"o\",\"zone\":\"Europe/Berlin\",\"weekly\":{\"monday\":["
            "\"08:00-14:00\"],\"tuesday\":[\"08:00-12:00\"]},\"special_days\":[{\"group\":\"o "
            "exceptions\"}]}]}");
    is_refused(LINE("NAME:o") MORNING LINE("EXDATE" BERLIN "20261228T080000") END NOON END,
               "schedule \"o\": not all of its events leave out 2026-12-28, which cannot be kept");
}

static void cancelled_events_do_not_count(void **state)
{
    (void)state;
    is_refused(BEGIN WORK LINE("STATUS:CANCELLED") LINE("RRULE:FREQ=YEARLY") END,
               "the calendar has no events");
}

static void a_zone_for_times_without_one(void **state)
{
    struct reader_line line = {.text = ""};
    const char *text = calendar(BEGIN LINE("SUMMARY:Tea") LINE("DTSTART:20260106T150000")
                                    LINE("DTEND:20260106T160000") LINE("RRULE:FREQ=WEEKLY") END);
    json_t *document = reader_ics(text, strlen(text), "Asia/Tokyo", TODAY, &line);

    (void)state;
    assert_non_null(document);
    assert_string_equal(json_string_value(json_object_get(
                            json_array_get(json_object_get(document, "schedules"), 0), "zone")),
                        "Asia/Tokyo");
    json_decref(document);
}

#define WEEKLY(more) BEGIN WORK LINE("DTEND" BERLIN "20260105T173000") LINE("RRULE:" more) END
#define EVENT(lines) BEGIN LINE("SUMMARY:Work") lines END

static const struct {
    const char *events, *line;
} refusals[] = {
    {"", "the calendar has no events"},
    {EVENT(""), "event \"Work\": has no DTSTART"},
    {BEGIN LINE("DTSTART:20260105T090000Z") END,
     "event \"number 1\": happens once; only what repeats every week becomes hours"},
    {WEEKLY("FREQ=MONTHLY;BYDAY=1MO"), "event \"Work\": repeats neither every week nor every day"},
    {WEEKLY("FREQ=SECONDLY;BYMONTH=2;BYMONTHDAY=30"),
     "event \"Work\": repeats neither every week nor every day"},
    {WEEKLY("FREQ=WEEKLY;BYMONTH=6"), "event \"Work\": repeats neither every week nor every day"},
    {WEEKLY("FREQ=WEEKLY;BYHOUR=9,14"), "event \"Work\": repeats neither every week nor every day"},
    {WEEKLY("FREQ=WEEKLY;INTERVAL=2"),
     "event \"Work\": INTERVAL=2: a schedule is the same every week"},
    {WEEKLY("FREQ=DAILY;INTERVAL=7"),
     "event \"Work\": INTERVAL=7: a schedule is the same every week"},
    {WEEKLY("FREQ=WEEKLY;COUNT=10"), "event \"Work\": COUNT: the hours of a schedule have no end"},
    {WEEKLY("FREQ=WEEKLY;UNTIL=20271231T000000Z"),
     "event \"Work\": UNTIL: the hours of a schedule have no end"},
    {WEEKLY("FREQ=WEEKLY;BYDAY=TU"), "event \"Work\": DTSTART is on no day of BYDAY"},
    {BEGIN WORK LINE("DTEND" BERLIN "20260105T173000") LINE("RRULE:FREQ=WEEKLY")
         LINE("RDATE" BERLIN "20260110T090000") END,
     "event \"Work\": RDATE: a schedule has no further days"},
    {BEGIN WORK LINE("DTEND" BERLIN "20260105T173000") LINE("RRULE:FREQ=WEEKLY")
         LINE("RECURRENCE-ID" BERLIN "20260112T090000") END,
     "event \"Work\": RECURRENCE-ID: one day of another event cannot be changed"},
    {BEGIN WORK LINE("DTEND" BERLIN "20260105T173000") LINE("RRULE:FREQ=WEEKLY")
         LINE("RRULE:FREQ=DAILY") END,
     "event \"Work\": has more than one RRULE"},
    {BEGIN WORK LINE("RRULE:FREQ=WEEKLY") END, "event \"Work\": lasts no time, or more than a day"},
    {BEGIN WORK LINE("DTEND" BERLIN "20260106T090100") LINE("RRULE:FREQ=WEEKLY") END,
     "event \"Work\": lasts no time, or more than a day"},
    {BEGIN WORK LINE("DTEND" BERLIN "20260105T080000") LINE("RRULE:FREQ=WEEKLY") END,
     "event \"Work\": lasts no time, or more than a day"},
    {BEGIN WORK LINE("DTEND" BERLIN "20260105T173030") LINE("RRULE:FREQ=WEEKLY") END,
     "event \"Work\": begins or ends within a minute"},
    {BEGIN WORK LINE("DTEND;TZID=Europe/Paris:20260105T173000") LINE("RRULE:FREQ=WEEKLY") END,
     "event \"Work\": begins in the time zone Europe/Berlin and ends in Europe/Paris"},
    {EVENT(LINE("DTSTART:20260105T090000") LINE("DTEND:20260105T100000") LINE("RRULE:FREQ=WEEKLY")),
     "event \"Work\": its time has no time zone: name one with --zone"},
    {EVENT(LINE("DTSTART" BERLIN "20261127T090000") LINE("DTEND" BERLIN "20261127T100000")
               LINE("RRULE:FREQ=WEEKLY")),
     "event \"Work\": begins in the future, and the hours of a schedule do not"},
    {EVENT(LINE("DTSTART" BERLIN "20260110T220000") LINE("DTEND" BERLIN "20260111T060000")
               LINE("RRULE:FREQ=WEEKLY") LINE("EXDATE" BERLIN "20261226T220000")),
     "event \"Work\": EXDATE of an event that passes midnight cannot be kept"},
    {EVENT(LINE("DTSTART;VALUE=DATE:20261225") LINE("RRULE:FREQ=YEARLY")),
     "event \"Work\": a whole day that repeats cannot be kept: special days are dates, so make "
     "an event for each year"},
    {EVENT(LINE("DTSTART;VALUE=DATE:20261225") LINE("DTEND;VALUE=DATE:20261225")),
     "event \"Work\": ends before it begins"},
    {EVENT(LINE("DTSTART;VALUE=DATE:20260101") LINE("DTEND;VALUE=DATE:20270101")),
     "event \"Work\": the calendar has more than 64 special days"},
    {LINE("NAME:o") MORNING END BEGIN LINE("SUMMARY:Tea") LINE("DTSTART:20260106T150000Z")
         LINE("DURATION:PT45M") LINE("RRULE:FREQ=WEEKLY") END,
     "event \"Tea\": has the time zone UTC, and other events of \"o\" have Europe/Berlin"},
    {EVENT(LINE("DTSTART;VALUE=DATE:20260231")),
     "event \"Work\": DTSTART is not a date from 1970 on"},
    {WEEKLY("FREQ=WEKLY"), "event \"Work\": is not iCalendar: Can't parse as RECUR value in "
                           "RRULE property. Removing entire property: FREQ=WEKLY"},
};

static void what_cannot_be_kept(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof refusals / sizeof *refusals; i++) {
        is_refused(refusals[i].events, refusals[i].line);
    }
}

static void what_is_no_calendar(void **state)
{
    static const char *const texts[] = {"", "hello", "BEGIN:VEVENT\r\nEND:VEVENT\r\n",
                                        "BEGIN:VCALENDAR\r\nEND:VCALENDAR\r\n"
                                        "BEGIN:VCALENDAR\r\nEND:VCALENDAR\r\n"};

    (void)state;
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        struct reader_line line = {.text = ""};
        assert_null(reader_ics(texts[i], strlen(texts[i]), NULL, TODAY, &line));
        assert_string_equal(line.text, "it is not one iCalendar object (VCALENDAR)");
    }
}

#ifdef ISOTHERM_HAS_TOML
/* The same document in TOML and JSON. */
static void toml_and_json_are_the_same(void **state)
{
    static const char toml[] = "default_profile = \"staff\" # a comment\n"
                               "[[special_day_groups]]\n"
                               "token = 'free'\n"
                               "days = [2026-12-25, \"2026-12-26\"]\n"
                               "[[security_levels]]\n"
                               "token = \"l\"\n"
                               "priority = -7\n"
                               "open = true\n"
                               "recognition_groups = [[\"card\", \"pin\"], []]\n";
    static const char json[] =
        "{\"default_profile\":\"staff\",\"special_day_groups\":[{\"token\":\"free\",\"days\":["
        "\"2026-12-25\",\"2026-12-26\"]}],\"security_levels\":[{\"token\":\"l\",\"priority\":-7,"
        "\"open\":true,\"recognition_groups\":[[\"card\",\"pin\"],[]]}]}";
    struct reader_line line = {.text = ""};
    json_t *a = reader_toml(toml, strlen(toml), &line);
    json_t *b = reader_json(json, strlen(json), &line);

    (void)state;
    assert_non_null(a);
    assert_non_null(b);
    assert_true(json_equal(a, b));
    json_decref(a);
    json_decref(b);
}

static void toml_that_is_refused(void **state)
{
    static const struct {
        const char *toml, *line;
    } cases[] = {
        {"a = 1\na = 2\n", "line 2, column 5: "},
        {"\na = \"x\\u0000\"\n", "line 2: a text has a zero character"},
        {"a = 2026-12-25T09:00:00\n", "line 1: a time stands in quotes"},
        {"\n\na = [09:00:00]\n", "line 3: a time stands in quotes"},
        {"a = nan\n", "a value cannot be written as JSON"},
        {"a = [\n", "line 1, column 7: "},
    };

    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct reader_line line = {.text = ""};
        json_t *document = reader_toml(cases[i].toml, strlen(cases[i].toml), &line);
        assert_null(document);
        if (strncmp(line.text, cases[i].line, strlen(cases[i].line)) != 0) {
            fail_msg("'%s' is not the beginning of: %s", cases[i].line, line.text);
        }
    }
}

#else
static void this_build_refuses_toml(void **state)
{
    struct reader_line line = {.text = ""};

    (void)state;
    assert_null(reader_toml("", 0, &line));
    assert_string_equal(line.text, "this build cannot read TOML: write the policy in JSON");
}
#endif

static void the_program_needs_a_format(void **state)
{
    static const char *const formats[] = {"xml", "json x y", ""};

    (void)state;
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++) {
        const char *const argv[] = {ISOTHERM_BINARY_DIR "/lib/isotherm/isotherm-policy-reader",
                                    formats[i], NULL};
        struct run run;
        run_start(&run, argv);
        run_finish(&run);
        run_expect(&run, 2);
        assert_string_equal(run.out, "");
        run_free(&run);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hours_of_a_week),
        cmocka_unit_test(past_midnight),
        cmocka_unit_test(a_named_calendar_is_one_schedule),
        cmocka_unit_test(a_calendar_of_holidays_is_a_group),
        cmocka_unit_test(exceptions_are_special_days),
        cmocka_unit_test(cancelled_events_do_not_count),
        cmocka_unit_test(a_zone_for_times_without_one),
        cmocka_unit_test(what_cannot_be_kept),
        cmocka_unit_test(what_is_no_calendar),
#ifdef ISOTHERM_HAS_TOML
        cmocka_unit_test(toml_and_json_are_the_same),
        cmocka_unit_test(toml_that_is_refused),
#else
        cmocka_unit_test(this_build_refuses_toml),
#endif
        cmocka_unit_test(the_program_needs_a_format),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
