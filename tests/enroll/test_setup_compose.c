/* The configuration that `isotherm setup` writes: the name of a sensor, the file that is composed
 * from this name and the board, and how a change of the file is shown. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "enroll/cli/machine/boards.h"
#include "enroll/cli/machine/text_file.h"
#include "enroll/cli/setup/compose.h"
#include "enroll/cli/setup/difference.h"
#include "enroll/cli/setup/install.h"
#include "tests/support/scratch.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

static void a_sensor_is_one_word(void **state)
{
    static const struct {
        const char *word, *backend, *key, *value;
        size_t n;
    } cases[] = {
        {"openni2", "openni2", "device", NULL, 0},
        {"openni2:2bc5/0401@1/5", "openni2", "device", "2bc5/0401@1/5", 1},
        {"openni2:/srv/a.oni,loop=yes", "openni2", "path", "/srv/a.oni", 2},
        {"replay:/srv/p01, second", "replay", "path", "/srv/p01, second", 1},
        {"v4l2:/dev/video0,camera=/etc/c.ini", "v4l2", "camera", "/etc/c.ini", 2},
        {"v4l2:camera=/etc/c.ini,device=/dev/video0", "v4l2", "device", "/dev/video0", 2},
        {"libcamera-stereo:left=/base/a,right=/base/b", "libcamera-stereo", "right", "/base/b", 2},
    };
    struct cli_fault fault = {0};

    (void)state;
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct cli_sensor_word word;
        assert_int_equal(cli_sensor_word_parse(cases[i].word, &word, &fault), CLI_EXIT_OK);
        assert_string_equal(word.backend, cases[i].backend);
        assert_int_equal(word.n_options, cases[i].n);
        const char *value = cli_sensor_word_get(&word, cases[i].key);
        assert_int_equal(value != NULL, cases[i].value != NULL);
        if (value) {
            assert_string_equal(value, cases[i].value);
        }
    }
}

static void a_sensor_that_no_file_can_contain_is_refused(void **state)
{
    static const struct {
        const char *word, *text;
    } cases[] = {
        {"", "does not name a driver"},
        {":/dev/video0", "does not name a driver"},
        {"/dev/video0", "does not name a driver"},
        {"replay:frames", "'frames': a full name is needed"},
        {"v4l2:/dev/video0,camera=c.ini", "'c.ini': a full name is needed"},
        {"v4l2:/dev/video0,camera=", "'camera': its value is empty"},
        {"v4l2:/dev/video0\n[door]", "characters that the file cannot contain"},
        {"v4l2:/dev/video0 ;x", "characters that the file cannot contain"},
        {"v4l2:a_key_that_is_longer_than_any=1", "not a key of [sensor]"},
    };
    char long_word[300] = "replay:/";

    (void)state;
    for (size_t i = 0; i < COUNT(cases); i++) {
        struct cli_fault fault = {0};
        struct cli_sensor_word word = {.backend = "untouched"};
        assert_int_equal(cli_sensor_word_parse(cases[i].word, &word, &fault), CLI_EXIT_USAGE);
        assert_string_equal(word.backend, "untouched");
        if (!strstr(fault.text, cases[i].text)) {
            fail_msg("'%s': '%s' is not in '%s'", cases[i].word, cases[i].text, fault.text);
        }
    }
    struct cli_fault fault = {0};
    struct cli_sensor_word word;
    memset(long_word + 8, 'x', CLI_SENSOR_VALUE_SIZE);
    assert_int_equal(cli_sensor_word_parse(long_word, &word, &fault), CLI_EXIT_USAGE);
    assert_non_null(strstr(fault.text, "too long"));
}

static char *compose_text(const char *board_text, const char *sensor, const char *old_text)
{
    struct cli_fault fault = {0};
    struct cli_sensor_word word;

    assert_int_equal(cli_sensor_word_parse(sensor, &word, &fault), CLI_EXIT_OK);
    char *text = cli_compose(&(struct cli_composition){
        .board = "b", .board_text = board_text, .sensor = &word, .old_text = old_text});
    assert_non_null(text);
    return text;
}

static void expect_composed(const char *board_text, const char *sensor, const char *old_text,
                            const char *expected)
{
    char *text = compose_text(board_text, sensor, old_text);

    assert_string_equal(text, expected);
    free(text);
}

#define FIRST "# Written by isotherm setup for the board b.\n"

static void the_sensor_is_the_boards_if_the_driver_is_the_same(void **state)
{
    static const char board[] = "# A board.\n\n[sensor]\n# Why.\nbackend = openni2\nunit = finest\n"
                                "\n[door]\nrelay = A\n";

    (void)state;
    expect_composed(board, "openni2", NULL,
                    FIRST "# A board.\n\n[sensor]\n# Why.\nbackend = openni2\nunit = finest\n\n"
                          "[door]\nrelay = A\n");
    expect_composed(board, "openni2:unit=1mm,device=u", NULL,
                    FIRST "# A board.\n\n[sensor]\ndevice = u\n# Why.\nbackend = openni2\n"
                          "unit = 1mm\n\n[door]\nrelay = A\n");
    expect_composed(board, "replay:/r", NULL,
                    FIRST "# A board.\n\n[sensor]\nbackend = replay\npath = /r\n\n[door]\n"
                          "relay = A\n");
    expect_composed("[door]\nrelay = A\n", "replay:/r", NULL,
                    FIRST "[door]\nrelay = A\n\n[sensor]\nbackend = replay\npath = /r\n");
}

static void sections_other_than_sensor_and_door_stay(void **state)
{
    static const char board[] = "[sensor]\nbackend = openni2\n\n[door]\nrelay = A\n\n[log]\n"
                                "max_mib = 8\n";
    static const char old[] = "# By hand.\n[decision]\n# Strict.\nlevel = strict\n\n[sensor]\n"
                              "backend = v4l2\n[door]\nrelay = B\n[log]\nmax_mib = 9";

    (void)state;
    expect_composed(board, "openni2", old,
                    FIRST "[sensor]\nbackend = openni2\n\n[door]\nrelay = A\n\n[decision]\n"
                          "# Strict.\nlevel = strict\n\n[log]\nmax_mib = 9\n");
}

/* Composes the file for every board with every kind of sensor, twice. The second time nothing
 * changes. */
static void every_composition_is_sound(void **state)
{
    static const char *const sensors[] = {
        "replay:/",
        "openni2",
        "openni2:2bc5/0401@1/5,mode=640x480@30",
        "v4l2:/dev/video0,camera=" ISOTHERM_SOURCE_DIR "/sim/stored/p01-v1/recording.ini",
    };
    const struct cli_setup_places places = {
        .boards = ISOTHERM_SOURCE_DIR "/board",
        .daemon = ISOTHERM_BINARY_DIR "/firmware/isothermd",
        .config = "isotherm.conf",
        .sys = *state,
    };
    const char *beside = scratch_path(*state, "isotherm.conf");
    struct cli_boards boards;
    struct cli_fault fault = {0};

    assert_int_equal(cli_boards_find(&places, &boards, &fault), CLI_EXIT_OK);
    assert_true(boards.n >= 5);
    for (size_t i = 0; i < boards.n * COUNT(sensors); i++) {
        const char *sensor = sensors[i % COUNT(sensors)];
        char path[256];
        (void)snprintf(path, sizeof path, "%s/%s/isotherm.conf", places.boards,
                       boards.items[i / COUNT(sensors)].name);
        char *board_text = cli_text_file_read(path, NULL);
        assert_non_null(board_text);
        char *text = compose_text(board_text, sensor, NULL),
             *again = compose_text(board_text, sensor, text);
        if (cli_setup_check(&places, beside, text, &fault)) {
            fail_msg("%s with %s: %s\n%s", path, sensor, fault.text, text);
        }
        assert_string_equal(again, text);
        free(again);
        free(text);
        free(board_text);
    }
}

static void a_composition_that_is_not_sound_is_refused_by_name(void **state)
{
    const struct cli_setup_places places = {
        .daemon = ISOTHERM_BINARY_DIR "/firmware/isothermd",
        .config = "/etc/isotherm/isotherm.conf",
    };
    const char *beside = scratch_path(*state, "isotherm.conf");
    struct cli_fault fault = {0};

    assert_int_equal(cli_setup_check(&places, beside, "[sensor]\nbckend = replay\n", &fault),
                     CLI_EXIT_USAGE);
    assert_non_null(strstr(fault.text, "/etc/isotherm/isotherm.conf:2"));
    assert_null(strstr(fault.text, ".new-"));
    assert_int_equal(rmdir(*state), 0); /* no draft is left */
    assert_int_equal(mkdir(*state, 0700), 0);
}

static void a_change_is_shown_line_by_line(void **state)
{
    static const char before[] = "1\n2\n3\n4\n5\nold\n6\n7\n8\n9\n10\n11\n12\n13\ngone";
    static const char after[] = "1\n2\n3\n4\n5\nnew\nnewer\n6\n7\n8\n9\n10\n11\n12\n13\n";
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);

    (void)state;
    assert_int_equal(cli_difference_print("same\n", "same\n", out), 0);
    assert_int_equal(cli_difference_print(before, after, out), 0);
    assert_int_equal(fclose(out), 0);
    assert_string_equal(text, "...\n  3\n  4\n  5\n- old\n+ new\n+ newer\n  6\n  7\n  8\n...\n"
                              "  11\n  12\n  13\n- gone\n");
    free(text);
}

#define IN_SCRATCH(test) cmocka_unit_test_setup_teardown(test, scratch_setup, scratch_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_sensor_is_one_word),
        cmocka_unit_test(a_sensor_that_no_file_can_contain_is_refused),
        cmocka_unit_test(the_sensor_is_the_boards_if_the_driver_is_the_same),
        cmocka_unit_test(sections_other_than_sensor_and_door_stay),
        IN_SCRATCH(every_composition_is_sound),
        IN_SCRATCH(a_composition_that_is_not_sound_is_refused_by_name),
        cmocka_unit_test(a_change_is_shown_line_by_line),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
