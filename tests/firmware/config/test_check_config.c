/* `isothermd --check-config` and a start of the daemon refuse the same configurations with the same
 * line and exit code, and accept the same ones. The tests run both as programs, on a private bus.
 */
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/support/programs/private_bus.h"
#include "tests/support/programs/run.h"
#include "tests/support/scratch.h"

#define PROGRAM ISOTHERM_BINARY_DIR "/firmware/isothermd"
#define DATA    ISOTHERM_SOURCE_DIR "/core/data"

enum { SILENCE_MS = 20000, TEXT_SIZE = 16384 };

static struct private_bus bus;

/* The text of each section; NULL: a valid one. "$D" stands for the test's directory. */
struct sections {
    const char *sensor, *door, *stores, *bus, *model, *more;
};

/* Appends `text` to `out`, with the directory in place of each "$D". */
static void append(char out[TEXT_SIZE], const char *text, const char *directory)
{
    size_t length = strlen(out);
    for (const char *at = text; *at && length + 200 < TEXT_SIZE;) {
        if (at[0] == '$' && at[1] == 'D') {
            length += (size_t)sprintf(out + length, "%s", directory);
            at += 2;
        } else {
            out[length++] = *at++;
        }
    }
    out[length] = '\0';
}

static const char *or_sound(const char *text, const char *sound)
{
    return text ? text : sound;
}

static const char *write_configuration(const char *directory, const struct sections *sections)
{
    static char text[TEXT_SIZE];
    char address[512];
    const char *path = scratch_path(directory, "c.conf");
    text[0] = '\0';
    (void)snprintf(address, sizeof address, "[bus]\naddress = %s\n", bus.address);
    append(text, or_sound(sections->sensor, "[sensor]\npath = $D/slot\n"), directory);
    append(text, or_sound(sections->door, ""), directory);
    append(text, or_sound(sections->stores, "[gallery]\npath = $D/g.db\n[log]\npath = $D/a.log\n"),
           directory);
    append(text, or_sound(sections->bus, address), directory);
    append(text,
           or_sound(sections->model,
                    "[model]\nhead = " DATA "/head.model\nmetric = " DATA "/face.metric\n"),
           directory);
    append(text, or_sound(sections->more, ""), directory);
    scratch_write_text(path, text);
    return path;
}

/* ---- invalid configurations ---- */

static const struct {
    int exit;
    const char *line; /* the line has this text in it */
    struct sections sections;
} wrong[] = {
    {3,
     "no sensor 'kinect9'; there are: replay",
     {.sensor = "[sensor]\nbackend = kinect9\npath = $D/slot\n"}},
    {2, "sensor replay: option 'path' is missing", {.sensor = "[sensor]\n"}},
    {2,
     "c.conf:3: bad value 'maybe' for 'loop' (no|yes)",
     {.sensor = "[sensor]\npath = $D/slot\nloop = maybe\n"}},
    {2,
     "c.conf:3: bad value 'slow' for 'pace' (realtime|asap)",
     {.sensor = "[sensor]\npath = $D/slot\npace = slow\n"}},
#ifdef ISOTHERM_V4L2
    {2,
     "c.conf:3: the sensor replay has no option 'ir_device'; back ends that have it: v4l2",
     {.sensor = "[sensor]\npath = $D/slot\nir_device = /dev/video0\n"}},
#endif
    {3, "no door 'gate'; there are: null", {.door = "[door]\nbackend = gate\n"}},
#ifdef ISOTHERM_WITH_GPIOD
    {2,
     "c.conf:4: the door null has no option 'relay'; back ends that have it: gpiod",
     {.door = "[door]\nrelay = foo:bar\n"}},
#endif
    {2,
     "c.conf:3: unknown key 'record' in [sensor]",
     {.sensor = "[sensor]\npath = $D/slot\nrecord = $D/r.oni\n"}},
    {3,
     "/nonexistent/head.model: No such file",
     {.model = "[model]\nhead = /nonexistent/head.model\n"}},
    {3,
     "$D/none.metric: No such file",
     {.model = "[model]\nhead = " DATA "/head.model\nmetric = $D/none.metric\n"}},
    {4,
     "cohort.templates: ",
     {.model = "[model]\nhead = " DATA "/head.model\nmetric = " DATA "/cohort.templates\n"}},
    {3,
     "$D/none.templates: No such file",
     {.model = "[model]\nhead = " DATA "/head.model\ncohort = $D/none.templates\n",
      .more = "[match]\nmethod = distance\n"}},
    {3, "$D/cards: No such file", {.door = "[door]\ncards = $D/cards\n"}},
    {4, "$D/wrong-cards:1: ", {.door = "[door]\ncards = $D/wrong-cards\n"}},
    {3,
     "[gallery] path $D/away/g.db: the directory $D/away/: No such file",
     {.stores = "[gallery]\npath = $D/away/g.db\n[log]\npath = $D/a.log\n"}},
    {3,
     "[log] path $D/away/a.log: the directory $D/away/: No such file",
     {.stores = "[gallery]\npath = $D/g.db\n[log]\npath = $D/away/a.log\n"}},
    {3,
     "[lockout] path $D/away/lockout: the directory $D/away/: No such file",
     {.more = "[lockout]\npath = $D/away/lockout\n"}},
    {3,
     "[seal] key $D/away/key: the directory $D/away/: No such file",
     {.more = "[seal]\nkey = $D/away/key\n"}},
    {2, "bus 'sytem': not system, session or an address", {.bus = "[bus]\naddress = sytem\n"}},
    {2, "unknown key 'colour' in [door]", {.door = "[door]\ncolour = 1\n"}},
    {2, "bad value 'often' for 'poll_ms'", {.door = "[door]\npoll_ms = often\n"}},
    {2,
     "[sensor] retry_ms is above retry_max_ms",
     {.sensor = "[sensor]\npath = $D/slot\nretry_ms = 500\nretry_max_ms = 100\n"}},
#ifdef ISOTHERM_WITH_GPIOD
    {2, "door gpiod: option 'relay' is missing", {.door = "[door]\nbackend = gpiod\n"}},
    {2,
     "c.conf:5: relay: 'foo:70000' is not a line",
     {.door = "[door]\nbackend = gpiod\nrelay = foo:70000\n"}},
    {2,
     "c.conf:5: relay: 'sideways' in 'GPIO17 sideways' is unknown",
     {.door = "[door]\nbackend = gpiod\nrelay = GPIO17 sideways\n"}},
    {2,
     "c.conf:6: contact: '",
     {.door = "[door]\nbackend = gpiod\nrelay = GPIO17\ncontact = "
              "chip:70000\n"}},
    {2,
     "c.conf:6: bad value 'long' for 'debounce_ms' (a whole number, 0 to 1000)",
     {.door = "[door]\nbackend = gpiod\nrelay = GPIO17\ndebounce_ms = long\n"}},
    {2,
     "c.conf:6: bad value '27' for 'wiegand_bits' (26|34)",
     {.door = "[door]\nbackend = gpiod\nrelay = GPIO17\nwiegand_bits = 27\n"}},
    {2,
     "door gpiod: option 'wiegand_d1' is missing",
     {.door = "[door]\nbackend = gpiod\nwiegand_d0 = GPIO1\n"}},
#endif
#ifdef ISOTHERM_V4L2
    {2,
     "sensor v4l2: option 'camera' is missing",
     {.sensor = "[sensor]\nbackend = v4l2\ndevice = /dev/video99\n"}},
    {3,
     "$D/none.ini: No such file",
     {.sensor = "[sensor]\nbackend = v4l2\ndevice = /dev/video99\ncamera = $D/none.ini\n"}},
    {2,
     "$D/half.ini: ",
     {.sensor = "[sensor]\nbackend = v4l2\ndevice = /dev/video99\ncamera = $D/half.ini\n"}},
    {2,
     "c.conf:5: bad value 'many' for 'fps' (a number, 1 to 1000)",
     {.sensor = "[sensor]\nbackend = v4l2\ndevice = /dev/video99\ncamera = $D/camera.ini\n"
                "fps = many\n"}},
#endif
#ifdef ISOTHERM_STEREO
    {2,
     "sensor v4l2-stereo: option 'right' is missing",
     {.sensor = "[sensor]\nbackend = v4l2-stereo\nleft = /dev/video98\n"}},
    {3,
     "$D/none.ini: No such file",
     {.sensor = "[sensor]\nbackend = v4l2-stereo\nleft = /dev/video98\nright = /dev/video99\n"
                "calibration = $D/none.ini\n"}},
    {2,
     "c.conf:6: bad value 'soon' for 'near_mm' (a number, 100 to 10000)",
     {.sensor = "[sensor]\nbackend = v4l2-stereo\nleft = /dev/video98\nright = /dev/video99\n"
                "calibration = $D/rig.ini\nnear_mm = soon\n"}},
#endif
#ifdef ISOTHERM_OPENNI2
    {2,
     "c.conf:3: bad value 'inch' for 'unit' (finest|100um|1mm)",
     {.sensor = "[sensor]\nbackend = openni2\nunit = inch\n"}},
    {2,
     "c.conf:3: mode: 'large' is not WIDTHxHEIGHT@HZ",
     {.sensor = "[sensor]\nbackend = openni2\nmode = large\n"}},
    {2,
     "c.conf:3: intrinsics: focal length",
     {.sensor = "[sensor]\nbackend = openni2\nintrinsics = 5 5 320 240\n"}},
    {2,
     "options 'path' and 'device' exclude each other",
     {.sensor = "[sensor]\nbackend = openni2\npath = $D/a.oni\ndevice = 1\n"}},
    {3,
     "$D/none.ini: No such file",
     {.sensor = "[sensor]\nbackend = openni2\ncamera = $D/none.ini\n"}},
    {2,
     "options 'camera' and 'intrinsics' exclude each other",
     {.sensor = "[sensor]\nbackend = openni2\ncamera = $D/camera.ini\n"
                "intrinsics = 570 570 320 240\n"}},
#endif
};

static const char camera_ini[] = "[recording]\nformat = 1\nsensor = d435\n[depth]\n"
                                 "projection = pinhole\nwidth_px = 848\nheight_px = 480\n"
                                 "fx_px = 425\nfy_px = 425\ncx_px = 424\ncy_px = 240\n"
                                 "nominal = yes\nunit_mm = 1\n";

#define EYE "width_px = 640\nheight_px = 480\nfx_px = 600\nfy_px = 600\ncx_px = 320\ncy_px = 240\n"

static const char rig_ini[] = "[stereo]\nformat = 1\npairs = 0\nrms_px = 0\n[left]\n" EYE
                              "[right]\n" EYE "[right_from_left]\nrx_rad = 0\nry_rad = 0\n"
                              "rz_rad = 0\ntx_mm = -60\nty_mm = 0\ntz_mm = 0\n";

static void write_files(const char *directory)
{
    scratch_write_text(scratch_path(directory, "wrong-cards"), "17 x anna\n");
    scratch_write_text(scratch_path(directory, "half.ini"), "[recording]\nformat = 1\n");
    scratch_write_text(scratch_path(directory, "camera.ini"), camera_ini);
    scratch_write_text(scratch_path(directory, "rig.ini"), rig_ini);
}

static void run_both(const char *path, struct run *check, struct run *start)
{
    const char *const check_argv[] = {PROGRAM, "--check-config", "--config", path, NULL};
    const char *const start_argv[] = {PROGRAM, "--config", path, NULL};
    run_start(check, check_argv);
    run_finish(check);
    run_start(start, start_argv);
    run_finish(start);
}

static void refuses_what_the_start_refuses(void **state)
{
    write_files(*state);
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        struct run check, start;
        char line[TEXT_SIZE] = "";
        append(line, wrong[i].line, *state);
        run_both(write_configuration(*state, &wrong[i].sections), &check, &start);
        if (check.exit != wrong[i].exit || !strstr(check.err, line) || *check.out) {
            fail_msg("case %zu: not exit %d with '%s', but %d and: %s%s", i, wrong[i].exit, line,
                     check.exit, check.err, check.out);
        }
        if (start.exit != check.exit || strcmp(start.err, check.err) != 0) {
            fail_msg("case %zu: check says %d %s but the start %d %s", i, check.exit, check.err,
                     start.exit, start.err);
        }
        run_free(&check);
        run_free(&start);
    }
}

/* ---- valid configurations ---- */

static int listen_for_notifications(const char *path)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    const int fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    assert_true(fd >= 0);
    (void)snprintf(address.sun_path, sizeof address.sun_path, "%s", path);
    assert_int_equal(bind(fd, (const struct sockaddr *)&address, sizeof address), 0);
    return fd;
}

/* Starts the daemon, waits for READY=1, and ends it. */
static void expect_start(const char *name, const char *path, const char *directory)
{
    const char *const argv[] = {PROGRAM, "--config", path, NULL};
    const char *where = scratch_path(directory, "notify");
    struct run run;
    char text[256] = "";
    (void)unlink(where);
    const int fd = listen_for_notifications(where);
    struct pollfd ready = {.fd = fd, .events = POLLIN};
    assert_int_equal(setenv("NOTIFY_SOCKET", where, 1), 0);
    run_start(&run, argv);
    const bool came = poll(&ready, 1, SILENCE_MS) == 1 && recv(fd, text, sizeof text - 1, 0) > 0 &&
                      strncmp(text, "READY=1", 7) == 0;
    (void)kill(run.pid, SIGTERM);
    run_finish(&run);
    if (!came || run.exit != 0) {
        fail_msg("%s: does not start: exit %d, %s", name, run.exit, run.err);
    }
    run_free(&run);
    (void)unsetenv("NOTIFY_SOCKET");
    (void)close(fd);
}

/* Expects that the check accepts a configuration and creates no file, and that the daemon starts
 * with it. `name` is the name of the directory for the stores. Back ends that this build does not
 * have are left out. */
static void expect_sound(const char *name, const char *sensor_and_door, const char *directory)
{
    char stores[512];
    (void)snprintf(stores, sizeof stores,
                   "[gallery]\npath = $D/%s/g.db\n[log]\npath = $D/%s/a.log\n", name, name);
    const struct sections sections = {.sensor = sensor_and_door, .stores = stores};
    const char *path = write_configuration(directory, &sections);
    const char *const argv[] = {PROGRAM, "--check-config", "--config", path, NULL};
    struct run run;
    scratch_mkdir(scratch_path(directory, name));
    run_start(&run, argv);
    run_finish(&run);
    if (strstr(run.err, "no sensor '") || strstr(run.err, "no door '")) {
        print_message("%s: not in this build: %s", name, run.err);
    } else if (run.exit != 0 || !strstr(run.out, "/c.conf: sound\n")) {
        fail_msg("%s: exit %d, %s", name, run.exit, run.err);
    } else {
        (void)snprintf(stores, sizeof stores, "%s/%s/g.db", directory, name);
        assert_false(scratch_exists(stores)); /* a check creates no file */
        expect_start(name, path, directory);
    }
    run_free(&run);
}

/* Reads a board's file. The calibration that an installer would make in /etc is replaced by one in
 * the test's directory. */
static void read_board(const char *name, char text[TEXT_SIZE])
{
    static const char calibration[] = "/etc/isotherm/stereo.ini";
    char path[256];
    size_t size;
    (void)snprintf(path, sizeof path, ISOTHERM_SOURCE_DIR "/board/%s/isotherm.conf", name);
    char *bytes = scratch_read(path, &size);
    char *copy = strndup(bytes, size);
    char *at = strstr(copy, calibration);
    (void)snprintf(text, TEXT_SIZE, "%.*s%s%s", at ? (int)(at - copy) : (int)size, copy,
                   at ? "$D/rig.ini" : "", at ? at + strlen(calibration) : "");
    free(copy);
    free(bytes);
}

/* The devices of the boards are not connected here. A missing device is no fault of the
 * configuration. */
static void accepts_the_boards(void **state)
{
    static const char *const boards[] = {"pc-usb", "qemu", "raspberry-pi-5", "rock-5b"};
    static char text[TEXT_SIZE];
    write_files(*state);
    for (size_t i = 0; i < sizeof boards / sizeof *boards; i++) {
        read_board(boards[i], text);
        expect_sound(boards[i], text, *state);
    }
}

static void accepts_what_works(void **state)
{
    write_files(*state);
    expect_sound("replay", "[sensor]\npath = $D/slot\n", *state);
    expect_sound("v4l2",
                 "[sensor]\nbackend = v4l2\ndevice = /dev/video99\ncamera = $D/camera.ini\n",
                 *state);
    expect_sound("openni2", "[sensor]\nbackend = openni2\ncamera = $D/camera.ini\n", *state);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(refuses_what_the_start_refuses, scratch_setup,
                                        scratch_teardown),
        cmocka_unit_test_setup_teardown(accepts_the_boards, scratch_setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(accepts_what_works, scratch_setup, scratch_teardown),
    };
    if (!private_bus_start(&bus)) {
        (void)puts("no dbus-daemon");
        return TEST_SKIPPED;
    }
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    private_bus_stop(&bus);
    return failed;
}
