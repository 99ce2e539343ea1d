/* The manual says what the programs do: every configuration key with its standard value, every
 * option of the command line. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/capture.h"
#include "core/base/fault_code.h"
#include "drivers/door/door_io.h"
#include "drivers/sensor/contract/sensor.h"
#include "enroll/cli/arguments/arguments.h"
#include "enroll/cli/doctor/remedy.h"
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

/* The text of an item of a section, up to the next one, to be freed. Fails without one. */
static char *item_of(const char *section_name, const char *section, const char *name,
                     const char *standard)
{
    char item[256];

    (void)snprintf(item, sizeof item, "\n.It Cm %s =%s%s\n", name, *standard ? " " : "", standard);
    const char *start = strstr(section, item);
    if (!start) {
        fail_msg("isotherm.conf(5), [%s], does not have: %s", section_name, item + 1);
    }
    start += strlen(item) - 1;
    const char *next = strstr(start, "\n.It ");
    return next ? strndup(start, (size_t)(next + 1 - start)) : strdup(start);
}

/* The text of a key ends with its range. */
static void expect_range(const char *text, const char *name, double min, double max)
{
    char range[64];

    (void)snprintf(range, sizeof range, "\n%s%.10g to %.10g.", min < 0 ? "\\" : "", min, max);
    if (!strstr(text, range)) {
        fail_msg("isotherm.conf(5): the range of %s is%s", name, range);
    }
}

static void every_key_stands_in_the_manual_with_its_standard_value(void **state)
{
    char *manual = read_text(MANUAL "isotherm.conf.5");

    (void)state;
    for (size_t i = 0; i < iso_config_n_keys; i++) {
        const struct iso_config_key *key = &iso_config_keys[i];
        char *section = section_of(manual, key->section);
        char *text = item_of(key->section, section, key->name, key->standard);
        if (key->min < key->max) {
            expect_range(text, key->name, key->min, key->max);
        }
        free(text);
        free(section);
    }
    free(manual);
}

/* ---- the options of the back ends ---- */

static bool is_word(const char *text, const char *found, size_t length)
{
    static const char letters[] = "abcdefghijklmnopqrstuvwxyz0123456789_-";

    return (found == text || !strchr(letters, found[-1])) &&
           (!found[length] || !strchr(letters, found[length]));
}

static bool has_word(const char *text, const char *word, size_t length)
{
    for (const char *at = text; (at = memmem(at, strlen(at), word, length)); at++) {
        if (is_word(text, at, length)) {
            return true;
        }
    }
    return false;
}

static void expect_option(const char *section_name, const char *section, const char *back_end,
                          const struct iso_option_spec *spec)
{
    char *text = item_of(section_name, section, spec->name, spec->required ? "" : spec->standard);

    if (!has_word(text, back_end, strlen(back_end))) {
        fail_msg("isotherm.conf(5): the text of %s does not name %s", spec->name, back_end);
    }
    if (spec->min < spec->max) {
        expect_range(text, spec->name, spec->min, spec->max);
    }
    for (const char *word = spec->choices; word && *word; word += *word == '|') {
        const size_t length = strcspn(word, "|");
        if (!has_word(text, word, length)) {
            fail_msg("isotherm.conf(5): the text of %s lacks %.*s", spec->name, (int)length, word);
        }
        word += length;
    }
    free(text);
}

/* A section and the registry of its back ends. */
struct class
{
    const char *section;
    const char *(*registered)(size_t i);
    const struct iso_option_spec *(*options)(const char *back_end);
};

static const struct class classes[] = {
    {"sensor", iso_sensor_registered, iso_sensor_options},
    {"door", iso_door_io_registered, iso_door_io_options},
};

static void every_option_of_a_back_end_stands_in_the_manual(void **state)
{
    char *manual = read_text(MANUAL "isotherm.conf.5");
    size_t n_options = 0;
    const char *name;

    (void)state;
    for (size_t c = 0; c < sizeof classes / sizeof *classes; c++) {
        char *section = section_of(manual, classes[c].section);
        for (size_t i = 0; (name = classes[c].registered(i)); i++) {
            const struct iso_option_spec *spec = classes[c].options(name);
            for (; spec && spec->name; spec++) {
                n_options++;
                if (!spec->tools_only) {
                    expect_option(classes[c].section, section, name, spec);
                }
            }
        }
        free(section);
    }
    assert_true(n_options >= 5); /* those of replay and null are always there */
    free(manual);
}

static bool is_option(const struct class *class, const char *key)
{
    const char *name;

    for (size_t i = 0; (name = class->registered(i)); i++) {
        const struct iso_option_spec *spec = iso_option_find_spec(class->options(name), key);
        if (spec && !spec->tools_only) {
            return true;
        }
    }
    return false;
}

static bool is_key(const char *section, const char *key)
{
    for (size_t i = 0; i < iso_config_n_keys; i++) {
        if (strcmp(iso_config_keys[i].section, section) == 0 &&
            strcmp(iso_config_keys[i].name, key) == 0) {
            return true;
        }
    }
    for (size_t c = 0; c < sizeof classes / sizeof *classes; c++) {
        if (strcmp(classes[c].section, section) == 0) {
            return is_option(&classes[c], key);
        }
    }
    return false;
}

/* A build that lacks a back end does not know its options. */
static bool has_every_back_end(void)
{
    return iso_sensor_options("v4l2") && iso_sensor_options("v4l2-stereo") &&
           iso_sensor_options("openni2") && iso_door_io_options("gpiod");
}

static void the_manual_has_no_other_keys(void **state)
{
    static const char item[] = "\n.It Cm ";
    char *manual = read_text(MANUAL "isotherm.conf.5");
    const char *previous = "";

    (void)state;
    if (!has_every_back_end()) {
        free(manual);
        skip();
    }
    for (size_t i = 0; i < iso_config_n_keys; i++) {
        const char *name = iso_config_keys[i].section;
        if (strcmp(name, previous) == 0) {
            continue;
        }
        char *section = section_of(manual, name);
        for (char *at = section; (at = strstr(at, item));) {
            char key[64], whole[96];
            at += strlen(item);
            (void)snprintf(key, sizeof key, "%.*s", (int)strcspn(at, " "), at);
            (void)snprintf(whole, sizeof whole, "%s%s =", item, key);
            if (!is_key(name, key)) {
                fail_msg("isotherm.conf(5): [%s] has no key %s", name, key);
            }
            assert_int_equal(count_of(section, whole), 1);
        }
        free(section);
        previous = name;
    }
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

/* The table of section FAULTS has every code in the order of the list, what it means and its
 * remedy, and no others. */
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

/* The code of every fault that a source sets: the first text in the call. */
static void look_for_codes(const char *text, const char *source)
{
    for (const char *at = text; (at = strstr(at, "cli_fault_set(")); at++) {
        const char *end = strchr(at, ';'), *code = strchr(at, '"');
        if (end && code && code < end && code[1] != '%') { /* else it comes from a table */
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
        cmocka_unit_test(every_key_stands_in_the_manual_with_its_standard_value),
        cmocka_unit_test(every_option_of_a_back_end_stands_in_the_manual),
        cmocka_unit_test(the_manual_has_no_other_keys),
        cmocka_unit_test(every_option_stands_in_the_manual_and_the_completion),
        cmocka_unit_test(every_word_of_a_frame_and_a_verdict_stands_in_the_manual),
        cmocka_unit_test(every_fault_stands_in_the_manual_with_its_remedy),
        cmocka_unit_test(every_code_and_member_of_a_document_stands_in_the_manual),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
