/* The manuals describe every option of the command line, every word and code that the programs
 * print, and every fault with its remedy. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <ftw.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/fault_code.h"
#include "enroll/cli/arguments/arguments.h"
#include "enroll/cli/doctor/remedy.h"
#include "firmware/visit/decision.h"
#include "tests/enroll/rigs/read_text.h"

#define MANUAL ISOTHERM_SOURCE_DIR "/enroll/man/"

/* Returns the help of a command, to be freed. */
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

/* Whether a text has an item that ends there, unlike --all in --allow-duplicate. */
static bool has_whole(const char *text, const char *item)
{
    for (const char *at = text; (at = strstr(at, item)); at++) {
        const char after = at[strlen(item)];
        if (after && strchr(" \n')", after)) {
            return true;
        }
    }
    return false;
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
            if (!has_whole(manual, item)) {
                fail_msg("isotherm(1) does not have --%s", item + strlen("Fl Fl "));
            }
            (void)snprintf(item, sizeof item, "--%.*s", (int)strcspn(name, " \n"), name);
            if (!has_whole(completion, item)) {
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

/* ---- faults ---- */

/* Appends words with single blanks between them. */
static void add_words(char *to, size_t size, const char *from)
{
    size_t used = strlen(to);
    for (; *from && used + 2 < size; from++) {
        const bool blank = *from == ' ' || *from == '\n';
        if (!blank || (used > 0 && to[used - 1] != ' ')) {
            to[used++] = blank ? ' ' : *from;
        }
    }
    to[used] = '\0';
}

/* The table of the section FAULTS has every code with its meaning and its remedy, in the order of
 * the list, and no others. */
static void every_fault_stands_in_the_manual_with_its_remedy(void **state)
{
    char *manual = read_text(MANUAL "isothermd.8");
    char *begin = strstr(manual, "\n.Sh FAULTS\n"), *at = begin;
    char *end = begin ? strstr(begin, "\n.El\n") : NULL;

    (void)state;
    assert_non_null(end);
    end[1] = '\0';
    for (enum iso_fault_code code = ISO_FAULT_NONE + 1; code < ISO_FAULT_CODES; code++) {
        char expected[640] = "", found[640] = "";
        at = strstr(at + 1, "\n.It Li ");
        if (!at) {
            fail_msg("isothermd(8), FAULTS, does not have %s", iso_fault_code_name(code));
        }
        char *next = strstr(at + 1, "\n.It Li ");
        (void)snprintf(expected, sizeof expected,
                       ".It Li %s %s Remedy: ", iso_fault_code_name(code),
                       iso_fault_code_meaning(code));
        add_words(expected, sizeof expected, cli_remedy(code));
        char *part = strndup(at + 1, next ? (size_t)(next - at - 1) : strlen(at + 1));
        assert_non_null(part);
        add_words(found, sizeof found, part);
        free(part);
        found[strlen(found) - (found[strlen(found) - 1] == ' ')] = '\0';
        const size_t length = strlen(expected);
        const char *rest = found + length;
        if (strncmp(found, expected, length) != 0 || (*rest && strcmp(rest, ".") != 0)) {
            fail_msg("isothermd(8), FAULTS, has '%s' instead of '%s'", found, expected);
        }
    }
    assert_null(strstr(at + 1, "\n.It Li "));
    free(manual);
}

/* ---- JSON ---- */

static char *json_section; /* of isotherm(1) */
static size_t n_codes;

static void expect_in_json_section(const char *word, size_t length, const char *source)
{
    char item[64];
    (void)snprintf(item, sizeof item, "\n.Li %.*s", (int)length, word);
    for (const char *at = json_section; (at = strstr(at, item)); at++) {
        if (strchr(" \n", at[strlen(item)])) {
            n_codes++;
            return;
        }
    }
    (void)snprintf(item, sizeof item, "\"%.*s\":", (int)length, word); /* in the example */
    if (strstr(json_section, item)) {
        return;
    }
    fail_msg("isotherm(1), JSON, does not have '%.*s' of %s", (int)length, word, source);
}

/* The code of every fault that a source sets is the first text in the call. */
static void look_for_codes(const char *text, const char *source)
{
    for (const char *at = text; (at = strstr(at, "cli_fault_set(")); at++) {
        const char *end = strchr(at, ';'), *code = strchr(at, '"');
        if (end && code && code < end &&
            code[1] != '%') { /* otherwise the code comes from a table */
            expect_in_json_section(code + 1, strcspn(code + 1, "\""), source);
        }
    }
    for (const char *at = text; (at = strstr(at, "CLI_EXIT_")); at++) {
        const char *code = at + strcspn(at, ", ;)\n");
        if (strncmp(code, ", \"", 3) == 0) {
            const size_t length = strcspn(code + 3, "\"");
            if (strspn(code + 3, "abcdefghijklmnopqrstuvwxyz-") == length) {
                expect_in_json_section(code + 3, length, source);
            }
        }
    }
    /* The keys of the documents: json_pack("{s:s, ...}", "person", ...). */
    for (const char *at = text; (at = strstr(at, "json_pack(")); at++) {
        const char *end = strstr(at, ";\n"), *key = strchr(at, '"');
        bool format = true;
        while (key && key < end) {
            const size_t length = strcspn(key + 1, "\"");
            if (!format && length > 0) {
                expect_in_json_section(key + 1, length, source);
            }
            format = false;
            key = strchr(key + length + 2, '"');
        }
    }
}

static int look_into(const char *path, const struct stat *status, int kind, struct FTW *walk)
{
    const char *ending = strrchr(path + walk->base, '.');
    (void)status;
    if (kind == FTW_F && ending && strcmp(ending, ".c") == 0) {
        char *text = read_text(path);
        look_for_codes(text, path + walk->base);
        free(text);
    }
    return 0;
}

static void every_code_and_member_of_a_document_stands_in_the_manual(void **state)
{
    char *manual = read_text(MANUAL "isotherm.1");

    (void)state;
    json_section = strstr(manual, "\n.Sh JSON\n");
    assert_non_null(json_section);
    *strstr(json_section, "\n.Sh EXAMPLES\n") = '\0';
    n_codes = 0;
    assert_int_equal(nftw(ISOTHERM_SOURCE_DIR "/enroll/cli", look_into, 16, FTW_PHYS), 0);
    assert_true(n_codes > 100);
    free(manual);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_option_stands_in_the_manual_and_the_completion),
        cmocka_unit_test(every_word_of_a_frame_and_a_verdict_stands_in_the_manual),
        cmocka_unit_test(every_fault_stands_in_the_manual_with_its_remedy),
        cmocka_unit_test(every_code_and_member_of_a_document_stands_in_the_manual),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
