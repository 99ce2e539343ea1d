/* The program isothermd: its options, its exit codes, one clear line for each fault that keeps it
 * from starting, and its notifications for the service manager. */
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/support/programs/private_bus.h"
#include "tests/support/programs/run.h"
#include "tests/support/scratch.h"

#define PROGRAM ISOTHERM_BINARY_DIR "/firmware/isothermd"
#define DATA    ISOTHERM_SOURCE_DIR "/core/data"

enum { SILENCE_MS = 10000 };

/* ---- running it ---- */

/* Runs the program with one or two options until it ends. The result is valid until the next run.
 */
static const struct run *run_program(const char *option, const char *value)
{
    static struct run run;
    const char *const argv[] = {PROGRAM, option, value, NULL};
    run_free(&run);
    run_start(&run, argv);
    run_finish(&run);
    return &run;
}

/* Writes a configuration that works if there is this bus. `more` is its end. Returns its path. */
static const char *write_configuration(const char *directory, const char *bus, const char *more)
{
    static char text[2048];
    const char *path = scratch_path(directory, "c.conf");
    (void)snprintf(text, sizeof text,
                   "[sensor]\npath = %s/slot\n"
                   "[gallery]\npath = %s/g.db\n[log]\npath = %s/a.log\n[bus]\naddress = %s\n"
                   "[model]\nhead = " DATA "/head.model\nmetric = " DATA "/face.metric\n%s\n",
                   directory, directory, directory, bus, more);
    scratch_write_text(path, text);
    return path;
}

static void expect_end(const struct run *run, int exit, const char *line)
{
    const char *newline = strchr(run->err, '\n');
    run_expect(run, exit);
    if (!strstr(run->err, line)) {
        fail_msg("'%s' is not in: %s", line, run->err);
    }
    if (exit != 0) {
        assert_non_null(newline);
        assert_int_equal(newline[1], '\0'); /* there is only one line */
    }
}

/* ---- options ---- */

static void explains_itself(void **state)
{
    (void)state;
    const struct run *run = run_program("--help", NULL);
    run_expect(run, 0);
    assert_memory_equal(run->out, "Usage: isothermd", 16);
    run = run_program("--version", NULL);
    run_expect(run, 0);
    assert_memory_equal(run->out, "isothermd " ISOTHERM_VERSION "\nimage check: ",
                        strlen("isothermd " ISOTHERM_VERSION "\nimage check: "));
    assert_true(strstr(run->out, ": OpenCV ") || strstr(run->out, ": not installed\n"));
    run = run_program("--help-config", NULL);
    run_expect(run, 0);
    assert_non_null(strstr(run->out, "\n[decision]\n"));
}

/* The manual lists every option of the help, and no other. */
static void the_manual_has_its_options(void **state)
{
    size_t size;
    char *bytes = scratch_read(ISOTHERM_SOURCE_DIR "/enroll/man/isothermd.8", &size);
    char *manual = strndup(bytes, size), item[64];
    const struct run *run = run_program("--help", NULL);
    int in_help = 0, in_manual = 0;
    (void)state;
    for (const char *at = run->out; (at = strstr(at, "\n  --")); at++, in_help++) {
        const char *name = at + strlen("\n  --");
        (void)snprintf(item, sizeof item, "\n.It Fl Fl %.*s", (int)strcspn(name, " "), name);
        if (!strstr(manual, item)) {
            fail_msg("isothermd(8) does not have %s", item + 1);
        }
    }
    for (const char *at = manual; (at = strstr(at, "\n.It Fl Fl ")); at++) {
        in_manual++;
    }
    assert_int_equal(in_help, in_manual);
    free(manual);
    free(bytes);
}

static void refuses_a_wrong_command_line(void **state)
{
    (void)state;
    run_expect(run_program("--colour", NULL), 2);
    run_expect(run_program("--config", NULL), 2);
    const struct run *run = run_program("start", NULL);
    expect_end(run, 2, "isothermd: superfluous word 'start'");
}

static void checks_a_configuration(void **state)
{
    const char *const good = write_configuration(*state, "system", "");
    const char *const argv[] = {PROGRAM, "--check-config", "--config", good, NULL};
    struct run run;
    run_start(&run, argv);
    run_finish(&run);
    run_expect(&run, 0);
    assert_non_null(strstr(run.out, "/c.conf: sound\n"));
    assert_false(scratch_exists(scratch_path(*state, "g.db")));
    run_free(&run);
}

static void warns_of_an_obsolete_key(void **state)
{
    const char *const old = write_configuration(*state, "system", "[process]\nthreads = 2\n");
    const char *const argv[] = {PROGRAM, "--check-config", "--config", old, NULL};
    struct run run;
    run_start(&run, argv);
    run_finish(&run);
    expect_end(&run, 0, "/c.conf: [process] threads is obsolete and has no effect; remove it\n");
    assert_non_null(strstr(run.out, "/c.conf: sound\n"));
    run_free(&run);
}

/* ---- faults that keep it from starting ---- */

static void says_why_it_does_not_start(void **state)
{
    const char *path = write_configuration(*state, "unix:path=/nonexistent",
                                           "[door]\ncolour = 1\n");
    expect_end(run_program("--config", "/nonexistent/c.conf"), 3,
               "/nonexistent/c.conf: No such file or directory");
    expect_end(run_program("--config", path), 2, "/c.conf:13: unknown key 'colour' in [door]");

    path = write_configuration(*state, "unix:path=/nonexistent", "[door]\nbackend = gate\n");
    expect_end(run_program("--config", path), 3, "no door 'gate'; there are: null");

    path = write_configuration(*state, "unix:path=/nonexistent", "");
    expect_end(run_program("--config", path), 3,
               "bus 'unix:path=/nonexistent': No such file or directory");

    path = write_configuration(*state, "system", "");
    const char *const other_bus[] = {PROGRAM, "--config", path, "--bus", "unix:path=/elsewhere",
                                     NULL};
    struct run run;
    run_start(&run, other_bus);
    run_finish(&run);
    expect_end(&run, 3, "bus 'unix:path=/elsewhere': No such file or directory");
    run_free(&run);

    scratch_write_text(scratch_path(*state, "g.db"), "");
    expect_end(run_program("--config", path), 4, "/g.db: damaged (the file is empty)");
    (void)unlink(scratch_path(*state, "g.db"));
    scratch_write_text(scratch_path(*state, "a.log"), "nonsense\n");
    expect_end(run_program("--config", path), 4, "/a.log: has no header that is sound");
}

static void says_what_is_wrong_with_its_data(void **state)
{
    char text[1024];
    const char *path = scratch_path(*state, "d.conf");
    (void)snprintf(text, sizeof text,
                   "[model]\nhead = " DATA "/cohort.templates\n[gallery]\npath = %s/g.db\n",
                   (const char *)*state);
    scratch_write_text(path, text);
    expect_end(run_program("--config", path), 4, "/cohort.templates: ");
    scratch_write_text(path, "[model]\nhead = /nonexistent/head.model\n");
    expect_end(run_program("--config", path), 3, "/nonexistent/head.model: No such file");
}

/* ---- from the start to the end ---- */

static int listen_for_notifications(const char *path)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    const int fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    assert_true(fd >= 0);
    (void)snprintf(address.sun_path, sizeof address.sun_path, "%s", path);
    assert_int_equal(bind(fd, (const struct sockaddr *)&address, sizeof address), 0);
    return fd;
}

/* Waits for the next notification that begins with this text. It skips all others. */
static void expect_notification(struct run *run, int fd, const char *begin)
{
    char text[256];
    do {
        struct pollfd ready = {.fd = fd, .events = POLLIN};
        if (poll(&ready, 1, SILENCE_MS) != 1) {
            (void)kill(run->pid, SIGKILL);
            run_finish(run);
            fail_msg("'%s' never came; but: %s", begin, run->err);
        }
        const ssize_t length = recv(fd, text, sizeof text - 1, 0);
        assert_true(length > 0);
        text[length] = '\0';
    } while (strncmp(text, begin, strlen(begin)) != 0);
}

/* ---- the door's lines ---- */

#define NO_CHIP "[door]\nbackend = gpiod\nrelay = gpiochip4711:17\n"

static const struct run *rest_door(const char *path)
{
    static struct run run;
    const char *const argv[] = {PROGRAM, "--rest-door", "--config", path, NULL};
    run_free(&run);
    run_start(&run, argv);
    run_finish(&run);
    return &run;
}

static void skip_without_gpiod(const struct run *run)
{
    if (strstr(run->err, "no door 'gpiod'")) {
        print_message("built without libgpiod\n");
        skip();
    }
}

/* --rest-door uses the lines and opens no store. */
static void puts_the_door_to_rest(void **state)
{
    run_expect(rest_door(write_configuration(*state, "system", "")), 0);
    assert_false(scratch_exists(scratch_path(*state, "g.db")));
    assert_false(scratch_exists(scratch_path(*state, "a.log")));
    const char *path = write_configuration(*state, "system", "[door]\nbackend = gate\n");
    expect_end(rest_door(path), 3, "no door 'gate'");
    const struct run *run = rest_door(write_configuration(*state, "system", NO_CHIP));
    skip_without_gpiod(run);
    expect_end(run, 4, "door gpiod: relay: line gpiochip4711:17: no such GPIO chip");
    path = write_configuration(*state, "system", "[door]\nbackend = gpiod\n");
    expect_end(rest_door(path), 2, "door gpiod: option 'relay' is missing");
}

/* The lines may appear later. The door is at fault until then. */
static void starts_without_its_lines(void **state)
{
    struct private_bus bus;
    struct run run;
    skip_without_gpiod(rest_door(write_configuration(*state, "system", NO_CHIP)));
    if (!private_bus_start(&bus)) {
        print_message("no dbus-daemon\n");
        skip();
    }
    const int fd = listen_for_notifications(scratch_path(*state, "notify"));
    const char *path = write_configuration(*state, bus.address, NO_CHIP);
    const char *const argv[] = {PROGRAM, "--config", path, NULL};
    assert_int_equal(setenv("NOTIFY_SOCKET", scratch_path(*state, "notify"), 1), 0);
    run_start(&run, argv);
    expect_notification(&run, fd, "READY=1");
    assert_int_equal(kill(run.pid, SIGTERM), 0);
    run_finish(&run);
    run_expect(&run, 0);
    assert_non_null(strstr(run.err, "door fault (start): door gpiod: relay: line gpiochip4711:17: "
                                    "no such GPIO chip"));
    run_free(&run);
    (void)unsetenv("NOTIFY_SOCKET");
    (void)close(fd);
    private_bus_stop(&bus);
}

static void expect_mode(const char *path, mode_t mode)
{
    struct stat status;
    assert_int_equal(stat(path, &status), 0);
    assert_int_equal(status.st_mode & (S_IRWXU | S_IRWXG | S_IRWXO), mode);
}

/* The bus ends, but the daemon still controls the door. */
static void live_without_the_bus(const char *const argv[], int fd, struct private_bus *bus)
{
    struct run run;
    assert_int_equal(setenv("WATCHDOG_USEC", "200000", 1), 0);
    run_start(&run, argv);
    expect_notification(&run, fd, "READY=1");
    private_bus_stop(bus);
    expect_notification(&run, fd, "WATCHDOG=1");
    expect_notification(&run, fd, "WATCHDOG=1");
    assert_int_equal(kill(run.pid, SIGTERM), 0);
    run_finish(&run);
    run_expect(&run, 0);
    assert_non_null(strstr(run.err, "the bus is gone"));
    run_free(&run);
    (void)unsetenv("WATCHDOG_USEC");
}

static void expect_stop_in_the_log(const char *path)
{
    struct run run;
    const char *const print[] = {PROGRAM, "--config", path, "--print-log", NULL};
    run_start(&run, print);
    run_finish(&run);
    run_expect(&run, 0);
    assert_non_null(strstr(run.out, "\"event\":\"stop\""));
    run_free(&run);
}

static void starts_notifies_and_ends(void **state)
{
    struct private_bus bus;
    struct run run;
    if (!private_bus_start(&bus)) {
        print_message("no dbus-daemon\n");
        skip();
    }
    const int fd = listen_for_notifications(scratch_path(*state, "notify"));
    const char *path = write_configuration(*state, bus.address, "");
    const char *const argv[] = {PROGRAM, "--config", path, NULL};
    assert_int_equal(setenv("NOTIFY_SOCKET", scratch_path(*state, "notify"), 1), 0);
    assert_int_equal(setenv("WATCHDOG_USEC", "200000", 1), 0);
    const mode_t mask = umask(S_IRWXU); /* its files are private, whatever mask it inherits */
    run_start(&run, argv);
    (void)umask(mask);
    expect_notification(&run, fd, "READY=1");
    expect_notification(&run, fd, "WATCHDOG=1"); /* an idle sensor is alive */
    expect_notification(&run, fd, "WATCHDOG=1");
    assert_int_equal(kill(run.pid, SIGTERM), 0);
    expect_notification(&run, fd, "STOPPING=1");
    run_finish(&run);
    run_expect(&run, 0);
    run_free(&run);
    (void)unsetenv("WATCHDOG_USEC");
    expect_mode(scratch_path(*state, "g.db"), 0600);
    expect_mode(scratch_path(*state, "a.log"), 0600);
    live_without_the_bus(argv, fd, &bus);
    (void)unsetenv("NOTIFY_SOCKET");
    (void)close(fd);
    expect_stop_in_the_log(path);
}

/* A standard output that cannot be written is a fault. The daemon reports it in one line. */
static void reports_an_output_that_cannot_be_written(void **state)
{
    static const char *const options[] = {"--help", "--help-config", "--version"};
    (void)state;
    for (size_t i = 0; i < sizeof options / sizeof *options; i++) {
        const char *const argv[] = {PROGRAM, options[i], NULL};
        struct run run;
        run_start_to(&run, argv, "/dev/full");
        run_finish(&run);
        expect_end(&run, 4, "isothermd: standard output: No space left on device\n");
        run_free(&run);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(explains_itself),
        cmocka_unit_test(the_manual_has_its_options),
        cmocka_unit_test(refuses_a_wrong_command_line),
        cmocka_unit_test(reports_an_output_that_cannot_be_written),
        cmocka_unit_test_setup_teardown(checks_a_configuration, scratch_setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(warns_of_an_obsolete_key, scratch_setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(says_why_it_does_not_start, scratch_setup,
                                        scratch_teardown),
        cmocka_unit_test_setup_teardown(says_what_is_wrong_with_its_data, scratch_setup,
                                        scratch_teardown),
        cmocka_unit_test_setup_teardown(puts_the_door_to_rest, scratch_setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(starts_without_its_lines, scratch_setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(starts_notifies_and_ends, scratch_setup, scratch_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
