/* `isotherm setup` when a program calls it, and with the real daemon. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <jansson.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "enroll/cli/picture/pixels.h"
#include "tests/enroll/rigs/setup_rig.h"
#include "tests/support/programs/private_bus.h"
#include "tests/support/programs/run.h"
#include "tests/support/scratch.h"

#define DATA ISOTHERM_SOURCE_DIR "/core/data"

static void with_json_there_is_one_document(void **state)
{
    const struct cli_setup_wish wish = {
        .board = "pc-usb", .sensor = "openni2", .yes = true, .json = true};
    const struct fake_manager_script manager = {.active = true};
    const struct fake_script daemon = {.n_people = 0};
    struct setup_rig *rig = *state;
    const char *path = setup_rig_path("out.json");

    const int saved = dup(STDOUT_FILENO);
    assert_non_null(freopen(path, "w", stdout));
    const enum cli_exit exit = setup_rig_run(rig, &wish, &manager, &daemon);
    (void)fflush(stdout);
    assert_int_equal(dup2(saved, STDOUT_FILENO), STDOUT_FILENO);
    close(saved);
    assert_int_equal(exit, CLI_EXIT_OK);
    json_t *document = json_load_file(path, 0, NULL);
    assert_non_null(document);
    assert_string_equal(json_string_value(json_object_get(document, "config")), rig->places.config);
    assert_string_equal(json_string_value(json_object_get(document, "board")), "pc-usb");
    assert_string_equal(json_string_value(json_object_get(document, "sensor")), "openni2");
    assert_non_null(json_object_get(json_object_get(document, "doctor"), "checks"));
    assert_non_null(json_string_value(json_object_get(document, "picture")));
    json_decref(document);
}

/* Starts a daemon with stored frames before the set-up, in place of the daemon that the service
 * manager would start. */
static void start_real_daemon(const struct setup_rig *rig, struct run *run)
{
    static char text[2048];
    const char *const argv[] = {ISOTHERM_BINARY_DIR "/firmware/isothermd", "--config",
                                setup_rig_path("real.conf"), NULL};

    (void)snprintf(text, sizeof text,
                   "[sensor]\npath = " ISOTHERM_SOURCE_DIR
                   "/sim/stored/p01-v1\nloop = yes\nrepeats = yes\npause_ms = 30000\n"
                   "[gallery]\npath = %s\n[log]\npath = %s\n[bus]\naddress = %s\n[model]\n"
                   "head = " DATA "/head.model\nmetric = " DATA "/face.metric\n",
                   setup_rig_path("g.db"), setup_rig_path("a.log"), rig->places.manager.address);
    scratch_write_text(setup_rig_path("real.conf"), text);
    run_start(run, argv);
}

static void the_real_daemon_sends_a_picture_of_what_it_sees(void **state)
{
    const struct cli_setup_wish wish = {.sensor = "openni2", .board = "generic", .yes = true};
    const struct fake_manager_script manager = {.active = true};
    struct setup_rig *rig = *state;
    struct cli_pixels pixels = {0};
    struct run run;
    size_t size;

    start_real_daemon(rig, &run);
    rig->places.daemon_wait_s = 30;
    assert_int_equal(setup_rig_run(rig, &wish, &manager, NULL), CLI_EXIT_OK);
    assert_int_equal(kill(run.pid, SIGTERM), 0);
    run_finish(&run);
    assert_int_equal(run.exit, 0);
    run_free(&run);
    setup_rig_expect_in(rig->said,
                        "warning  sensor      started: stored frames may count more than "
                        "once (repeats = yes)");
    setup_rig_expect_in(rig->said, "null: nothing is switched"); /* the board has no lines */
    uint8_t *png = scratch_read(setup_rig_path("picture.png"), &size);
    assert_int_equal(cli_pixels_decode(png, size, &pixels, &rig->fault), CLI_EXIT_OK);
    assert_int_equal(pixels.width_px, 320);
    assert_int_equal(pixels.height_px, 240);
    cli_pixels_done(&pixels);
    free(png);
}

/* Runs the real program. Its findings depend on the machine, but each line must have one object. */
static void the_daemon_lists_devices_one_object_a_line(void **state)
{
    const char *const argv[] = {ISOTHERM_BINARY_DIR "/firmware/isothermd", "--list-devices", NULL};
    struct run run;

    (void)state;
    run_start(&run, argv);
    run_finish(&run);
    if (run.exit != 0) {
        fail_msg("exit %d, and said: %s", run.exit, run.err);
    }
    for (char *line = strtok(run.out, "\n"); line; line = strtok(NULL, "\n")) {
        json_t *object = json_loads(line, 0, NULL);
        assert_non_null(object);
        assert_non_null(json_string_value(json_object_get(object, "sensor")));
        assert_true(json_object_get(object, "id") || json_object_get(object, "fault"));
        json_decref(object);
    }
    run_free(&run);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        ON_A_RIG(with_json_there_is_one_document),
        ON_A_RIG(the_real_daemon_sends_a_picture_of_what_it_sees),
        cmocka_unit_test(the_daemon_lists_devices_one_object_a_line),
    };

    if (!setup_rig_find_bus()) {
        return TEST_SKIPPED;
    }
    return cmocka_run_group_tests(tests, NULL, setup_rig_stop_bus);
}
