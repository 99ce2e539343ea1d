/* The sample configuration that `isothermd --help-config` prints, and the tables of the back ends
 * in it. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "core/match/distance.h"
#include "drivers/door/door_io.h"
#include "drivers/sensor/contract/sensor.h"
#include "firmware/config/config.h"
#include "isotherm/extract.h"
#include "tests/support/memory_text.h"
#include "tests/support/scratch.h"

/* Otherwise the configuration would take such an option for the key. */
static void expect_no_key(const char *section, const char *back_end,
                          const struct iso_option_spec *spec)
{
    for (; spec && spec->name; spec++) {
        for (size_t i = 0; i < iso_config_n_keys; i++) {
            if (strcmp(iso_config_keys[i].section, section) == 0 &&
                strcmp(iso_config_keys[i].name, spec->name) == 0) {
                fail_msg("the option %s of %s is a key of [%s]", spec->name, back_end, section);
            }
        }
    }
}

static void no_option_has_the_name_of_a_key(void **state)
{
    const char *name;
    (void)state;
    for (size_t i = 0; (name = iso_sensor_registered(i)); i++) {
        expect_no_key("sensor", name, iso_sensor_options(name));
    }
    for (size_t i = 0; (name = iso_door_io_registered(i)); i++) {
        expect_no_key("door", name, iso_door_io_options(name));
    }
}

/* ---- the sample ---- */

static char *sample(void)
{
    char *text = NULL;
    size_t size = 0;
    FILE *file = open_memstream(&text, &size);
    assert_non_null(file);
    iso_config_print_sample(file);
    assert_int_equal(fclose(file), 0);
    return memory_text(text);
}

static bool has_every_back_end(void)
{
    static const char *const sensors[] = {"replay", "v4l2", "v4l2-stereo", "libcamera-stereo",
                                          "openni2"};
    bool all = iso_door_io_options("gpiod");
    for (size_t i = 0; i < sizeof sensors / sizeof *sensors; i++) {
        all = all && iso_sensor_options(sensors[i]);
    }
    return all;
}

static void the_sample_of_the_board_is_the_table(void **state)
{
    size_t size = 0;
    char *printed = sample();
    char *committed = scratch_read(ISOTHERM_SOURCE_DIR "/board/generic/isotherm.conf", &size);
    (void)state;
    committed[size] = '\0';
    if (has_every_back_end()) {
        assert_string_equal(committed, printed);
    } else { /* it has each paragraph of this build's sample */
        for (char *at = printed, *end; (end = strstr(at, "\n\n")); at = end + 2) {
            *end = '\0';
            if (!strstr(committed, at)) {
                fail_msg("board/generic/isotherm.conf lacks: %s", at);
            }
        }
    }
    free(committed);
    free(printed);
}

static size_t count_options(const struct iso_option_spec *spec)
{
    size_t n = 0;
    for (; spec && spec->name; spec++) {
        n += spec->tools_only ? 0 : 1;
    }
    return n;
}

static void all_options_of_a_back_end_fit_into_a_configuration(void **state)
{
    const char *name;
    (void)state;
    for (size_t i = 0; (name = iso_sensor_registered(i)); i++) {
        assert_in_range(count_options(iso_sensor_options(name)), 0, ISO_CONFIG_OPTIONS_MAX);
    }
    for (size_t i = 0; (name = iso_door_io_registered(i)); i++) {
        assert_in_range(count_options(iso_door_io_options(name)), 0, ISO_CONFIG_OPTIONS_MAX);
    }
}

static void the_sample_is_sound(void **state)
{
    struct iso_config config;
    char *text = sample();
    (void)state;
    assert_int_equal(iso_config_parse("sample", text, &config, NULL), 0);
    free(text);
}

/* Removes the comment sign from a line "#NAME = VALUE", in the paragraph that begins at `text`. */
static void uncomment(char *text)
{
    for (char *at = text; (at = strchr(at, '\n')) && at[1] && at[1] != '\n'; at++) {
        if (at[1] == '#' && at[2] != ' ') {
            memmove(at + 1, at + 2, strlen(at + 2) + 1);
        }
    }
}

static void expect_sound_with(const char *class, const char *back_end)
{
    struct iso_config config;
    struct iso_fault fault = {.text = ""};
    char *text = sample(), heading[96], line[96];
    (void)snprintf(line, sizeof line, "backend = %s\n", back_end);
    (void)snprintf(heading, sizeof heading, "\n# Options of [%s] with `backend = %s`:\n", class,
                   back_end);
    char *options = strstr(text, heading);
    assert_non_null(options);
    uncomment(options + 1);
    /* The options have to be in their section, after the name of the back end. */
    char *whole = NULL;
    size_t size;
    FILE *file = open_memstream(&whole, &size);
    assert_non_null(file);
    fprintf(file, "[%s]\n%s%s", class, line, options);
    assert_int_equal(fclose(file), 0);
    if (iso_config_parse("sample", whole, &config, &fault)) {
        fail_msg("%s", fault.text);
    }
    free(whole);
    free(text);
}

/* Takes the keys of the appliance, and the options of each back end, out of their comments. */
static void every_line_of_the_sample_may_be_set(void **state)
{
    const struct iso_config otherwise = iso_config_default();
    struct iso_config config;
    struct iso_fault fault = {.text = ""};
    const char *name;
    char *text = sample();
    (void)state;
    for (char *at = text; (at = strstr(at, "\n\n["));) {
        at += 2;
        uncomment(at);
    }
    if (iso_config_parse("sample", text, &config, &fault)) {
        fail_msg("%s", fault.text);
    }
    assert_memory_equal(&config, &otherwise, sizeof config);
    free(text);
    for (size_t i = 0; (name = iso_sensor_registered(i)); i++) {
        expect_sound_with("sensor", name);
    }
    for (size_t i = 0; (name = iso_door_io_registered(i)); i++) {
        expect_sound_with("door", name);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_option_has_the_name_of_a_key),
        cmocka_unit_test(the_sample_of_the_board_is_the_table),
        cmocka_unit_test(the_sample_is_sound),
        cmocka_unit_test(all_options_of_a_back_end_fit_into_a_configuration),
        cmocka_unit_test(every_line_of_the_sample_may_be_set),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
