#include "tests/drivers/door/door_contract.h"

#include <errno.h>
#include <poll.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

/* At first every second output is active. */
static const struct iso_door_outputs initial = {{true, false, true, false, true}};

static const struct door_back_end *back_ends;
static size_t n_back_ends;

static struct iso_door_io *open_back_end(const struct door_back_end *back_end)
{
    struct iso_door_io *io = NULL;
    struct iso_fault fault = {.text = ""};
    if (iso_door_io_open(back_end->name, back_end->options, back_end->n_options, &back_end->clock,
                         &initial, &io, &fault)) {
        fail_msg("%s", fault.text);
    }
    return io;
}

static void on_every_back_end(void (*test)(const struct door_back_end *back_end,
                                           struct iso_door_io *io))
{
    for (size_t i = 0; i < n_back_ends; i++) {
        back_ends[i].prepare();
        struct iso_door_io *io = open_back_end(&back_ends[i]);
        test(&back_ends[i], io);
        iso_door_io_close(io);
    }
}

static void see_initial(const struct door_back_end *back_end, struct iso_door_io *io)
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

static void switch_each(const struct door_back_end *back_end, struct iso_door_io *io)
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

static void move_each(const struct door_back_end *back_end, struct iso_door_io *io)
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

static void press_briefly(const struct door_back_end *back_end, struct iso_door_io *io)
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

static void wait_for_input(const struct door_back_end *back_end, struct iso_door_io *io)
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
    for (size_t i = 0; i < n_back_ends; i++) {
        const struct iso_option option = {"no-such-option", "1"};
        struct iso_door_io *io = NULL;
        struct iso_fault fault = {.text = ""};
        assert_int_equal(iso_door_io_open(back_ends[i].name, &option, 1, &back_ends[i].clock,
                                          &initial, &io, &fault),
                         -EINVAL);
        assert_non_null(strstr(fault.text, back_ends[i].name));
        assert_non_null(strstr(fault.text, "no-such-option"));
        assert_null(io);
    }
}

/* After a close the back end opens again with the outputs that the caller gives. While it is open,
 * it cannot be reopened. */
static void open_again(const struct door_back_end *back_end, struct iso_door_io *io)
{
    struct iso_door_inputs inputs;
    struct iso_fault fault = {.text = ""};
    iso_door_io_close(io);
    back_end->prepare();
    io = open_back_end(back_end);
    see_initial(back_end, io);
    assert_int_equal(iso_door_io_get_inputs(io, &inputs, NULL), 0);
    for (int i = 0; i < ISO_DOOR_INPUTS; i++) {
        assert_false(inputs.active[i]);
    }
    assert_int_equal(iso_door_io_reopen(io, &initial, &fault), -EALREADY);
    iso_door_io_close(io);
}

static void opens_again_after_close(void **state)
{
    (void)state;
    for (size_t i = 0; i < n_back_ends; i++) {
        back_ends[i].prepare();
        open_again(&back_ends[i], open_back_end(&back_ends[i]));
    }
}

/* An input that is active before the lines are opened is active in the first reading. */
static void sees_inputs_that_were_active_before(void **state)
{
    (void)state;
    for (size_t i = 0; i < n_back_ends; i++) {
        if (!back_ends[i].has_world) {
            continue; /* its inputs exist only while it is open */
        }
        struct iso_door_inputs inputs;
        back_ends[i].prepare();
        back_ends[i].move_input(NULL, ISO_DOOR_CONTACT, true);
        struct iso_door_io *io = open_back_end(&back_ends[i]);
        assert_int_equal(iso_door_io_get_inputs(io, &inputs, NULL), 0);
        assert_true(inputs.active[ISO_DOOR_CONTACT]);
        assert_false(inputs.active[ISO_DOOR_EXIT_BUTTON]);
        iso_door_io_close(io);
    }
}

int door_contract_run(const struct door_back_end *table, size_t n)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(outputs_begin_as_asked),
        cmocka_unit_test(each_output_switches_alone),
        cmocka_unit_test(each_input_reads_alone),
        cmocka_unit_test(a_short_press_is_seen_once),
        cmocka_unit_test(the_descriptor_follows_the_inputs),
        cmocka_unit_test(refuses_unknown_options),
        cmocka_unit_test(opens_again_after_close),
        cmocka_unit_test(sees_inputs_that_were_active_before),
    };
    back_ends = table;
    n_back_ends = n;
    return cmocka_run_group_tests(tests, NULL, NULL);
}
