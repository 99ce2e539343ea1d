/* The configurations of the boards. They are valid, their lines are what the back end reads, and
 * they agree with the tables of board/README.md. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/door/door_io.h"
#include "drivers/door/gpio_line.h"
#include "drivers/sensor/contract/sensor.h"
#include "firmware/config/config.h"
#include "tests/support/scratch.h"

#define BOARDS ISOTHERM_SOURCE_DIR "/board/"

static const char *const boards[] = {"pc-usb", "raspberry-pi-5", "rock-5b", "qemu"};

enum { N_BOARDS = sizeof boards / sizeof *boards };

static const char *path_of(const char *board, const char *file)
{
    static char path[512];
    (void)snprintf(path, sizeof path, BOARDS "%s/%s", board, file);
    return path;
}

static struct iso_config load(const char *board)
{
    struct iso_config config;
    struct iso_fault fault = {.text = ""};
    if (iso_config_load(path_of(board, "isotherm.conf"), &config, &fault)) {
        fail_msg("%s", fault.text);
    }
    assert_string_equal(config.door.backend, "gpiod");
    return config;
}

static char *read_text(const char *path)
{
    size_t size = 0;
    char *text = scratch_read(path, &size);
    text[size] = '\0';
    return text;
}

static bool is_line(const char *key)
{
    return iso_option_find_spec(iso_door_io_options("gpiod"), key)->kind == ISO_OPTION_LINE;
}

/* A build without GPIO lines does not know their options. */
static void skip_without_gpiod(void)
{
    if (!iso_door_io_options("gpiod")) {
        skip();
    }
}

/* Asserts that all lines of a board are valid and different. */
static void all_lines_of_a_board_are_valid_and_different(void **state)
{
    (void)state;
    skip_without_gpiod();
    for (int b = 0; b < N_BOARDS; b++) {
        const struct iso_config config = load(boards[b]);
        struct iso_option options[ISO_CONFIG_OPTIONS_MAX];
        struct iso_gpio_spec specs[ISO_CONFIG_OPTIONS_MAX];
        size_t n_specs = 0;
        const size_t n = iso_config_door_options(&config, options);
        for (size_t i = 0; i < n; i++) {
            struct iso_fault fault = {.text = ""};
            if (!is_line(options[i].key)) {
                continue;
            }
            if (iso_gpio_spec_parse(boards[b], options[i].value, &specs[n_specs], &fault)) {
                fail_msg("%s", fault.text);
            }
            for (size_t j = 0; j < n_specs; j++) {
                assert_false(strcmp(specs[j].name, specs[n_specs].name) == 0 &&
                             strcmp(specs[j].chip, specs[n_specs].chip) == 0 &&
                             specs[j].offset == specs[n_specs].offset);
            }
            n_specs++;
        }
        assert_true(n_specs >= 7); /* relay, two lights, buzzer, contact, button, tamper */
    }
}

/* Whether the table "| line | active means | pc-usb ... | raspberry-pi-5 ... | ... |" has `line` in
 * code marks, in the row of this key and in the column of this board (0: the first board). */
static bool row_has_line(const char *readme, const char *key, int column, const char *line)
{
    char begin[64], code[ISO_CONFIG_TEXT_SIZE + 2];
    (void)snprintf(begin, sizeof begin, "\n| %s |", key);
    (void)snprintf(code, sizeof code, "`%s`", line);
    const char *cell = strstr(readme, begin);
    for (int i = 0; cell && i < column + 2; i++) {
        cell = strchr(cell + 2, '|');
    }
    const char *end = cell ? strchr(cell + 1, '|') : NULL;
    const char *found = cell ? strstr(cell, code) : NULL;
    return found && end && found < end;
}

static void the_tables_agree_with_the_configurations(void **state)
{
    char *readme = read_text(BOARDS "README.md");
    (void)state;
    for (int b = 0; b < 3; b++) { /* qemu has no pins */
        const struct iso_config config = load(boards[b]);
        struct iso_option options[ISO_CONFIG_OPTIONS_MAX];
        const size_t n = iso_config_door_options(&config, options);
        for (size_t i = 0; i < n; i++) {
            char line[ISO_CONFIG_TEXT_SIZE];
            (void)snprintf(line, sizeof line, "%s", options[i].value);
            line[strcspn(line, " ")] = '\0';
            if (is_line(options[i].key) && !row_has_line(readme, options[i].key, b, line)) {
                fail_msg("board/README.md: no %s of %s at %s", line, boards[b], options[i].key);
            }
        }
    }
    free(readme);
}

/* The overlay defines every name that the configuration uses. */
static void the_overlay_names_the_lines(void **state)
{
    const struct iso_config config = load("rock-5b");
    char *overlay = read_text(path_of("rock-5b", "door.dts"));
    struct iso_option options[ISO_CONFIG_OPTIONS_MAX];
    const size_t n = iso_config_door_options(&config, options);
    (void)state;
    for (size_t i = 0; i < n; i++) {
        char name[ISO_CONFIG_TEXT_SIZE + 2];
        (void)snprintf(name, sizeof name, "\"%s", options[i].value);
        name[strcspn(name, " ")] = '\0';
        if (!strstr(overlay, strcat(name, "\""))) {
            fail_msg("door.dts has no %s", name);
        }
    }
    free(overlay);
}

static int64_t no_time(void *context)
{
    (void)context;
    return 0;
}

/* The driver for the board's camera accepts the options. The test ignores that this camera is not
 * connected. A build without the driver cannot check them. */
static void the_drivers_accept_the_options_of_the_sensors(void **state)
{
    static const char *const back_ends[N_BOARDS] = {"openni2", "libcamera-stereo", "openni2",
                                                    "replay"};
    const struct iso_clock clock = {no_time, NULL};
    (void)state;
    for (int b = 0; b < N_BOARDS; b++) {
        const struct iso_config config = load(boards[b]);
        struct iso_option options[ISO_CONFIG_OPTIONS_MAX];
        struct iso_sensor *sensor = NULL;
        struct iso_fault fault = {.text = ""};
        assert_string_equal(config.sensor.backend, back_ends[b]);
        const size_t n = iso_config_sensor_options(&config, options);
        assert_true(n > 0 || !iso_sensor_options(config.sensor.backend));
        if (iso_sensor_open(config.sensor.backend, options, n, &clock, &sensor, &fault) == 0) {
            iso_sensor_close(sensor);
        }
        if (strstr(fault.text, "option '")) {
            fail_msg("%s: %s", boards[b], fault.text);
        }
    }
}

static void every_board_has_its_rules_and_its_unit(void **state)
{
    (void)state;
    for (int b = 0; b < N_BOARDS; b++) {
        char *rules = read_text(path_of(boards[b], "60-isotherm.rules"));
        char *unit = read_text(path_of(boards[b], "board.conf"));
        assert_non_null(strstr(rules, "KERNEL==\"gpiochip*\""));
        assert_non_null(strstr(rules, "GROUP=\"isotherm-io\", MODE=\"0660\""));
        assert_non_null(strstr(unit, "SupplementaryGroups=isotherm-io\n"));
        assert_non_null(strstr(unit, "DevicePolicy=closed\n"));
        assert_non_null(strstr(unit, "DeviceAllow=char-gpiochip rw\n"));
        free(rules);
        free(unit);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_lines_of_a_board_are_valid_and_different),
        cmocka_unit_test(the_tables_agree_with_the_configurations),
        cmocka_unit_test(the_overlay_names_the_lines),
        cmocka_unit_test(the_drivers_accept_the_options_of_the_sensors),
        cmocka_unit_test(every_board_has_its_rules_and_its_unit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
