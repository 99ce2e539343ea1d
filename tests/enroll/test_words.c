/* Functions for hints, points in time, and the command line. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "enroll/cli/arguments/arguments.h"
#include "enroll/cli/arguments/command_table.h"
#include "enroll/cli/arguments/option_table.h"
#include "enroll/cli/arguments/when.h"
#include "enroll/cli/text/hint.h"
#include "isotherm/capture.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

static void every_capture_word_has_a_hint_of_its_own(void **state)
{
    (void)state;
    for (int i = 0; i < ISO_CAPTURES; i++) {
        const char *text = cli_hint_text(iso_capture_name((enum iso_capture)i));
        assert_non_null(text);
        for (int j = 0; j < i; j++) {
            assert_string_not_equal(text, cli_hint_text(iso_capture_name((enum iso_capture)j)));
        }
    }
    assert_string_equal(cli_hint_text("turn-left"), "turn a little to your left");
    assert_string_equal(cli_hint_text("turn-right"), "turn a little to your right");
    assert_null(cli_hint_text("too-blue"));
    assert_null(cli_hint_text(""));
}

static void a_retry_is_recognised_by_its_prefix(void **state)
{
    const char *word = "untouched";

    (void)state;
    assert_false(cli_hint_is_retry("enroll-retry-too-far", "verify", &word));
    assert_false(cli_hint_is_retry("enroll-stage-passed", "enroll", &word));
    assert_string_equal(word, "untouched");
    assert_true(cli_hint_is_retry("enroll-retry-too-far", "enroll", &word));
    assert_string_equal(word, "too-far");
}

static void dates_are_read(void **state)
{
    static const struct {
        const char *text;
        bool end_of_day;
        int64_t unix_s;
    } cases[] = {
        {"2026-11-21Z", false, 1795219200},
        {"2026-11-21Z", true, 1795305599},
        {"2026-11-21T08:30Z", true, 1795249800},
        {"2026-11-21 08:30:15Z", false, 1795249815},
        {"@1795248000", true, 1795248000},
        {"2026-11-21T08:30", false, 1795246200}, /* an hour east of Greenwich */
        {"2028-02-29Z", false, 1835395200},
    };

    (void)state;
    for (size_t i = 0; i < COUNT(cases); i++) {
        int64_t unix_s = 0;
        assert_true(cli_when_parse(cases[i].text, cases[i].end_of_day, &unix_s));
        assert_int_equal(unix_s, cases[i].unix_s);
    }
}

static void texts_that_are_no_date_are_refused(void **state)
{
    static const char *const texts[] = {"",
                                        "tomorrow",
                                        "2026-13-01",
                                        "2026-02-30",
                                        "2027-02-29",
                                        "2026-11-21T",
                                        "2026-11-21T8",
                                        "2026-11-21x",
                                        "1960-01-01",
                                        "@",
                                        "@-1",
                                        "@12x",
                                        "@0",
                                        "@ 1",
                                        "2026-11-21T25:00"};

    (void)state;
    for (size_t i = 0; i < COUNT(texts); i++) {
        int64_t unix_s = 42;
        if (cli_when_parse(texts[i], false, &unix_s)) {
            fail_msg("'%s' was read as %lld", texts[i], (long long)unix_s);
        }
        assert_int_equal(unix_s, 42);
    }
}

/* An hour east of Greenwich the day begins an hour earlier. */
static void days_are_read(void **state)
{
    static const struct {
        const char *text;
        int64_t now_s, begins_s, ends_s;
    } cases[] = {
        {"2026-11-22", 0, 1795302000, 1795388400},
        {"today", 1795302000, 1795302000, 1795388400},
        {"today", 1795388399, 1795302000, 1795388400},
        {"yesterday", 1795388400, 1795302000, 1795388400},
        {"yesterday", 1796079600, 1795993200, 1796079600}, /* 1 December: 30 November */
    };
    static const char *const none[] = {"", "tomorrow", "2026-11-22x", "2026-02-30",
                                       "2026-11-22T10:00"};
    int64_t begins_s = 7, ends_s = 8;

    (void)state;
    for (size_t i = 0; i < COUNT(none); i++) {
        assert_false(cli_when_parse_day(none[i], 1795302000, &begins_s, &ends_s));
        assert_true(begins_s == 7 && ends_s == 8);
    }
    for (size_t i = 0; i < COUNT(cases); i++) {
        assert_true(cli_when_parse_day(cases[i].text, cases[i].now_s, &begins_s, &ends_s));
        assert_int_equal(begins_s, cases[i].begins_s);
        assert_int_equal(ends_s, cases[i].ends_s);
    }
}

static void dates_are_written(void **state)
{
    char text[CLI_WHEN_SIZE];

    (void)state;
    cli_when_format_second(1795249815, text);
    assert_string_equal(text, "2026-11-21 09:30:15");
    cli_when_format(1795249815, text);
    assert_string_equal(text, "2026-11-21 09:30");
    cli_when_format(0, text);
    assert_string_equal(text, "-");
}

/* Parses a line of words. The program's name is put before them. */
static enum cli_exit parse_line(const char *line, struct cli_arguments *out,
                                struct cli_fault *fault)
{
    static char copy[256];
    char *argv[16] = {(char[]){"isotherm"}};
    int argc = 1;

    (void)snprintf(copy, sizeof copy, "%s", line);
    for (char *word = strtok(copy, " "); word; word = strtok(NULL, " ")) {
        argv[argc++] = word;
    }
    *fault = (struct cli_fault){0};
    return cli_arguments_parse(argc, argv, out, fault);
}

static void options_stand_anywhere(void **state)
{
    static const char *const lines[] = {"--json --timeout 2.5 --bus x verify anna",
                                        "verify --json anna --timeout=2.5 --bus=x",
                                        "verify anna --bus x --json --timeout 2.5"};
    struct cli_arguments arguments;
    struct cli_fault fault;

    (void)state;
    for (size_t i = 0; i < COUNT(lines); i++) {
        assert_int_equal(parse_line(lines[i], &arguments, &fault), CLI_EXIT_OK);
        assert_int_equal(arguments.verb, CLI_VERIFY);
        assert_string_equal(arguments.person, "anna");
        assert_string_equal(arguments.bus.address, "x");
        assert_true(arguments.json);
        assert_true(arguments.timeout_s == 2.5);
    }
    assert_int_equal(parse_line("log -n 7 --follow --from 9", &arguments, &fault), CLI_EXIT_OK);
    assert_int_equal(arguments.count, 7);
    assert_int_equal(arguments.from, 9);
    assert_true(arguments.follow);
    assert_int_equal(parse_line("verify -- --json", &arguments, &fault), CLI_EXIT_OK);
    assert_string_equal(arguments.person, "--json");
    assert_false(arguments.json);
}

/* A wrong command line, and a part of the fault. */
static const struct {
    const char *line, *text;
} wrong_lines[] = {
    {"", "no command"},
    {"dance", "unknown command 'dance'"},
    {"enroll", "a NAME is missing after 'enroll'"},
    {"lockout", "'lockout' needs a word: clear"},
    {"door", "'door' needs a word: test"},
    {"lockdown", "'lockdown' needs a word: on or off"},
    {"key", "'key' needs a word: rotate or address"},
    {"help lgo", "unknown command 'lgo': did you mean 'log'?"},
    {"rename", "a word is missing after 'rename'"},
    {"rename anna", "a word is missing after 'anna'"},
    {"rename anna bob carl", "superfluous word 'carl'"},
    {"validity anna", "validity takes --from, --until or --none"},
    {"validity anna --none --until 2026-12-01", "give --none, or --from and --until, not both"},
    {"validity anna --from 17", "--from: bad value '17'"},
    {"validity anna --from 2026-12-02 --until 2026-12-01", "--until is not after --from"},
    {"log --until 2026-12-01", "log takes no --until"},
    {"log --from 2026-12-01", "--from: bad value '2026-12-01'"},
    {"list anna", "superfluous word 'anna'"},
    {"verify anna bob", "superfluous word 'bob'"},
    {"list --loud", "'--loud'"},
    {"list -q", "'-q'"},
    {"list --json=1", "'--json=1'"},
    {"verify anna --timeout", "a value is missing after '--timeout'"},
    {"list --timeout 3", "list takes no --timeout"},
    {"identify --allow-duplicate", "identify takes no --allow-duplicate"},
    {"identify --timeout 0", "--timeout: bad value '0'"},
    {"identify --timeout -1", "--timeout: bad value '-1'"},
    {"identify --timeout nan", "--timeout: bad value 'nan'"},
    {"identify --timeout 3s", "--timeout: bad value '3s'"},
    {"log --count 0", "--count: bad value '0'"},
    {"log -n x", "--count: bad value 'x'"},
    {"log --from -3", "--from: bad value '-3'"},
    {"enroll a --valid-from 2026-02-30", "--valid-from: bad value '2026-02-30'"},
    {"enroll a --valid-from 2026-12-02 --valid-until 2026-12-01", "--valid-until is not after"},
    {"list --session --bus x", "--bus or --session"},
    {"lsit", "unknown command 'lsit': did you mean 'list'?"},
    {"identfy", "did you mean 'identify'?"},
    {"log --folow", "unknown option '--folow': did you mean '--follow'?"},
    {"enroll a --valid-form 2026-12-01", "did you mean '--valid-from'?"},
    {"enroll a --valid-from tomorrow", "a time looks like 2026-12-31, 2026-12-31T18:00"},
    {"enroll a --valid-until 31.12.2026", "--valid-until: bad value '31.12.2026'; a time looks"},
    {"log --day monday", "--day: bad value 'monday'; a day looks like 2026-12-31, today"},
    {"log --csv --json", "--csv or --json"},
};

static void faults_of_the_command_line_are_named(void **state)
{
    struct cli_arguments arguments;
    struct cli_fault fault;

    (void)state;
    for (size_t i = 0; i < COUNT(wrong_lines); i++) {
        assert_int_equal(parse_line(wrong_lines[i].line, &arguments, &fault), CLI_EXIT_USAGE);
        assert_string_equal(fault.code, "usage");
        if (!strstr(fault.text, wrong_lines[i].text)) {
            fail_msg("'%s': '%s' is not in '%s'", wrong_lines[i].line, wrong_lines[i].text,
                     fault.text);
        }
    }
}

/* The help of every command, and of the program, fits on a terminal. The help of an option
 * describes this command only. */
static void help_fits_a_terminal(void **state)
{
    (void)state;
    for (int verb = 0; verb <= CLI_VERBS; verb++) {
        char *text = NULL;
        size_t size = 0;
        FILE *out = open_memstream(&text, &size);
        assert_non_null(out);
        cli_arguments_help((enum cli_verb)verb, out);
        assert_int_equal(fclose(out), 0);
        for (const char *line = text; *line; line += strcspn(line, "\n") + 1) {
            const int length = (int)strcspn(line, "\n");
            if (length > 80) {
                fail_msg("%d columns: %.*s", length, length, line);
            }
        }
        assert_null(strstr(text, " validity: "));
        assert_null(strstr(text, " aim: "));
        assert_null(strstr(text, " import: "));
        assert_true((verb == CLI_LOG) == (strstr(text, "begin at record N") != NULL));
        free(text);
    }
}

/* The enumerations and the tables are written separately. No row is missing, and each option has a
 * help text for each of its commands. */
static void every_command_and_option_has_its_row(void **state)
{
    (void)state;
    for (size_t i = 0; i < CLI_VERBS; i++) {
        assert_non_null(cli_commands[i].name);
        assert_non_null(cli_commands[i].words);
        assert_non_null(cli_commands[i].summary);
    }
    for (size_t i = 0; i < CLI_OPTIONS; i++) {
        const struct cli_option *option = &cli_options[i];
        unsigned told = 0;
        assert_non_null(option->name);
        assert_true((option->help != NULL) != (option->parts != NULL));
        for (const struct cli_option_help *part = option->parts; part && part->text; part++) {
            told |= CLI_FOR(part->verb);
        }
        assert_true(option->help || told == option->verbs);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(help_fits_a_terminal),
        cmocka_unit_test(every_capture_word_has_a_hint_of_its_own),
        cmocka_unit_test(a_retry_is_recognised_by_its_prefix),
        cmocka_unit_test(dates_are_read),
        cmocka_unit_test(texts_that_are_no_date_are_refused),
        cmocka_unit_test(days_are_read),
        cmocka_unit_test(dates_are_written),
        cmocka_unit_test(options_stand_anywhere),
        cmocka_unit_test(faults_of_the_command_line_are_named),
        cmocka_unit_test(every_command_and_option_has_its_row),
    };

    setenv("TZ", "CET-1", 1);
    tzset();
    return cmocka_run_group_tests(tests, NULL, NULL);
}
