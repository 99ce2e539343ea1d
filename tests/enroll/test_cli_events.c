/* isotherm log knows every event and every member of a record that the daemon writes, and no
 * others. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <glob.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "firmware/contract/contract.h"
#include "tests/enroll/rigs/cli.h"
#include "tests/enroll/rigs/read_text.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

/* Whether the first line of `names`, which has commas between the names, has this name. */
static bool has_column(const char *names, const char *name)
{
    const size_t length = strlen(name);

    for (const char *at = names; *at && *at != '\n'; at += *at == ',') {
        if (strcspn(at, ",\n") == length && strncmp(at, name, length) == 0) {
            return true;
        }
        at += strcspn(at, ",\n");
    }
    return false;
}

/* The CSV output has a column for every member that the daemon writes. */
static void csv_has_a_column_for_every_member_that_the_daemon_writes(void **state)
{
    static const char call[] = "(line, \"";
    const struct fake_script script = {.n_records = 1};
    size_t n = 0;
    char *source = read_text(ISOTHERM_SOURCE_DIR "/firmware/audit/audit_append.c"), name[64];
    const struct cli_result result = cli_run(&script, "log --csv --full");

    (void)state;
    for (const char *at = source; (at = strstr(at, call)); n++) {
        at += strlen(call);
        (void)snprintf(name, sizeof name, "%.*s", (int)strcspn(at, "\""), at);
        if (!has_column(result.out, name)) {
            fail_msg("log --csv --full has no column for %s", name);
        }
    }
    assert_true(n >= 18);
    free(source);
}

/* A word that is not an event would print nothing, as if nothing had happened. */
static void an_unknown_event_is_a_usage_error(void **state)
{
    static const struct {
        const char *words, *says;
    } cases[] = {
        {"log --event vist", "unknown event 'vist': did you mean 'visit'?"},
        {"log --event visit,dor", "unknown event 'dor': did you mean 'door'?"},
        {"log --event xyzzy", "unknown event 'xyzzy' (isotherm(1) lists the events)"},
        {"log --event ,", "an event is missing in ','"},
        {"log --event visit,", "an event is missing in 'visit,'"},
    };
    const struct fake_script script = {.n_records = 5};

    (void)state;
    for (size_t i = 0; i < COUNT(cases); i++) {
        const struct cli_result result = cli_run(&script, cases[i].words);
        cli_expect_exit(&result, 2);
        if (!strstr(result.err, cases[i].says)) {
            fail_msg("%s says: %s", cases[i].words, result.err);
        }
    }
}

static const char *const known_events[] = {ISO_CONTRACT_EVENTS};

static bool is_known(const char *word)
{
    bool known = false;

    for (size_t i = 0; i < COUNT(known_events); i++) {
        known |= strcmp(word, known_events[i]) == 0;
    }
    return known;
}

/* Checks that every event which the source passes to a call is known. `call` ends with the quote.
 * Returns the number of these calls. */
static size_t expect_known(const char *path, const char *source, const char *call)
{
    char word[64];
    size_t n = 0;

    for (const char *at = source; (at = strstr(at, call)); n++) {
        at += strlen(call);
        (void)snprintf(word, sizeof word, "%.*s", (int)strcspn(at, "\""), at);
        if (!is_known(word)) {
            fail_msg("%s records the event %s, which firmware/contract/log_events.h does not name",
                     path, word);
        }
    }
    return n;
}

/* Reads all source files of the daemon. Every known event is a string in one of them. */
static void the_daemon_records_the_events_that_are_known(void **state)
{
    static const char *const calls[] = {
        "iso_audit_record_of(\"",   "record.event = \"",        "announce(appliance, \"",
        "conclude(appliance, \"",   "record_act(appliance, \"", "record_gallery(appliance, \"",
        " record_of(appliance, \"",
    };
    bool found[COUNT(known_events)] = {false};
    glob_t files;
    size_t n = 0;

    (void)state;
    assert_int_equal(glob(ISOTHERM_SOURCE_DIR "/firmware/*/*.c", 0, NULL, &files), 0);
    assert_int_equal(glob(ISOTHERM_SOURCE_DIR "/firmware/*/*/*.c", GLOB_APPEND, NULL, &files), 0);
    for (size_t i = 0; i < files.gl_pathc; i++) {
        char *source = read_text(files.gl_pathv[i]), word[64];
        for (size_t j = 0; j < COUNT(calls); j++) {
            n += expect_known(files.gl_pathv[i], source, calls[j]);
        }
        for (size_t j = 0; j < COUNT(known_events); j++) {
            (void)snprintf(word, sizeof word, "\"%s\"", known_events[j]);
            found[j] |= strstr(source, word) != NULL;
        }
        free(source);
    }
    globfree(&files);
    for (size_t j = 0; j < COUNT(known_events); j++) {
        if (!found[j]) {
            fail_msg("the daemon never records the event %s", known_events[j]);
        }
    }
    assert_true(n >= 30);
}

/* Both texts list the events between blanks, commas or quotes. */
static void manual_and_completion_have_every_event(void **state)
{
    static const struct {
        const char *path, *from, *to;
    } lists[] = {
        {ISOTHERM_SOURCE_DIR "/enroll/man/isotherm.1", "\nThe events are\n", "\nA word"},
        {ISOTHERM_SOURCE_DIR "/enroll/completion/isotherm", "local events=", "local verb"},
    };

    (void)state;
    for (size_t i = 0; i < COUNT(lists); i++) {
        char *text = read_text(lists[i].path), *list = strstr(text, lists[i].from);
        assert_non_null(list);
        char *end = strstr(list, lists[i].to), *rest = NULL;
        assert_non_null(end);
        *end = '\0';
        size_t n = 0;
        for (char *word = strtok_r(list + strlen(lists[i].from), " ,.'\n", &rest); word;
             word = strtok_r(NULL, " ,.'\n", &rest)) {
            n += is_known(word);
        }
        assert_int_equal(n, COUNT(known_events));
        free(text);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(csv_has_a_column_for_every_member_that_the_daemon_writes),
        cmocka_unit_test(an_unknown_event_is_a_usage_error),
        cmocka_unit_test(the_daemon_records_the_events_that_are_known),
        cmocka_unit_test(manual_and_completion_have_every_event),
    };

    setenv("TZ", "UTC", 1); /* the programs print local time */
    return cli_find_bus() ? cmocka_run_group_tests(tests, NULL, cli_teardown) : TEST_SKIPPED;
}
