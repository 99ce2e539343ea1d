/* `isotherm setup` at a terminal: its questions, and the effect of an interrupt. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <string.h>
#include <unistd.h>

#include "tests/enroll/rigs/setup_rig.h"
#include "tests/support/programs/private_bus.h"
#include "tests/support/scratch.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

static void a_person_is_asked_for_missing_values(void **state)
{
    const struct cli_setup_wish wish = {.yes = false};
    const struct fake_manager_script manager = {.active = false};
    struct setup_rig *rig = *state;
    static struct setup_terminal terminal;
    size_t size;
    const char *png = setup_rig_png(&size);
    const struct fake_script daemon = {.picture = png, .picture_size = size};

    setup_rig_set_devices(setup_rig_one_camera);
    setup_rig_begin(rig, &manager, &daemon);
    setup_rig_open(rig, &wish, &terminal);
    setup_rig_answer(&terminal, "Board [1]", "seven\n"); /* generic: no board is recognised */
    setup_rig_answer(&terminal, "a number from 1 to 5", "2\n");
    setup_rig_answer(&terminal, "Camera [1]", "\n");
    setup_rig_answer(&terminal, "start the service? [Y/n]", "perhaps\n");
    setup_rig_answer(&terminal, "Please answer y or n.", "y\n");
    assert_int_equal(setup_rig_close(&terminal), CLI_EXIT_OK);
    setup_rig_end(rig);
    setup_rig_expect_in(terminal.text, "Orbbec Astra (OpenNI2, 2bc5/0401@1/5)");
    setup_rig_expect_in(terminal.text,
                        "\033[38;2;0;0;0m\033[48;2;160;160;160m\u2580"); /* the picture */
    setup_rig_expect_in(terminal.text, "sensor      started");
    assert_true(scratch_exists(rig->places.config));
    setup_rig_expect_in(rig->calls, "EnableUnitFiles");
}

static void a_recording_can_be_tried_and_the_lens_file_is_asked_for(void **state)
{
    const struct cli_setup_wish wish = {.board = "pc-usb", .dry_run = true};
    struct setup_rig *rig = *state;
    static struct setup_terminal terminal;

    setup_rig_open(rig, &wish, &terminal);
    setup_rig_answer(&terminal, "Camera [1]", "1\n");
    setup_rig_answer(&terminal, "Folder of the recording:", "/srv/p01\n");
    assert_int_equal(setup_rig_close(&terminal), CLI_EXIT_OK);
    setup_rig_expect_in(terminal.text, "No depth camera was found.");
    setup_rig_expect_in(terminal.text, "path = /srv/p01");
    setup_rig_open(rig, &wish, &terminal);
    setup_rig_answer(&terminal, "Camera [1]", "2\n");
    setup_rig_answer(&terminal, "Sensor, such as", "v4l2:/dev/null\n");
    setup_rig_answer(&terminal, "File [1]", "1\n");
    setup_rig_answer(&terminal, "File:", ISOTHERM_SOURCE_DIR "/sim/stored/p01-v1/recording.ini\n");
    assert_int_equal(setup_rig_close(&terminal), CLI_EXIT_OK);
    setup_rig_expect_in(terminal.text, "camera = " ISOTHERM_SOURCE_DIR);
    setup_rig_expect_config(NULL);
}

static void no_and_an_interrupt_change_nothing(void **state)
{
    static const struct {
        const char *answer;
        int exit;
    } cases[] = {
        {"n\n", CLI_EXIT_NO}, {"\003", CLI_EXIT_INTERRUPTED}, {"\004", CLI_EXIT_INTERRUPTED}};
    const struct cli_setup_wish wish = {.board = "pc-usb", .sensor = "openni2"};
    const struct fake_manager_script manager = {.active = true};
    struct setup_rig *rig = *state;
    static struct setup_terminal terminal;

    setup_rig_write_old();
    for (size_t i = 0; i < COUNT(cases); i++) {
        setup_rig_begin(rig, &manager, NULL);
        setup_rig_open(rig, &wish, &terminal);
        setup_rig_answer(&terminal, "[Y/n]", cases[i].answer);
        assert_int_equal(setup_rig_close(&terminal), cases[i].exit);
        setup_rig_end(rig);
        setup_rig_expect_in(terminal.text, "nothing has been changed");
        assert_string_equal(rig->calls, "");
        setup_rig_expect_config(setup_rig_old_text);
        assert_int_equal(setup_rig_count_files(), 1);
    }
}

static void an_interrupt_while_the_service_starts_undoes_it(void **state)
{
    const struct cli_setup_wish wish = {.board = "pc-usb", .sensor = "openni2", .yes = true};
    struct setup_rig *rig = *state;
    const struct fake_manager_script manager = {
        .enabled = true, .active = true, .result = "", .started = rig->places.config};
    static struct setup_terminal terminal;

    setup_rig_write_old();
    setup_rig_begin(rig, &manager, NULL);
    setup_rig_open(rig, &wish, &terminal);
    fake_manager_wait_for_start(&rig->manager);
    assert_int_equal(write(terminal.fd, "\003", 1), 1);
    assert_int_equal(setup_rig_close(&terminal), CLI_EXIT_INTERRUPTED);
    setup_rig_end(rig);
    setup_rig_expect_in(terminal.text, "interrupted; the configuration is as it was");
    setup_rig_expect_in(rig->calls, "RestartUnit;<# By hand.\n");
    setup_rig_expect_config(setup_rig_old_text);
    assert_int_equal(setup_rig_count_files(), 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        ON_A_RIG(a_person_is_asked_for_missing_values),
        ON_A_RIG(a_recording_can_be_tried_and_the_lens_file_is_asked_for),
        ON_A_RIG(no_and_an_interrupt_change_nothing),
        ON_A_RIG(an_interrupt_while_the_service_starts_undoes_it),
    };

    if (!setup_rig_find_bus()) {
        return TEST_SKIPPED;
    }
    return cmocka_run_group_tests(tests, NULL, setup_rig_stop_bus);
}
