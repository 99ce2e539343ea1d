/* isotherm.conf(5) describes every key of the configuration and every option of a back end, with
 * its default and range, and no others. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/door/door_io.h"
#include "drivers/sensor/contract/sensor.h"
#include "firmware/config/config.h"
#include "tests/enroll/rigs/read_text.h"

#define MANUAL ISOTHERM_SOURCE_DIR "/enroll/man/"

static size_t count_of(const char *text, const char *part)
{
    size_t count = 0;

    for (; (text = strstr(text, part)); text += strlen(part)) {
        count++;
    }
    return count;
}

/* Returns the text of a section of isotherm.conf(5), to be freed. */
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

/* Returns the text of an item of a section, up to the next item, to be freed. Fails if there is no
 * such item. */
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

/* Expects a line that begins with the range of the key in the text of its item. */
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
    assert_true(n_options >= 5); /* replay and null exist in every build */
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

/* A build without a back end does not know the options of this back end. */
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_key_stands_in_the_manual_with_its_standard_value),
        cmocka_unit_test(every_option_of_a_back_end_stands_in_the_manual),
        cmocka_unit_test(the_manual_has_no_other_keys),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
