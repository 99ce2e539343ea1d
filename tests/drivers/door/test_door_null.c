/* The simulated door: its record and its inputs. */
#include <errno.h>
#include <poll.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "drivers/door/door_null.h"
#include "tests/support/devices/manual_clock.h"
#include "tests/support/scratch.h"

static int64_t now_ns;

static struct iso_door_io *open_null(const char *inputs)
{
    const struct iso_option option = {"inputs", inputs};
    const struct iso_door_outputs initial = {{[ISO_DOOR_RELAY] = true}};
    struct iso_clock clock = manual_clock(&now_ns);
    struct iso_door_io *io = NULL;
    assert_int_equal(iso_door_io_open("null", &option, inputs ? 1 : 0, &clock, &initial, &io, NULL),
                     0);
    return io;
}

static void remembers_what_was_switched_when(void **state)
{
    struct iso_door_io *io = open_null(NULL);
    struct iso_door_null_event event;
    bool active = false;
    size_t count = 7;
    (void)state;
    assert_int_equal(iso_door_null_event_count(io, &count), 0);
    assert_int_equal(count, 0);
    assert_int_equal(iso_door_null_get_output(io, ISO_DOOR_RELAY, &active), 0);
    assert_true(active);
    now_ns = 41;
    assert_int_equal(iso_door_io_set_output(io, ISO_DOOR_RELAY, false, NULL), 0);
    now_ns = 42;
    assert_int_equal(iso_door_io_set_output(io, ISO_DOOR_BUZZER, true, NULL), 0);
    assert_int_equal(iso_door_null_get_output(io, ISO_DOOR_RELAY, &active), 0);
    assert_false(active);
    assert_int_equal(iso_door_null_event_count(io, &count), 0);
    assert_int_equal(count, 2);
    assert_int_equal(iso_door_null_event(io, 1, &event), 0);
    assert_int_equal(event.t_ns, 42);
    assert_int_equal(event.output, ISO_DOOR_BUZZER);
    assert_true(event.active);
    assert_int_equal(iso_door_null_event(io, 2, &event), -ENOENT);
    assert_int_equal(iso_door_null_get_output(io, ISO_DOOR_OUTPUTS, &active), -EINVAL);
    iso_door_io_close(io);
}

static void forgets_the_oldest(void **state)
{
    struct iso_door_io *io = open_null(NULL);
    struct iso_door_null_event event;
    (void)state;
    for (now_ns = 0; now_ns < ISO_DOOR_NULL_HISTORY + 3; now_ns++) {
        assert_int_equal(iso_door_io_set_output(io, ISO_DOOR_BUZZER, now_ns % 2, NULL), 0);
    }
    assert_int_equal(iso_door_null_event(io, 2, &event), -ENOENT);
    assert_int_equal(iso_door_null_event(io, 3, &event), 0);
    assert_int_equal(event.t_ns, 3);
    assert_int_equal(iso_door_null_event(io, ISO_DOOR_NULL_HISTORY + 2, &event), 0);
    assert_int_equal(event.t_ns, ISO_DOOR_NULL_HISTORY + 2);
    iso_door_io_close(io);
}

static void short_presses_are_not_missed(void **state)
{
    struct iso_door_io *io = open_null(NULL);
    struct iso_door_inputs inputs;
    (void)state;
    for (int i = 0; i < ISO_DOOR_INPUTS; i++) {
        assert_int_equal(iso_door_null_set_input(io, (enum iso_door_input)i, true), 0);
        assert_int_equal(iso_door_null_set_input(io, (enum iso_door_input)i, false), 0);
    }
    assert_int_equal(iso_door_io_get_inputs(io, &inputs, NULL), 0);
    assert_true(inputs.active[ISO_DOOR_EXIT_BUTTON]);
    assert_true(inputs.active[ISO_DOOR_TAMPER]);
    assert_false(inputs.active[ISO_DOOR_CONTACT]);
    assert_int_equal(iso_door_io_get_inputs(io, &inputs, NULL), 0);
    assert_false(inputs.active[ISO_DOOR_EXIT_BUTTON]);
    assert_false(inputs.active[ISO_DOOR_TAMPER]);
    assert_int_equal(iso_door_null_set_input(io, ISO_DOOR_INPUTS, true), -EINVAL);
    iso_door_io_close(io);
}

static bool is_readable(int fd)
{
    struct pollfd poll_fd = {.fd = fd, .events = POLLIN};
    return poll(&poll_fd, 1, 0) == 1;
}

static void tells_when_an_input_changed(void **state)
{
    struct iso_door_io *io = open_null(NULL);
    struct iso_door_inputs inputs;
    int fd = iso_door_io_poll_fd(io);
    (void)state;
    assert_true(fd >= 0);
    assert_false(is_readable(fd));
    assert_int_equal(iso_door_null_set_input(io, ISO_DOOR_CONTACT, true), 0);
    assert_true(is_readable(fd));
    assert_int_equal(iso_door_io_get_inputs(io, &inputs, NULL), 0);
    assert_true(inputs.active[ISO_DOOR_CONTACT]);
    assert_false(is_readable(fd));
    iso_door_io_close(io);
}

static void reads_inputs_from_a_file(void **state)
{
    const char *path = scratch_path(*state, "inputs");
    struct iso_door_io *io = open_null(path);
    struct iso_door_inputs inputs;
    scratch_write_text(path, "tamper = 0\ncontact = 1\nexit_button = 0\n");
    assert_int_equal(iso_door_io_get_inputs(io, &inputs, NULL), 0);
    assert_true(inputs.active[ISO_DOOR_CONTACT]);
    assert_false(inputs.active[ISO_DOOR_EXIT_BUTTON]);
    scratch_write_text(path, "tamper = 0\ncontact = 0\nexit_button = 1\n");
    assert_int_equal(iso_door_io_get_inputs(io, &inputs, NULL), 0);
    assert_false(inputs.active[ISO_DOOR_CONTACT]);
    assert_true(inputs.active[ISO_DOOR_EXIT_BUTTON]);
    assert_int_equal(iso_door_io_poll_fd(io), -ENOSYS);
    assert_int_equal(iso_door_null_set_input(io, ISO_DOOR_CONTACT, true), -EINVAL);
    iso_door_io_close(io);
}

static void is_stricter_than_a_wire(void **state)
{
    static const char *const bad[][2] = {
        {"contact = 1\n", "inputs: input exit_button is missing"},
        {"contact = 1\nbell = 0\n", "inputs:2: unknown input"},
        {"contact = 1\ncontact = 1\n", "inputs:2: input given twice"},
        {"contact = 2\n", "inputs:1: not `NAME = 0` or `NAME = 1`"},
        {"contact=1\n", "inputs:1: not `NAME = 0` or `NAME = 1`"},
        {"contact : 1\n", "inputs:1: not `NAME = 0` or `NAME = 1`"},
        {"contact = 1 \n", "inputs:1: not `NAME = 0` or `NAME = 1`"},
        {"\n", "inputs:1: not `NAME = 0` or `NAME = 1`"},
    };
    const char *path = scratch_path(*state, "inputs");
    struct iso_door_io *io = open_null(path);
    struct iso_door_inputs inputs = {{true, false, true}};
    struct iso_fault fault;
    assert_int_equal(iso_door_io_get_inputs(io, &inputs, &fault), -EBADMSG);
    assert_non_null(strstr(fault.text, "inputs: No such file or directory"));
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        scratch_write_text(path, bad[i][0]);
        assert_int_equal(iso_door_io_get_inputs(io, &inputs, &fault), -EBADMSG);
        assert_string_equal(fault.text + strlen(*state) + 1, bad[i][1]);
    }
    assert_true(inputs.active[0] && !inputs.active[1] && inputs.active[2]);
    iso_door_io_close(io);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(remembers_what_was_switched_when),
        cmocka_unit_test(forgets_the_oldest),
        cmocka_unit_test(short_presses_are_not_missed),
        cmocka_unit_test(tells_when_an_input_changed),
        cmocka_unit_test_setup_teardown(reads_inputs_from_a_file, scratch_setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(is_stricter_than_a_wire, scratch_setup, scratch_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
