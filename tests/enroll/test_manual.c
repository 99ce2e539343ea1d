/* The manual says what the programs do: every configuration key with its standard value, every
 * option of the command line. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/capture.h"
#include "enroll/cli/arguments/arguments.h"
#include "firmware/config/config.h"
#include "firmware/visit/decision.h"
#include "tests/support/scratch.h"

#define MANUAL ISOTHERM_SOURCE_DIR "/enroll/man/"

/* A file as a string, to be freed. */
static char *read_text(const char *path)
{
    size_t size;
    char *bytes = scratch_read(path, &size);
    char *text = strndup(bytes, size);

    free(bytes);
    assert_non_null(text);
    return text;
}

static size_t count_of(const char *text, const char *part)
{
    size_t count = 0;

    for (; (text = strstr(text, part)); text += strlen(part)) {
        count++;
    }
    return count;
}

/* The text of a section of isotherm.conf(5), to be freed. */
static char *section_of(const char *manual, const char *section)
{
    char heading[64];

    (void)snprintf(heading, sizeof heading, "\n.Ss Section %s\n", section);
    const char *start = strstr(manual, heading);
    if (!start) {
        fail_msg("isotherm.conf(5) has no section %s", section);
    }
    const char *end = strstr(start, "\n.El\n");
    assert_non_null(end);
    return strndup(start, (size_t)(end - start));
}

/* The text of a key, up to the next one, ends with its range. */
static void expect_range(const char *text, const struct iso_config_key *key)
{
    char range[64];
    const char *next = strstr(text, "\n.It ");
    const size_t length = next ? (size_t)(next - text) : strlen(text);

    (void)snprintf(range, sizeof range, "\n%s%.10g to %.10g.", key->min < 0 ? "\\" : "", key->min,
                   key->max);
    if (!memmem(text, length, range, strlen(range))) {
        fail_msg("isotherm.conf(5): the range of %s is%s", key->name, range);
    }
}

static void every_key_stands_in_the_manual_with_its_standard_value(void **state)
{
    char *manual = read_text(MANUAL "isotherm.conf.5"), item[256];

    (void)state;
    for (size_t i = 0; i < iso_config_n_keys; i++) {
        const struct iso_config_key *key = &iso_config_keys[i];
        char *section = section_of(manual, key->section);
        (void)snprintf(item, sizeof item, "\n.It Cm %s =%s%s\n", key->name,
                       key->standard[0] ? " " : "", key->standard);
        if (!strstr(section, item)) {
            fail_msg("isotherm.conf(5), [%s], does not have: %s", key->section, item + 1);
        }
        if (key->min < key->max) {
            expect_range(strstr(section, item) + strlen(item), key);
        }
        free(section);
    }
    assert_int_equal(count_of(manual, "\n.It Cm "), iso_config_n_keys); /* and no others */
    free(manual);
}

/* The help of a command, to be freed. */
static char *help_of(enum cli_verb verb)
{
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);

    assert_non_null(out);
    cli_arguments_help(verb, out);
    assert_int_equal(fclose(out), 0);
    return text;
}

static void every_option_stands_in_the_manual_and_the_completion(void **state)
{
    char *manual = read_text(MANUAL "isotherm.1"), item[64];
    char *completion = read_text(ISOTHERM_SOURCE_DIR "/enroll/completion/isotherm");
    size_t count = 0;

    (void)state;
    for (enum cli_verb verb = CLI_ENROLL; verb <= CLI_VERBS; verb++) {
        char *help = help_of(verb);
        for (const char *at = help; (at = strstr(at, "\n  --")); at++) {
            const char *name = at + strlen("\n  --");
            (void)snprintf(item, sizeof item, "Fl Fl %.*s", (int)strcspn(name, " \n"), name);
            const char *found = strstr(manual, item);
            if (!found || strchr(" \n", found[strlen(item)]) == NULL) {
                fail_msg("isotherm(1) does not have --%s", item + strlen("Fl Fl "));
            }
            (void)snprintf(item, sizeof item, "--%.*s", (int)strcspn(name, " \n"), name);
            if (!strstr(completion, item)) {
                fail_msg("the completion does not have %s", item);
            }
            count++;
        }
        free(help);
    }
    assert_true(count > 20);
    free(completion);
    free(manual);
}

/* Whether a manual page has an entry `.It Li ... word ...`. */
static bool has_entry(const char *manual, const char *word)
{
    const size_t length = strlen(word);

    for (const char *line = manual; (line = strstr(line, "\n.It Li ")); line++) {
        const char *end = strchr(line + 1, '\n');
        for (const char *at = line; (at = strstr(at, word)) && at < end; at++) {
            if (at[-1] == ' ' && (at[length] == ' ' || at[length] == '\n')) {
                return true;
            }
        }
    }
    return false;
}

static void every_word_of_a_frame_and_a_verdict_stands_in_the_manual(void **state)
{
    char *client = read_text(MANUAL "isotherm.1"), *daemon = read_text(MANUAL "isothermd.8");

    (void)state;
    for (int i = 0; i < ISO_CAPTURES; i++) {
        const char *word = iso_capture_name((enum iso_capture)i);
        if (!has_entry(client, word) || !has_entry(daemon, word)) {
            fail_msg("isotherm(1) or isothermd(8) does not have '%s'", word);
        }
    }
    for (int i = ISO_REASON_MATCH; i < ISO_REASONS; i++) {
        const char *word = iso_reason_name((enum iso_reason)i);
        if (!has_entry(daemon, word)) {
            fail_msg("isothermd(8) does not have '%s'", word);
        }
    }
    assert_false(has_entry(client, "face"));
    free(daemon);
    free(client);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_key_stands_in_the_manual_with_its_standard_value),
        cmocka_unit_test(every_option_stands_in_the_manual_and_the_completion),
        cmocka_unit_test(every_word_of_a_frame_and_a_verdict_stands_in_the_manual),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
