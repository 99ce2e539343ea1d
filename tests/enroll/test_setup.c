/* `isotherm setup` as a whole: the files that it writes, the service that it starts, its output,
 * and that a fault leaves everything unchanged. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/enroll/rigs/setup_rig.h"
#include "tests/support/programs/private_bus.h"
#include "tests/support/scratch.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

static void a_fresh_machine_becomes_an_appliance(void **state)
{
    const struct cli_setup_wish wish = {
        .sensor = "replay:/srv/p01", .board = "pc-usb", .yes = true};
    const struct fake_manager_script manager = {.started = setup_rig_path("etc/isotherm.conf")};
    struct setup_rig *rig = *state;
    struct stat status;
    size_t size, read_size;
    const char *png = setup_rig_png(&size);
    const struct fake_script daemon = {.picture = png, .picture_size = size};

    assert_int_equal(setup_rig_run(rig, &wish, &manager, &daemon), CLI_EXIT_OK);
    setup_rig_expect_in(rig->calls,
                        "Subscribe;GetUnitFileState;LoadUnit;EnableUnitFiles;Reload;"
                        "ResetFailedUnit;RestartUnit;<# Written by isotherm setup for the board "
                        "pc-usb.\n");
    setup_rig_expect_in(rig->calls, "[sensor]\nbackend = replay\npath = /srv/p01\n\n[door]\n");
    setup_rig_expect_in(rig->calls, "relay = cp2112_gpio:0\n");
    assert_int_equal(stat(rig->places.config, &status), 0);
    assert_int_equal(status.st_mode & 07777, 0644);
    assert_int_equal(setup_rig_count_files(), 1);
    setup_rig_expect_in(rig->said, "backend = replay");             /* the file */
    setup_rig_expect_in(rig->said, "ok       sensor      started"); /* doctor */
    char *picture = scratch_read(setup_rig_path("picture.png"), &read_size);
    assert_int_equal(read_size, size);
    assert_memory_equal(picture, png, size);
    free(picture);
    assert_int_equal(stat(setup_rig_path("picture.png"), &status), 0);
    assert_int_equal(status.st_mode & 07777, 0600);
}

static void an_old_file_is_kept_and_an_equal_file_is_not_written(void **state)
{
    const struct cli_setup_wish wish = {.sensor = "openni2", .board = "rock-5b", .yes = true};
    const struct fake_manager_script manager = {.enabled = true, .active = true};
    const struct fake_script daemon = {.n_people = 0};
    struct setup_rig *rig = *state;

    setup_rig_write_old();
    assert_int_equal(setup_rig_run(rig, &wish, &manager, &daemon), CLI_EXIT_OK);
    assert_string_equal(rig->calls,
                        "Subscribe;GetUnitFileState;LoadUnit;ResetFailedUnit;RestartUnit;<>;");
    setup_rig_expect_in(rig->said, "- # By hand.\n");
    setup_rig_expect_in(rig->said, "+ # Written by isotherm setup for the board rock-5b.\n");
    setup_rig_expect_in(rig->said, "  level = strict\n");
    assert_int_equal(setup_rig_count_files(), 2);
    const char *backup = strstr(rig->said, "The old file is now ");
    assert_non_null(backup);
    char path[512];
    (void)snprintf(path, sizeof path, "%.*s", (int)strcspn(backup + 20, "\n") - 1, backup + 20);
    size_t size;
    char *text = scratch_read(path, &size);
    assert_int_equal(size, strlen(setup_rig_old_text));
    assert_memory_equal(text, setup_rig_old_text, size);
    free(text);
    /* A second run writes nothing, but it starts the service again. */
    assert_int_equal(setup_rig_run(rig, &wish, &manager, &daemon), CLI_EXIT_OK);
    setup_rig_expect_in(rig->said, "stays as it is");
    setup_rig_expect_in(rig->calls, "RestartUnit");
    assert_int_equal(setup_rig_count_files(), 2);
}

static void a_board_and_a_camera_that_are_found_need_not_be_named(void **state)
{
    const struct cli_setup_wish wish = {.yes = true, .dry_run = true};
    struct setup_rig *rig = *state;

    assert_int_equal(setup_rig_run(rig, &wish, NULL, NULL), CLI_EXIT_USAGE);
    setup_rig_expect_in(rig->fault.text, "--board is missing");
    setup_rig_expect_in(rig->fault.text, "generic, pc-usb, qemu, raspberry-pi-5, rock-5b");
    scratch_mkdir(setup_rig_path("sys"));
    scratch_mkdir(setup_rig_path("sys/firmware"));
    scratch_mkdir(setup_rig_path("sys/firmware/devicetree"));
    scratch_mkdir(setup_rig_path("sys/firmware/devicetree/base"));
    scratch_write_text(setup_rig_path("sys/firmware/devicetree/base/model"), "Radxa ROCK 5B");
    assert_int_equal(setup_rig_run(rig, &wish, NULL, NULL), CLI_EXIT_USAGE);
    setup_rig_expect_in(rig->fault.text, "--sensor is missing: no depth camera was found");
    setup_rig_set_devices(setup_rig_one_camera);
    assert_int_equal(setup_rig_run(rig, &wish, NULL, NULL), CLI_EXIT_OK);
    setup_rig_expect_in(rig->said, "board rock-5b");
    setup_rig_expect_in(rig->said, "backend = openni2");
    setup_rig_set_devices("{\"sensor\":\"openni2\",\"id\":\"a@1/5\",\"label\":\"one\"}\n"
                          "{\"sensor\":\"openni2\",\"id\":\"b@1/6\",\"label\":\"two\"}\n");
    assert_int_equal(setup_rig_run(rig, &wish, NULL, NULL), CLI_EXIT_USAGE);
    setup_rig_expect_in(rig->fault.text, "one (OpenNI2, a@1/5); two (OpenNI2, b@1/6)");
    assert_int_equal(setup_rig_count_files(), 0); /* a dry run writes nothing */
}

static void a_wrong_wish_is_named_and_changes_nothing(void **state)
{
    static const struct {
        struct cli_setup_wish wish;
        enum cli_exit exit;
        const char *text;
    } cases[] = {
        {{.sensor = "openni2", .board = "moon", .yes = true}, CLI_EXIT_NOT_FOUND, "'moon'; there"},
        {{.sensor = "openni2", .board = "pc-usb"}, CLI_EXIT_USAGE, "give --yes"},
        {{.sensor = "replay:frames", .board = "pc-usb", .yes = true}, CLI_EXIT_USAGE, "full name"},
        {{.sensor = "openni2:lens=1", .board = "pc-usb", .yes = true},
         CLI_EXIT_USAGE,
         "isotherm.conf:"},
        {{.sensor = "v4l2:/dev/null", .board = "pc-usb", .yes = true},
         CLI_EXIT_USAGE,
         "/dev/null has no description in"},
    };
    const struct fake_manager_script manager = {.enabled = true, .active = true};
    const struct fake_script daemon = {.n_people = 0};
    struct setup_rig *rig = *state;

    setup_rig_write_old();
    for (size_t i = 0; i < COUNT(cases); i++) {
        assert_int_equal(setup_rig_run(rig, &cases[i].wish, &manager, &daemon), cases[i].exit);
        setup_rig_expect_in(rig->fault.text, cases[i].text);
        assert_string_equal(rig->calls, "");
        setup_rig_expect_config(setup_rig_old_text);
        assert_int_equal(setup_rig_count_files(), 1);
    }
}

/* Each failure of the start, on a machine whose daemon ran before, and on a machine without a
 * configuration. */
static void a_start_that_fails_is_undone(void **state)
{
    static const struct {
        struct fake_manager_script manager;
        bool daemon;
        const char *text;
    } cases[] = {
        {{.result = "failed"}, true, "isothermd.service did not start (failed)"},
        {{.result = "dependency"}, true, "isothermd.service did not start (dependency)"},
        {{.fail_method = "RestartUnit"}, true, "cannot be started: the fake says so"},
        {{.result = "done"}, false, "did not come to the bus within 1 s"},
    };
    const struct cli_setup_wish wish = {.sensor = "openni2", .board = "pc-usb", .yes = true};
    const struct fake_script daemon = {.n_people = 0};
    struct setup_rig *rig = *state;

    for (size_t i = 0; i < COUNT(cases) * 2; i++) {
        struct fake_manager_script manager = cases[i / 2].manager;
        const bool before = i % 2 == 1;
        if (before && !scratch_exists(rig->places.config)) {
            if (!scratch_exists(setup_rig_path("etc"))) {
                scratch_mkdir(setup_rig_path("etc"));
            }
            scratch_write_text(setup_rig_path("etc/isotherm.conf"), setup_rig_old_text);
        } else if (!before) {
            (void)unlink(rig->places.config);
        }
        manager.enabled = manager.active = before;
        manager.started = rig->places.config;
        assert_int_equal(setup_rig_run(rig, &wish, &manager, cases[i / 2].daemon ? &daemon : NULL),
                         CLI_EXIT_FAULT);
        setup_rig_expect_in(rig->fault.text, cases[i / 2].text);
        setup_rig_expect_config(before ? setup_rig_old_text : NULL);
        assert_int_equal(setup_rig_count_files(), before);
        if (!manager.fail_method) {
            setup_rig_expect_in(rig->fault.text, "the configuration is as it was");
            setup_rig_expect_in(rig->calls, before ? "RestartUnit;<# By hand.\n"
                                                   : "StopUnit;<>;DisableUnitFiles;Reload;");
        }
    }
}

static void without_a_service_manager_nothing_is_replaced(void **state)
{
    const struct cli_setup_wish wish = {.sensor = "openni2", .board = "pc-usb", .yes = true};
    const struct fake_manager_script unknown = {.fail_method = "GetUnitFileState"};
    struct setup_rig *rig = *state;

    setup_rig_write_old();
    assert_int_equal(setup_rig_run(rig, &wish, NULL, NULL), CLI_EXIT_FAULT);
    assert_string_equal(rig->fault.code, "no-manager");
    setup_rig_expect_config(setup_rig_old_text);
    assert_int_equal(setup_rig_run(rig, &wish, &unknown, NULL), CLI_EXIT_FAULT);
    assert_string_equal(rig->fault.code, "no-unit");
    setup_rig_expect_config(setup_rig_old_text);
    assert_int_equal(setup_rig_count_files(), 1);
}

static void a_file_that_cannot_be_written_starts_nothing(void **state)
{
    const struct cli_setup_wish wish = {.sensor = "openni2", .board = "pc-usb", .yes = true};
    const struct fake_manager_script manager = {.enabled = true};
    struct setup_rig *rig = *state;

    scratch_write_text(setup_rig_path("etc"), "no folder");
    assert_int_equal(setup_rig_run(rig, &wish, &manager, NULL), CLI_EXIT_FAULT);
    setup_rig_expect_in(rig->fault.text, rig->places.config);
    assert_string_equal(rig->calls, "");
}

static void only_root_may_write_but_every_user_may_look(void **state)
{
    struct cli_setup_wish wish = {.sensor = "openni2", .board = "pc-usb", .yes = true};
    struct setup_rig *rig = *state;
    int status;

    rig->places.root = true;
    const pid_t pid = fork();
    assert_true(pid >= 0);
    if (pid == 0) {
        const struct cli_dialogue dialogue = {.in = STDIN_FILENO, .out = stderr};
        if (geteuid() == 0 && seteuid(65534) < 0) {
            _exit(99);
        }
        _exit((int)cli_setup_run(&rig->places, &wish, &dialogue, &rig->fault));
    }
    assert_int_equal(waitpid(pid, &status, 0), pid);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), CLI_EXIT_NO);
    setup_rig_expect_config(NULL);
    wish.dry_run = true;
    assert_int_equal(setup_rig_run(rig, &wish, NULL, NULL), CLI_EXIT_OK);
    setup_rig_expect_in(rig->said, "relay = cp2112_gpio:0");
    setup_rig_expect_config(NULL);
}

static void a_missing_picture_is_reported_and_is_no_failure(void **state)
{
    const struct cli_setup_wish wish = {.sensor = "openni2", .board = "pc-usb", .yes = true};
    const struct fake_manager_script manager = {.enabled = true};
    const struct fake_script daemon = {.fail_method = "Picture",
                                       .fail_error = "org.isotherm.Error.DeviceFault",
                                       .sensor_state = "lost",
                                       .sensor_fault = "no device"};
    struct setup_rig *rig = *state;

    assert_int_equal(setup_rig_run(rig, &wish, &manager, &daemon), CLI_EXIT_OK);
    setup_rig_expect_in(rig->said, "There is no picture of what the camera sees: the fake says so");
    setup_rig_expect_in(rig->said, "fault    sensor      lost: no device");
    assert_false(scratch_exists(setup_rig_path("picture.png")));
}

static size_t count_calls(const char *calls, const char *method)
{
    size_t n = 0;

    for (const char *at = calls; (at = strstr(at, method)); at += strlen(method)) {
        n++;
    }
    return n;
}

/* The daemon itself waits for a frame, and it records each request for a picture. */
static void a_camera_that_shows_nothing_is_asked_once(void **state)
{
    const struct cli_setup_wish wish = {.sensor = "openni2", .board = "pc-usb", .yes = true};
    const struct fake_manager_script manager = {.enabled = true};
    const struct fake_script daemon = {.fail_method = "Picture",
                                       .fail_error = "org.isotherm.Error.DeviceFault",
                                       .fail_text = "no picture: the camera shows nothing"};
    struct setup_rig *rig = *state;

    assert_int_equal(setup_rig_run(rig, &wish, &manager, &daemon), CLI_EXIT_OK);
    setup_rig_expect_in(rig->said,
                        "Waiting for a picture ...\n"
                        "There is no picture of what the camera sees: the camera shows nothing.\n");
    assert_int_equal(count_calls(rig->daemon_calls, "Picture"), 1);
}

/* Another program may release the camera meanwhile. */
static void a_camera_in_use_is_asked_for_again(void **state)
{
    const struct cli_setup_wish wish = {.sensor = "openni2", .board = "pc-usb", .yes = true};
    const struct fake_manager_script manager = {.enabled = true};
    const struct fake_script daemon = {.fail_method = "Claim",
                                       .fail_error = "org.isotherm.Error.AlreadyInUse"};
    struct setup_rig *rig = *state;

    assert_int_equal(setup_rig_run(rig, &wish, &manager, &daemon), CLI_EXIT_OK);
    assert_int_equal(count_calls(rig->daemon_calls, "Claim"), 4);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        ON_A_RIG(a_fresh_machine_becomes_an_appliance),
        ON_A_RIG(an_old_file_is_kept_and_an_equal_file_is_not_written),
        ON_A_RIG(a_board_and_a_camera_that_are_found_need_not_be_named),
        ON_A_RIG(a_wrong_wish_is_named_and_changes_nothing),
        ON_A_RIG(a_start_that_fails_is_undone),
        ON_A_RIG(without_a_service_manager_nothing_is_replaced),
        ON_A_RIG(a_file_that_cannot_be_written_starts_nothing),
        ON_A_RIG(only_root_may_write_but_every_user_may_look),
        ON_A_RIG(a_missing_picture_is_reported_and_is_no_failure),
        ON_A_RIG(a_camera_that_shows_nothing_is_asked_once),
        ON_A_RIG(a_camera_in_use_is_asked_for_again),
    };

    if (!setup_rig_find_bus()) {
        return TEST_SKIPPED;
    }
    return cmocka_run_group_tests(tests, NULL, setup_rig_stop_bus);
}
