/* gpio_line.c, and the door on it, with lines of the kernel: behaviour that only a kernel has. */
#include <errno.h>
#include <poll.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#include "drivers/base/times.h"
#include "drivers/door/door_io.h"
#include "drivers/door/gpio_line.h"
#include "tests/support/child_end.h"
#include "tests/vm/gpio/gpio_sim.h"

enum { REMOVALS = 20, NOBODY = 65534, PATIENCE_MS = 10000 };

static const struct iso_door_outputs unpowered;

static struct iso_gpio_spec spec_of(const char *text)
{
    struct iso_gpio_spec spec;
    assert_int_equal(iso_gpio_spec_parse("test", text, &spec, NULL), 0);
    return spec;
}

static struct iso_gpio_line *open_line(const char *text, bool output)
{
    const struct iso_gpio_spec spec = spec_of(text);
    struct iso_gpio_line *line = NULL;
    struct iso_fault fault = {.text = ""};
    if (output ? iso_gpio_line_open_output(&spec, false, &line, &fault)
               : iso_gpio_line_open_input(&spec, &line, &fault)) {
        fail_msg("%s", fault.text);
    }
    return line;
}

static void does_not_open(const char *text, int error, const char *why)
{
    const struct iso_gpio_spec spec = spec_of(text);
    struct iso_gpio_line *line = NULL;
    struct iso_fault fault = {.text = ""};
    assert_int_equal(iso_gpio_line_open_input(&spec, &line, &fault), error);
    if (!strstr(fault.text, why)) {
        fail_msg("'%s' lacks '%s'", fault.text, why);
    }
    assert_null(line);
}

/* ---- finding and claiming ---- */

static void finds_lines_every_way(void **state)
{
    char by_chip[64], by_path[64];
    (void)state;
    (void)snprintf(by_chip, sizeof by_chip, "%s:3", gpio_sim_chip("door"));
    (void)snprintf(by_path, sizeof by_path, "/dev/%s:3", gpio_sim_chip("door"));
    const char *const ways[] = {"door:3", "LINE3", by_chip, by_path};
    for (size_t i = 0; i < sizeof ways / sizeof *ways; i++) {
        struct iso_gpio_line *line = open_line(ways[i], true);
        assert_int_equal(iso_gpio_line_set(line, i % 2 == 0), 0);
        assert_int_equal(gpio_sim_voltage("door", 3), i % 2 == 0);
        iso_gpio_line_close(line);
    }
}

static void says_what_is_not_there(void **state)
{
    (void)state;
    does_not_open("door:10", -ENODEV, "line door:10: the chip has no such line");
    does_not_open("gate:1", -ENODEV, "line gate:1: no such GPIO chip");
    does_not_open("LINE10", -ENODEV, "line 'LINE10': no GPIO chip has such a line");
}

static void refuses_names_that_are_taken_twice(void **state)
{
    (void)state;
    gpio_sim_make("double", "LINE");
    does_not_open("LINE3", -EINVAL, "line 'LINE3': more than one line has this name");
    gpio_sim_remove("double");
    iso_gpio_line_close(open_line("LINE3", false));
}

static void says_who_has_a_line(void **state)
{
    struct iso_gpio_line *line = open_line("LINE3", true);
    (void)state;
    does_not_open("door:3", -EBUSY, "line door:3: in use by 'isotherm'");
    iso_gpio_line_close(line);
    iso_gpio_line_close(open_line("door:3", false));
}

/* Opens the line in another process, as a user without the permission. */
static void says_that_the_permission_is_missing(void **state)
{
    char path[64];
    int status = -1;
    (void)state;
    (void)snprintf(path, sizeof path, "/dev/%s", gpio_sim_chip("door"));
    assert_int_equal(chmod(path, 0600), 0);
    const pid_t pid = fork();
    assert_true(pid >= 0);
    if (pid == 0) {
        const struct iso_gpio_spec by_offset = spec_of("door:3"), by_name = spec_of("LINE3");
        struct iso_gpio_spec by_path = {.offset = 3};
        struct iso_gpio_line *line = NULL;
        (void)snprintf(by_path.chip, sizeof by_path.chip, "%.60s", path);
        int wrong = setgid(NOBODY) || setuid(NOBODY);
        wrong |= iso_gpio_line_open_input(&by_path, &line, NULL) == -EACCES ? 0 : 2;
        wrong |= iso_gpio_line_open_input(&by_name, &line, NULL) == -EACCES ? 0 : 4;
        /* The label of a chip can be read only after opening the chip, so this user does not find
         * it. */
        const int error = iso_gpio_line_open_input(&by_offset, &line, NULL);
        wrong |= error == -EACCES || error == -ENODEV ? 0 : 8;
        _exit(wrong);
    }
    assert_int_equal(waitpid(pid, &status, 0), pid);
    child_expect_code("a user without rights, who opens lines", child_code(status), 0, NULL, NULL);
}

/* ---- levels and edges ---- */

static void wait_for_edge(const struct iso_gpio_line *line)
{
    struct pollfd poll_fd = {.fd = iso_gpio_line_fd(line), .events = POLLIN};
    assert_int_equal(poll(&poll_fd, 1, PATIENCE_MS), 1);
}

static void edges_have_the_monotonic_time(void **state)
{
    const struct iso_times times = iso_times_system();
    struct iso_gpio_line *line = open_line("door:5 active-low", false);
    struct iso_gpio_edge edge = {.t_ns = -1};
    bool active = true;
    (void)state;
    gpio_sim_pull("door", 5, true);
    while (iso_gpio_line_next_edge(line, &edge) == 0) {
    }
    assert_int_equal(iso_gpio_line_get(line, &active), 0);
    assert_false(active);
    for (int i = 0; i < 6; i++) {
        const int64_t before_ns = iso_times_now_ns(&times);
        assert_int_equal(iso_gpio_line_next_edge(line, &edge), -EAGAIN);
        gpio_sim_pull("door", 5, i % 2 != 0);
        wait_for_edge(line);
        assert_int_equal(iso_gpio_line_next_edge(line, &edge), 0);
        assert_int_equal(edge.active, i % 2 == 0);
        assert_in_range(edge.t_ns, before_ns, iso_times_now_ns(&times));
    }
    iso_gpio_line_close(line);
}

/* ---- the end of a process ---- */

/* A process is killed while the relay of its door is on: the driver of the chip decides the level
 * of the line. With gpio-sim the line returns to its pull; other chips keep the level, which is why
 * `isothermd --rest-door` exists. In both cases another process can open the line. */
static void a_killed_process_releases_its_lines(void **state)
{
    const struct iso_option relay = {"relay", "door:0"};
    const struct iso_times times = iso_times_system();
    struct iso_door_io *io = NULL;
    int status = -1, ready[2];
    char byte;
    (void)state;
    gpio_sim_pull("door", 0, false);
    assert_int_equal(pipe(ready), 0);
    const pid_t pid = fork();
    assert_true(pid >= 0);
    if (pid == 0) {
        const struct iso_door_outputs powered = {{[ISO_DOOR_RELAY] = true}};
        if (iso_door_io_open("gpiod", &relay, 1, &times.monotonic, &powered, &io, NULL) == 0) {
            (void)!write(ready[1], "", 1);
        }
        (void)pause();
        _exit(0);
    }
    assert_int_equal(read(ready[0], &byte, 1), 1);
    assert_true(gpio_sim_voltage("door", 0));
    assert_int_equal(iso_door_io_open("gpiod", &relay, 1, &times.monotonic, &unpowered, &io, NULL),
                     -EBUSY);
    assert_int_equal(kill(pid, SIGKILL), 0);
    assert_int_equal(waitpid(pid, &status, 0), pid);
    assert_true(WIFSIGNALED(status));
    assert_false(gpio_sim_voltage("door", 0));
    assert_int_equal(iso_door_io_open("gpiod", &relay, 1, &times.monotonic, &unpowered, &io, NULL),
                     0);
    iso_door_io_close(io);
}

/* ---- chips that are unplugged ---- */

static const struct iso_option wiring[] = {
    {"relay", "LINE0"}, {"contact", "LINE5"}, {"exit_button", "LINE6"}, {"debounce_ms", "0"}};

enum { WIRED = sizeof wiring / sizeof *wiring };

static int count_descriptors(void)
{
    int n = 0;
    for (int fd = 0; fd < 256; fd++) {
        char path[32], target[8];
        (void)snprintf(path, sizeof path, "/proc/self/fd/%d", fd);
        n += readlink(path, target, sizeof target) >= 0;
    }
    return n;
}

/* The next call reports the fault, and does not hang or spin. The lines work again when the chip is
 * plugged in again. Linux 6.1 does not wake a process that waits for an edge of an unplugged chip,
 * so the appliance reads its lines every poll_ms. */
static void lose_and_find(struct iso_door_io *io, int round)
{
    struct iso_door_inputs inputs;
    struct iso_fault fault = {.text = ""};
    const bool by_output = round % 2 == 0;
    assert_int_equal(iso_door_io_get_inputs(io, &inputs, NULL), 0);
    gpio_sim_plug("door", false);
    if (by_output) {
        assert_int_equal(iso_door_io_set_output(io, ISO_DOOR_RELAY, true, &fault), -ENODEV);
    } else {
        assert_int_equal(iso_door_io_get_inputs(io, &inputs, &fault), -ENODEV);
    }
    assert_non_null(strstr(fault.text, "door gpiod: relay: No such device"));
    assert_true(iso_door_io_is_lost(io));
    assert_int_equal(iso_door_io_reopen(io, &unpowered, &fault), -ENODEV);
    assert_non_null(strstr(fault.text, "relay: line 'LINE0': no GPIO chip has such a line"));
    gpio_sim_plug("door", true);
    if (iso_door_io_reopen(io, &unpowered, &fault)) {
        fail_msg("%s", fault.text);
    }
    assert_int_equal(iso_door_io_set_output(io, ISO_DOOR_RELAY, true, NULL), 0);
    assert_true(gpio_sim_voltage("door", 0));
    assert_int_equal(iso_door_io_set_output(io, ISO_DOOR_RELAY, false, NULL), 0);
    assert_false(gpio_sim_voltage("door", 0));
}

static void a_chip_is_unplugged_and_plugged_in_again(void **state)
{
    const struct iso_times times = iso_times_system();
    struct iso_door_io *io = NULL;
    int descriptors = 0;
    (void)state;
    assert_int_equal(
        iso_door_io_open("gpiod", wiring, WIRED, &times.monotonic, &unpowered, &io, NULL), 0);
    for (int i = 0; i < REMOVALS; i++) {
        lose_and_find(io, i);
        descriptors = i == 0 ? count_descriptors() : descriptors;
    }
    assert_int_equal(count_descriptors(), descriptors);
    print_message("%d removals, each detected and repaired\n", REMOVALS);
    iso_door_io_close(io);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(finds_lines_every_way),
        cmocka_unit_test(says_what_is_not_there),
        cmocka_unit_test(refuses_names_that_are_taken_twice),
        cmocka_unit_test(says_who_has_a_line),
        cmocka_unit_test(says_that_the_permission_is_missing),
        cmocka_unit_test(edges_have_the_monotonic_time),
        cmocka_unit_test(a_killed_process_releases_its_lines),
        cmocka_unit_test(a_chip_is_unplugged_and_plugged_in_again),
    };
    gpio_sim_make("door", "LINE");
    return cmocka_run_group_tests(tests, NULL, NULL);
}
