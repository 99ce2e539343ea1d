/* isotherm log and its options, against a scripted daemon. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/enroll/rigs/cli.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

/* Runs the command. Its document must have n records, and the first and the last must have these
 * numbers. */
static void expect_records_of(const struct fake_script *script, const char *words, size_t n,
                              json_int_t first, json_int_t last)
{
    const struct cli_result result = cli_run(script, words);
    json_t *document = cli_json(&result);
    const json_t *records = json_object_get(document, "records");

    assert_int_equal(json_array_size(records), n);
    assert_int_equal(json_integer_value(json_object_get(json_array_get(records, 0), "sequence")),
                     first);
    assert_int_equal(
        json_integer_value(json_object_get(json_array_get(records, n - 1), "sequence")), last);
    json_decref(document);
}

static void expect_records(const char *words, size_t n, json_int_t first, json_int_t last)
{
    const struct fake_script script = {.n_records = 600};
    expect_records_of(&script, words, n, first, last);
}

/* New records come with every call. The program shows the records that existed when it began, and
 * then ends. Old records are removed; the program shows those that are left. */
static void log_of_a_busy_door_has_an_end(void **state)
{
    const struct fake_script comes = {.n_records = 300, .records_come = 70};
    const struct fake_script goes = {.n_records = 300, .records_come = 70, .records_go = 30};

    (void)state;
    expect_records_of(&comes, "log --json", 20, 281, 300);
    expect_records_of(&comes, "log --json --count 100000", 300, 1, 300);
    expect_records_of(&comes, "log --json --from 290 --count 50", 11, 290, 300);
    expect_records_of(&goes, "log --json --count 100000", 270, 31, 300);
    expect_records_of(&goes, "log --json --from 1", 20, 31, 50);
}

/* A long log takes more calls than a client may make at once. */
static void log_waits_until_it_may_call_again(void **state)
{
    const struct fake_script script = {.n_records = 30, .refused = 2};

    (void)state;
    expect_records_of(&script, "log --json", 20, 11, 30);
}

static void log_shows_the_last_or_those_from_a_number_on(void **state)
{
    (void)state;
    expect_records("log --json", 20, 581, 600);
    expect_records("log --json -n 3", 3, 598, 600);
    expect_records("log --json --count 600", 600, 1, 600);
    expect_records("log --json --from 7 --count 2", 2, 7, 8);
    expect_records("log --json --from 100 --count 400", 400, 100, 499);
    expect_records("log --json --from 599", 2, 599, 600);
    expect_records("log --json --from 1", 20, 1, 20);
}

/* A line has the local time and two digits of a score. Members that only programs need are left
 * out. */
static void log_is_one_line_a_record(void **state)
{
    const struct fake_script script = {.n_records = 2};

    (void)state;
    setenv("TZ", "CET-1", 1);
    assert_string_equal(cli_run(&script, "log").out,
                        "1 2026-11-21 09:30:15 visit verdict=allow person=anna score=2.35 frames=3 "
                        "novelty=true\n"
                        "2 2026-11-21 09:40:15 visit verdict=deny person=\"Bo Ek\" score=2.35 "
                        "frames=3 novelty=true\n");
    setenv("TZ", "UTC", 1);
    assert_string_equal(cli_run(&script, "log --full -n 1").out,
                        "2 2026-11-21 08:40:15 visit verdict=deny person=\"Bo Ek\" "
                        "score=2.3456779999999999 frames=3 monotonic_ns=1234567 novelty=true\n");
}

static void log_shows_what_was_asked_for(void **state)
{
    (void)state;
    expect_records("log --json --person anna", 20, 551, 599);
    expect_records("log --json --person anna --person carl -n 3", 3, 593, 599);
    expect_records("log --json --event door -n 2", 2, 595, 600);
    expect_records("log --json --event attack,door -n 2", 2, 595, 600);
    expect_records("log --json --from 7 --event door -n 3", 3, 10, 20);
    expect_records("log --json --day 2026-11-21", 93, 1, 93);
    expect_records("log --json --day 2026-11-22", 144, 94, 237);
    expect_records("log --json --day 2026-11-22 --event door", 29, 95, 235);
    expect_records("log --json --day 2026-11-22 --person anna --from 200 -n 2", 2, 201, 203);
}

static void log_without_a_matching_record(void **state)
{
    static const char *const words[] = {"log --person carl", "log --event attack",
                                        "log --day 2026-01-01"};
    const struct fake_script script = {.n_records = 600};

    (void)state;
    for (size_t i = 0; i < COUNT(words); i++) {
        const struct cli_result result = cli_run(&script, words[i]);
        cli_expect_exit(&result, 0);
        assert_string_equal(result.out, "");
    }
}

static void log_as_csv(void **state)
{
    const struct fake_script script = {.n_records = 5};

    (void)state;
    assert_string_equal(
        cli_run(&script, "log --csv --from 4").out,
        "sequence,time,event,verdict,person,reason,door,door_fault,score,threshold,frames,"
        "attack_frames,sensor,gallery,before,after,note,grant\n"
        "4,2026-11-21 09:00:15,visit,deny,Bo Ek,,,,2.35,,3,,,,,,,\n"
        "5,2026-11-21 09:10:15,door,,,,,,,,,,,,,,\"locked, by \"\"time\"\"\",\n");
    assert_non_null(strstr(cli_run(&script, "log --csv --full").out, ",note,grant,monotonic_ns\n"));
    const struct cli_result result = cli_run(&script, "log --csv --json");
    cli_expect_error(&result, 2, "usage");
}

/* The door's result for a visitor, and the change of an administrator, are in every form of the
 * output. */
static void log_shows_every_member(void **state)
{
    const struct fake_script visit = {
        .n_records = 1,
        .last_record = "\"event\": \"visit\", \"verdict\": \"allow\", \"person\": \"anna\", "
                       "\"door\": \"not-unlocked\", \"door_fault\": \"line busy\", \"grant\": 41"};
    const struct fake_script rename = {
        .n_records = 1,
        .last_record = "\"event\": \"rename\", \"person\": \"anna\", \"before\": \"anna\", "
                       "\"after\": \"Anna Ek\""};

    (void)state;
    assert_string_equal(cli_run(&visit, "log").out,
                        "1 2026-11-21 08:30:15 visit verdict=allow person=anna door=not-unlocked "
                        "door_fault=\"line busy\" grant=41\n");
    assert_non_null(
        strstr(cli_run(&visit, "log --csv").out,
               "\n1,2026-11-21 08:30:15,visit,allow,anna,,not-unlocked,line busy,,,,,,,,,,"
               "41\n"));
    assert_non_null(strstr(cli_run(&rename, "log --csv --full").out,
                           ",rename,,anna,,,,,,,,,,anna,Anna Ek,,,1234567\n"));
}

/* A name is found in any spelling that the daemon treats as equal: in another case, or with other
 * characters for the same letters. A renamed person is found by both names. */
static void log_finds_a_person_by_any_spelling(void **state)
{
    const struct fake_script visits = {.n_records = 4};
    const struct fake_script rename = {
        .n_records = 1,
        .last_record = "\"event\": \"rename\", \"person\": \"p01\", \"before\": \"p01\", "
                       "\"after\": \"Zo\u00eb \u3392\""};
    static const char *const found[] = {"log --person P01", "log --person \uff3001",
                                        "log --person ZO\u00cb\u00a0mhz",
                                        "log --person zoe\u0308\u00a0MHz"};

    (void)state;
    expect_records_of(&visits, "log --json --person ANNA", 2, 1, 3);
    for (size_t i = 0; i < COUNT(found); i++) {
        if (!strstr(cli_run(&rename, found[i]).out, " rename ")) {
            fail_msg("%s does not find the rename", found[i]);
        }
    }
    assert_string_equal(cli_run(&rename, "log --person p02").out, "");
    assert_string_equal(cli_run(&visits, "log --person ann").out, "");
}

static void log_from_a_record_that_is_not_there(void **state)
{
    const struct fake_script script = {.n_records = 5};
    struct cli_result result = cli_run(&script, "log --from 6 --json");

    (void)state;
    cli_expect_error(&result, 3, "no-such-record");
    result = cli_run(&script, "log --from 6");
    cli_expect_exit(&result, 3);
    assert_string_equal(result.err, "isotherm: there is no record 6: the log ends with 5\n");
}

static void log_of_nothing(void **state)
{
    const struct fake_script script = {0};
    const struct cli_result result = cli_run(&script, "log --json");
    json_t *document = cli_json(&result);

    (void)state;
    assert_int_equal(json_array_size(json_object_get(document, "records")), 0);
    json_decref(document);
}

static void following_the_log_ends_with_an_interrupt(void **state)
{
    const struct fake_script script = {.n_records = 4};
    const struct cli_result result = cli_run_interrupt(&script, "log --follow --json -n 2",
                                                       "\"sequence\":4");

    (void)state;
    cli_expect_exit(&result, 0);
    assert_null(strstr(result.out, "\"sequence\":2"));
    assert_non_null(strstr(result.out, "{\"sequence\":3,"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(log_of_a_busy_door_has_an_end),
        cmocka_unit_test(log_waits_until_it_may_call_again),
        cmocka_unit_test(log_shows_the_last_or_those_from_a_number_on),
        cmocka_unit_test(log_is_one_line_a_record),
        cmocka_unit_test(log_shows_what_was_asked_for),
        cmocka_unit_test(log_without_a_matching_record),
        cmocka_unit_test(log_as_csv),
        cmocka_unit_test(log_shows_every_member),
        cmocka_unit_test(log_finds_a_person_by_any_spelling),
        cmocka_unit_test(log_from_a_record_that_is_not_there),
        cmocka_unit_test(log_of_nothing),
        cmocka_unit_test(following_the_log_ends_with_an_interrupt),
    };

    setenv("TZ", "UTC", 1); /* the programs print local time */
    return cli_find_bus() ? cmocka_run_group_tests(tests, NULL, cli_teardown) : TEST_SKIPPED;
}
