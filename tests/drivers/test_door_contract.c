/* What every back end of the door class owes its user (drivers/door/door_io.h). A new back end
 * adds a line to the table: how to open it, how to see an output from outside, and how to move an
 * input. */
#include <errno.h>
#include <poll.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "drivers/door/door_io.h"
#include "drivers/door/door_null.h"
#include "tests/support/manual_clock.h"

static int64_t now_ns;

struct back_end {
    const char *name;
    bool (*see_output)(struct iso_door_io *io, enum iso_door_output output);
    void (*move_input)(struct iso_door_io *io, enum iso_door_input input, bool active);
};

static bool see_null_output(struct iso_door_io *io, enum iso_door_output output)
{
    bool active = false;
    assert_int_equal(iso_door_null_get_output(io, output, &active), 0);
    return active;
}

static void move_null_input(struct iso_door_io *io, enum iso_door_input input, bool active)
{
    assert_int_equal(iso_door_null_set_input(io, input, active), 0);
}

static const struct back_end back_ends[] = {
    {"null", see_null_output, move_null_input},
};

enum { BACK_ENDS = sizeof back_ends / sizeof *back_ends };

/* Initially every other output is active. */
static const struct iso_door_outputs initial = {{true, false, true, false}};

static void on_every_back_end(void (*test)(const struct back_end *back_end, struct iso_door_io *io))
{
    for (int i = 0; i < BACK_ENDS; i++) {
        struct iso_clock clock = manual_clock(&now_ns);
        struct iso_door_io *io = NULL;
        assert_int_equal(iso_door_io_open(back_ends[i].name, NULL, 0, &clock, &initial, &io, NULL),
                         0);
        test(&back_ends[i], io);
        iso_door_io_close(io);
    }
}

static void see_initial(const struct back_end *back_end, struct iso_door_io *io)
{
    for (int i = 0; i < ISO_DOOR_OUTPUTS; i++) {
        assert_int_equal(back_end->see_output(io, (enum iso_door_output)i), initial.active[i]);
    }
}

static void outputs_begin_as_asked(void **state)
{
    (void)state;
    on_every_back_end(see_initial);
}

static void switch_each(const struct back_end *back_end, struct iso_door_io *io)
{
    for (int i = 0; i < ISO_DOOR_OUTPUTS; i++) {
        enum iso_door_output output = (enum iso_door_output)i;
        assert_int_equal(iso_door_io_set_output(io, output, !initial.active[i], NULL), 0);
        for (int j = 0; j < ISO_DOOR_OUTPUTS; j++) {
            bool expected = j == i ? !initial.active[j] : initial.active[j];
            assert_int_equal(back_end->see_output(io, (enum iso_door_output)j), expected);
        }
        assert_int_equal(iso_door_io_set_output(io, output, initial.active[i], NULL), 0);
        assert_int_equal(iso_door_io_set_output(io, output, initial.active[i], NULL), 0);
    }
}

static void each_output_switches_alone(void **state)
{
    (void)state;
    on_every_back_end(switch_each);
}

static void move_each(const struct back_end *back_end, struct iso_door_io *io)
{
    struct iso_door_inputs inputs;
    for (int i = 0; i < ISO_DOOR_INPUTS; i++) {
        back_end->move_input(io, (enum iso_door_input)i, true);
        assert_int_equal(iso_door_io_get_inputs(io, &inputs, NULL), 0);
        for (int j = 0; j < ISO_DOOR_INPUTS; j++) {
            assert_int_equal(inputs.active[j], j == i);
        }
        back_end->move_input(io, (enum iso_door_input)i, false);
        assert_int_equal(iso_door_io_get_inputs(io, &inputs, NULL), 0);
        assert_int_equal(iso_door_io_get_inputs(io, &inputs, NULL), 0);
        assert_false(inputs.active[i]);
    }
}

static void each_input_reads_alone(void **state)
{
    (void)state;
    on_every_back_end(move_each);
}

static void press_briefly(const struct back_end *back_end, struct iso_door_io *io)
{
    struct iso_door_inputs inputs;
    back_end->move_input(io, ISO_DOOR_EXIT_BUTTON, true);
    back_end->move_input(io, ISO_DOOR_EXIT_BUTTON, false);
    assert_int_equal(iso_door_io_get_inputs(io, &inputs, NULL), 0);
    assert_true(inputs.active[ISO_DOOR_EXIT_BUTTON]);
    assert_int_equal(iso_door_io_get_inputs(io, &inputs, NULL), 0);
    assert_false(inputs.active[ISO_DOOR_EXIT_BUTTON]);
}

static void a_short_press_is_seen_once(void **state)
{
    (void)state;
    on_every_back_end(press_briefly);
}

static void wait_for_input(const struct back_end *back_end, struct iso_door_io *io)
{
    struct iso_door_inputs inputs;
    int fd = iso_door_io_poll_fd(io);
    if (fd < 0) {
        return;
    }
    struct pollfd poll_fd = {.fd = fd, .events = POLLIN};
    assert_int_equal(poll(&poll_fd, 1, 0), 0);
    back_end->move_input(io, ISO_DOOR_TAMPER, true);
    assert_int_equal(poll(&poll_fd, 1, 1000), 1);
    assert_int_equal(iso_door_io_get_inputs(io, &inputs, NULL), 0);
    assert_int_equal(poll(&poll_fd, 1, 0), 0);
}

static void the_descriptor_follows_the_inputs(void **state)
{
    (void)state;
    on_every_back_end(wait_for_input);
}

static void refuses_unknown_options(void **state)
{
    (void)state;
    for (int i = 0; i < BACK_ENDS; i++) {
        struct iso_clock clock = manual_clock(&now_ns);
        const struct iso_option option = {"no-such-option", "1"};
        struct iso_door_io *io = NULL;
        struct iso_fault fault = {""};
        assert_int_equal(
            iso_door_io_open(back_ends[i].name, &option, 1, &clock, &initial, &io, &fault),
            -EINVAL);
        assert_non_null(strstr(fault.text, back_ends[i].name));
        assert_non_null(strstr(fault.text, "no-such-option"));
        assert_null(io);
    }
}

static void no_back_end_is_left_out(void **state)
{
    (void)state;
    for (size_t r = 0; iso_door_io_registered(r); r++) {
        int i = 0;
        while (i < BACK_ENDS && strcmp(back_ends[i].name, iso_door_io_registered(r)) != 0) {
            i++;
        }
        assert_true(i < BACK_ENDS);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(outputs_begin_as_asked),
        cmocka_unit_test(each_output_switches_alone),
        cmocka_unit_test(each_input_reads_alone),
        cmocka_unit_test(a_short_press_is_seen_once),
        cmocka_unit_test(the_descriptor_follows_the_inputs),
        cmocka_unit_test(refuses_unknown_options),
        cmocka_unit_test(no_back_end_is_left_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
