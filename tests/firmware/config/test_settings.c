/* The list of the settings in force. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/door/door_io.h"
#include "drivers/sensor/contract/sensor.h"
#include "firmware/config/settings.h"

/* Looks for one setting. */
struct wanted {
    const char *section, *key;
    int found;
    char value[ISO_CONFIG_TEXT_SIZE], standard[ISO_CONFIG_TEXT_SIZE], range[96];
};

static int note_wanted(void *context, const struct iso_setting *setting)
{
    struct wanted *wanted = context;
    if (strcmp(setting->section, wanted->section) == 0 && strcmp(setting->key, wanted->key) == 0) {
        wanted->found++;
        (void)snprintf(wanted->value, sizeof wanted->value, "%s", setting->value);
        (void)snprintf(wanted->standard, sizeof wanted->standard, "%s", setting->standard);
        (void)snprintf(wanted->range, sizeof wanted->range, "%s", setting->range);
    }
    return 0;
}

static struct wanted look(const struct iso_config *config, const char *section, const char *key)
{
    struct wanted wanted = {.section = section, .key = key};
    assert_int_equal(iso_config_visit_settings(config, note_wanted, &wanted), 0);
    return wanted;
}

static struct iso_config parse(const char *text)
{
    struct iso_config config;
    struct iso_fault fault = {.text = ""};
    if (iso_config_parse("test", text, &config, &fault)) {
        fail_msg("%s", fault.text);
    }
    return config;
}

/* ---- completeness ---- */

/* Writes settings as a file. */
struct writer {
    FILE *file;
    char section[32];
    size_t n;
};

static int write_setting(void *context, const struct iso_setting *setting)
{
    struct writer *writer = context;
    if (strcmp(writer->section, setting->section) != 0) {
        (void)snprintf(writer->section, sizeof writer->section, "%s", setting->section);
        fprintf(writer->file, "[%s]\n", setting->section);
    }
    fprintf(writer->file, "%s = %s\n", setting->key, setting->value);
    assert_true(*setting->help);
    writer->n++;
    return 0;
}

static size_t count_options(const struct iso_option_spec *spec)
{
    size_t n = 0;
    for (; spec && spec->name; spec++) {
        n += spec->tools_only ? 0 : 1;
    }
    return n;
}

/* A file that sets every key to the value in force gives the same settings. */
static void expect_the_same_again(const struct iso_config *config)
{
    char *text[2];
    size_t size[2];
    struct iso_config again = *config;
    for (int round = 0; round < 2; round++) {
        struct writer writer = {.file = open_memstream(&text[round], &size[round])};
        assert_non_null(writer.file);
        assert_int_equal(iso_config_visit_settings(&again, write_setting, &writer), 0);
        assert_int_equal(fclose(writer.file), 0);
        assert_int_equal(writer.n, iso_config_n_keys +
                                       count_options(iso_sensor_options(config->sensor.backend)) +
                                       count_options(iso_door_io_options(config->door.backend)));
        again = parse(text[0]);
    }
    assert_string_equal(text[1], text[0]);
    free(text[0]);
    free(text[1]);
}

static void a_file_with_the_settings_gives_them_again(void **state)
{
    (void)state;
    struct iso_config config = iso_config_default();
    expect_the_same_again(&config);
    config = parse("[sensor]\nbackend = v4l2\ndevice = /dev/video3\ncamera = "
                   "/etc/camera.ini\ndistance_min_mm = 312.0625\n"
                   "[door]\nfail = safe\nbackend = null\ninputs = /run/inputs\n"
                   "[match]\ntransform = affine\nadapt = no\ntrim = 0.70000000000000007\n"
                   "[decision]\nlevel = strict\nthreshold = -2.5\n"
                   "[motion]\njump_mm_s = 1000000\n[seal]\ncounter = tpm2\n");
    expect_the_same_again(&config);
}

static void every_default_is_in_force_without_a_file(void **state)
{
    const struct iso_config config = iso_config_default();
    (void)state;
    for (size_t i = 0; i < iso_config_n_keys; i++) {
        const struct iso_config_key *key = &iso_config_keys[i];
        const struct wanted found = look(&config, key->section, key->name);
        assert_int_equal(found.found, 1);
        assert_string_equal(found.value, key->standard);
        assert_string_equal(found.standard, key->standard);
    }
}

/* ---- options of back ends ---- */

static void only_the_options_of_the_chosen_back_end_are_listed(void **state)
{
    (void)state;
    struct iso_config config = parse("[sensor]\nbackend = replay\npath = /srv/frames\n");
    struct wanted found = look(&config, "sensor", "path");
    assert_int_equal(found.found, 1);
    assert_string_equal(found.value, "/srv/frames");
    assert_string_equal(found.standard, "");
    found = look(&config, "sensor", "loop");
    assert_string_equal(found.value, found.standard);
    assert_string_equal(found.range, "no|yes");
    assert_int_equal(look(&config, "sensor", "left").found, 0);
    assert_int_equal(look(&config, "door", "inputs").found, 1);
    config = parse("[sensor]\nbackend = nothing\n");
    assert_int_equal(look(&config, "sensor", "path").found, 0);
    assert_string_equal(look(&config, "sensor", "backend").value, "nothing");
}

static void a_text_that_a_back_end_needs_is_called_required(void **state)
{
    const char *name;
    size_t required = 0;
    (void)state;
    for (size_t i = 0; (name = iso_sensor_registered(i)); i++) {
        struct iso_config config = iso_config_default();
        (void)snprintf(config.sensor.backend, sizeof config.sensor.backend, "%s", name);
        const struct iso_option_spec *spec = iso_sensor_options(name);
        for (; spec && spec->name; spec++) {
            if (spec->required && spec->kind <= ISO_OPTION_LINE) {
                assert_string_equal(look(&config, "sensor", spec->name).range, "required");
                required++;
            }
        }
    }
    assert_true(required > 0);
}

static int end_at_once(void *context, const struct iso_setting *setting)
{
    (void)setting;
    ++*(int *)context;
    return -ECANCELED;
}

static void an_error_of_the_visitor_ends_the_list(void **state)
{
    const struct iso_config config = iso_config_default();
    int n = 0;
    (void)state;
    assert_int_equal(iso_config_visit_settings(&config, end_at_once, &n), -ECANCELED);
    assert_int_equal(n, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_file_with_the_settings_gives_them_again),
        cmocka_unit_test(every_default_is_in_force_without_a_file),
        cmocka_unit_test(only_the_options_of_the_chosen_back_end_are_listed),
        cmocka_unit_test(a_text_that_a_back_end_needs_is_called_required),
        cmocka_unit_test(an_error_of_the_visitor_ends_the_list),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
