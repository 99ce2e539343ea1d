/* The devices that `isotherm setup` finds on a machine, and the files and programs that it uses. */
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
#include "enroll/cli/machine/cameras.h"
#include "enroll/cli/machine/child.h"
#include "enroll/cli/machine/new_file.h"
#include "enroll/cli/machine/text_file.h"
#include "enroll/cli/setup/candidates.h"
#include "tests/support/scratch.h"

/* ---- files and programs ---- */

static void expect_text(const char *path, const char *expected)
{
    char *text = cli_text_file_read(path, NULL);

    assert_non_null(text);
    assert_string_equal(text, expected);
    free(text);
}

static void a_file_is_replaced_as_a_whole_and_can_be_put_back(void **state)
{
    scratch_mkdir(scratch_path(*state, "etc"));
    const char *path = scratch_path(*state, "etc/isotherm.conf");
    struct cli_new_file file;
    struct cli_fault fault = {0};
    struct stat status;

    for (int round = 0; round < 2; round++) { /* without an old file, and with one */
        const char *old = round ? "old\n" : NULL;
        if (old) {
            scratch_write_text(path, old);
        }
        assert_int_equal(cli_new_file_write(path, "new\n", &file, &fault), CLI_EXIT_OK);
        assert_int_equal(scratch_exists(path), old != NULL);
        assert_int_equal(cli_new_file_place(&file, &fault), CLI_EXIT_OK);
        expect_text(path, "new\n");
        assert_int_equal(stat(path, &status), 0);
        assert_int_equal(status.st_mode & 07777, 0644);
        assert_int_equal(file.backup[0] != '\0', old != NULL);
        if (old) {
            expect_text(file.backup, old);
        }
        assert_int_equal(cli_new_file_undo(&file, &fault), CLI_EXIT_OK);
        assert_int_equal(scratch_exists(path), old != NULL);
        cli_new_file_done(&file);
    }
    expect_text(path, "old\n");
    assert_int_equal(unlink(path), 0);
    assert_int_equal(rmdir(scratch_path(*state, "etc")), 0); /* no other file is left */
}

static void a_file_that_cannot_be_written_is_named(void **state)
{
    const char *path = scratch_path(*state, "file/isotherm.conf");
    struct cli_new_file file;
    struct cli_fault fault = {0};

    scratch_write_text(scratch_path(*state, "file"), "in the way");
    assert_int_equal(cli_new_file_write(path, "new\n", &file, &fault), CLI_EXIT_FAULT);
    assert_non_null(strstr(fault.text, path));
    assert_int_equal(cli_new_file_write(scratch_path(*state, "a/b/c"), "new\n", &file, &fault),
                     CLI_EXIT_FAULT);
}

static void a_programs_words_are_kept(void **state)
{
    const char *const argv[] = {"/bin/sh", "-c", "echo out; echo err >&2; cat; exit 3", NULL};
    const char *const none[] = {"/nonexistent", NULL};
    struct cli_child child = {0};
    struct cli_fault fault = {0};

    (void)state;
    assert_int_equal(cli_child_run(argv, &child, &fault), CLI_EXIT_OK);
    assert_int_equal(child.exit, 3);
    assert_string_equal(child.out, "out\n");
    assert_string_equal(child.err, "err\n");
    cli_child_done(&child);
    assert_int_equal(cli_child_run(none, &child, &fault), CLI_EXIT_FAULT);
    assert_non_null(strstr(fault.text, "/nonexistent"));
}

/* ---- the state of the machine ---- */

static void put_file(const char *root, const char *path, const char *text)
{
    char copy[512];

    (void)snprintf(copy, sizeof copy, "%s/%s", root, path);
    for (char *slash = copy + strlen(root) + 1; (slash = strchr(slash, '/')); slash++) {
        *slash = '\0';
        if (!scratch_exists(copy)) {
            scratch_mkdir(copy);
        }
        *slash = '/';
    }
    scratch_write_text(copy, text);
}

/* A machine with a D435 as video4. A link with a permanent name leads to it. */
static struct cli_setup_places make_machine(const char *root)
{
    const struct cli_setup_places places = {
        .boards = ISOTHERM_SOURCE_DIR "/board",
        .cameras = scratch_path(root, "cameras"),
        .sys = scratch_path(root, "sys"),
        .dev = scratch_path(root, "dev"),
    };

    put_file(root, "dev/video4", "");
    put_file(root, "dev/video6", "");
    put_file(root, "dev/v4l/by-path/x", "");
    put_file(root, "sys/bus/usb/devices/1-2/idVendor", "8086\n");
    put_file(root, "sys/bus/usb/devices/1-2/idProduct", "0b07\n");
    put_file(root, "sys/bus/usb/devices/1-2/1-2:1.0/modalias", "");
    put_file(root, "sys/class/video4linux/video4/name", "");
    assert_int_equal(symlink("../../../bus/usb/devices/1-2/1-2:1.0",
                             scratch_path(root, "sys/class/video4linux/video4/device")),
                     0);
    assert_int_equal(symlink("../../video4", scratch_path(root, "dev/v4l/by-path/usb-2-index0")),
                     0);
    return places;
}

static void a_camera_is_known_by_its_usb_id_and_a_name_that_lasts(void **state)
{
    const struct cli_setup_places places = make_machine(*state);
    char id[16], name[CLI_DEVICE_PATH_SIZE];

    cli_device_usb_id(&places, scratch_path(*state, "dev/video4"), id);
    assert_string_equal(id, "8086:0b07");
    cli_device_usb_id(&places, scratch_path(*state, "dev/v4l/by-path/usb-2-index0"), id);
    assert_string_equal(id, "8086:0b07");
    cli_device_usb_id(&places, scratch_path(*state, "dev/video6"), id);
    assert_string_equal(id, "");
    cli_device_usb_id(&places, scratch_path(*state, "dev/video9"), id);
    assert_string_equal(id, "");
    cli_device_lasting_name(&places, scratch_path(*state, "dev/video4"), name);
    assert_string_equal(name, scratch_path(*state, "dev/v4l/by-path/usb-2-index0"));
    cli_device_lasting_name(&places, scratch_path(*state, "dev/video6"), name);
    assert_string_equal(name, scratch_path(*state, "dev/video6"));
}

static void the_description_of_a_camera_is_found_by_its_usb_id(void **state)
{
    const struct cli_setup_places places = make_machine(*state);
    static struct cli_cameras cameras;

    cli_cameras_list(&places, &cameras);
    assert_int_equal(cameras.n, 0);
    put_file(*state, "cameras/D435.ini", "[depth]\n");
    put_file(*state, "cameras/D435i.ini", "[depth]\n");
    put_file(*state, "cameras/other.ini", "# USB id 1d27:0601\n[depth]\n");
    put_file(*state, "cameras/README", "8086:0b07");
    cli_cameras_list(&places, &cameras);
    assert_int_equal(cameras.n, 3);
    assert_string_equal(cli_cameras_find(&cameras, "8086:0b07"),
                        scratch_path(*state, "cameras/D435.ini"));
    assert_string_equal(cli_cameras_find(&cameras, "8086:0b3a"),
                        scratch_path(*state, "cameras/D435i.ini"));
    assert_string_equal(cli_cameras_find(&cameras, "1d27:0601"),
                        scratch_path(*state, "cameras/other.ini"));
    assert_null(cli_cameras_find(&cameras, "8086:0b5c"));
    assert_null(cli_cameras_find(&cameras, ""));
}

static void only_depth_cameras_are_candidates(void **state)
{
    const struct cli_setup_places places = make_machine(*state);
    static struct cli_devices devices;
    static struct cli_candidates candidates;
    char lines[1024];

    (void)snprintf(
        lines, sizeof lines,
        "{\"sensor\":\"v4l2\",\"id\":\"%s\",\"label\":\"D435 at usb: Z16\",\"kind\":\"depth\"}\n"
        "{\"sensor\":\"v4l2\",\"id\":\"/dev/video7\",\"label\":\"Webcam at usb: YUYV\"}"
        "\n[0:1] a log line {\n"
        "{\"sensor\":\"v4l2-stereo\",\"id\":\"/dev/video7\",\"label\":\"Webcam\"}\n"
        "{\"sensor\":\"libcamera-stereo\",\"id\":\"/base/a\",\"label\":\"imx296\"}\n"
        "{\"sensor\":\"libcamera-stereo\",\"id\":\"/base/b\",\"label\":\"imx296\"}\n"
        "{\"sensor\":\"openni2\",\"id\":\"2bc5/0401@1/5\",\"label\":\"Orbbec Astra\"}\n"
        "{\"sensor\":\"libcamera\",\"fault\":\"it cannot\"}\n",
        scratch_path(*state, "dev/video4"));
    devices = (struct cli_devices){0};
    cli_devices_parse(lines, &devices);
    assert_int_equal(devices.n, 6);
    assert_string_equal(devices.fault, "libcamera: it cannot");
    cli_candidates_find(&places, &devices, "[sensor]\nbackend = openni2\n", &candidates);
    assert_int_equal(candidates.n, 2);
    assert_string_equal(candidates.items[0].sensor.backend, "v4l2");
    assert_string_equal(cli_sensor_word_get(&candidates.items[0].sensor, "device"),
                        scratch_path(*state, "dev/v4l/by-path/usb-2-index0"));
    assert_string_equal(candidates.items[1].sensor.backend, "openni2");
    assert_int_equal(candidates.items[1].sensor.n_options, 0);
    cli_candidates_find(&places, &devices, "[sensor]\nbackend = libcamera-stereo\n", &candidates);
    assert_int_equal(candidates.n, 3);
    assert_string_equal(candidates.items[2].sensor.backend, "libcamera-stereo");
    /* Names from the board's udev rules are preferred to other names. */
    assert_int_equal(symlink("video4", scratch_path(*state, "dev/isotherm-depth")), 0);
    assert_int_equal(symlink("video6", scratch_path(*state, "dev/isotherm-ir")), 0);
    cli_candidates_find(&places, &devices, "", &candidates);
    assert_string_equal(cli_sensor_word_get(&candidates.items[0].sensor, "device"),
                        scratch_path(*state, "dev/isotherm-depth"));
    assert_string_equal(cli_sensor_word_get(&candidates.items[0].sensor, "ir_device"),
                        scratch_path(*state, "dev/isotherm-ir"));
}

static const char *only_board_here(const struct cli_setup_places *places)
{
    static struct cli_boards boards;
    struct cli_fault fault = {0};
    const char *found = "none";

    assert_int_equal(cli_boards_find(places, &boards, &fault), CLI_EXIT_OK);
    for (size_t i = 0; i < boards.n; i++) {
        if (boards.items[i].here) {
            assert_string_equal(found, "none");
            found = boards.items[i].name;
        }
    }
    return found;
}

static void a_board_is_recognised_by_the_files_of_the_machine(void **state)
{
    const struct cli_setup_places places = make_machine(*state);

    assert_string_equal(only_board_here(&places), "none");
    put_file(*state, "sys/bus/usb/devices/1-3/idVendor", "10c4\n");
    put_file(*state, "sys/bus/usb/devices/1-3/idProduct", "ea90\n");
    assert_string_equal(only_board_here(&places), "pc-usb");
    put_file(*state, "sys/bus/usb/devices/1-3/idProduct", "ea60\n");
    put_file(*state, "sys/class/dmi/id/sys_vendor", "QEMU\n");
    assert_string_equal(only_board_here(&places), "qemu");
    put_file(*state, "sys/class/dmi/id/sys_vendor", "Not QEMU\n");
    put_file(*state, "sys/firmware/devicetree/base/model", "Raspberry Pi 5 Model B Rev 1.0");
    assert_string_equal(only_board_here(&places), "raspberry-pi-5");
    put_file(*state, "sys/firmware/devicetree/base/model", "Radxa ROCK 5B");
    assert_string_equal(only_board_here(&places), "rock-5b");
}

static void without_boards_there_is_no_board(void **state)
{
    const struct cli_setup_places places = {.boards = *state, .sys = *state};
    struct cli_boards boards;
    struct cli_fault fault = {0};

    assert_int_equal(cli_boards_find(&places, &boards, &fault), CLI_EXIT_NOT_FOUND);
    assert_non_null(strstr(fault.text, *state));
}

#define IN_SCRATCH(test) cmocka_unit_test_setup_teardown(test, scratch_setup, scratch_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        IN_SCRATCH(a_file_is_replaced_as_a_whole_and_can_be_put_back),
        IN_SCRATCH(a_file_that_cannot_be_written_is_named),
        cmocka_unit_test(a_programs_words_are_kept),
        IN_SCRATCH(a_camera_is_known_by_its_usb_id_and_a_name_that_lasts),
        IN_SCRATCH(the_description_of_a_camera_is_found_by_its_usb_id),
        IN_SCRATCH(only_depth_cameras_are_candidates),
        IN_SCRATCH(a_board_is_recognised_by_the_files_of_the_machine),
        IN_SCRATCH(without_boards_there_is_no_board),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
