/* The checked wrapper of the door class, over a back end that the test controls. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "drivers/door/door_io.h"
#include "drivers/door/door_null.h"
#include "tests/support/devices/manual_clock.h"

static struct puppet {
    int check_error, open_error, error;
    const char *text;
    struct iso_door_outputs initial;
    int output;
    bool active;
    int checks, closes;
} puppet;

static int64_t now_ns;

static int puppet_open(const struct iso_option *options, size_t n_options,
                       const struct iso_clock *clock, const struct iso_door_outputs *initial,
                       void **self, struct iso_fault *fault)
{
    (void)options;
    (void)n_options;
    (void)clock;
    if (puppet.open_error) {
        return iso_fault_set(fault, puppet.open_error, "puppet: will not open");
    }
    puppet.initial = *initial;
    *self = &puppet;
    return 0;
}

static int answer_call(const struct puppet *p, struct iso_fault *fault)
{
    return p->text ? iso_fault_set(fault, p->error, "%s", p->text) : p->error;
}

static int puppet_set_output(void *self, enum iso_door_output output, bool active,
                             struct iso_fault *fault)
{
    struct puppet *p = self;
    p->output = (int)output;
    p->active = active;
    return answer_call(p, fault);
}

static int puppet_get_inputs(void *self, struct iso_door_inputs *out, struct iso_fault *fault)
{
    int error = answer_call(self, fault);
    if (!error) {
        *out = (struct iso_door_inputs){{[ISO_DOOR_TAMPER] = true}};
    }
    return error;
}

static void puppet_close(void *self)
{
    ((struct puppet *)self)->closes++;
}

static int puppet_check(const struct iso_option *options, size_t n_options, struct iso_fault *fault)
{
    (void)options;
    (void)n_options;
    puppet.checks++;
    return puppet.check_error ? iso_fault_set(fault, puppet.check_error, "puppet: wrong option")
                              : 0;
}

static const struct iso_door_io_ops puppet_ops = {
    .name = "puppet",
    .check = puppet_check,
    .open = puppet_open,
    .set_output = puppet_set_output,
    .get_inputs = puppet_get_inputs,
    .close = puppet_close,
};

static struct iso_door_io *open_puppet(void)
{
    const struct iso_door_outputs initial = {{[ISO_DOOR_RELAY] = true}};
    struct iso_clock clock = manual_clock(&now_ns);
    struct iso_door_io *io = NULL;
    puppet = (struct puppet){0};
    assert_int_equal(iso_door_io_open_ops(&puppet_ops, NULL, 0, &clock, &initial, &io, NULL), 0);
    return io;
}

static void knows_its_back_ends(void **state)
{
    const struct iso_door_outputs initial = {{false}};
    struct iso_clock clock = manual_clock(&now_ns);
    struct iso_door_io *io = NULL;
    struct iso_fault fault;
    (void)state;
    assert_string_equal(iso_door_io_registered(0), "null");
    assert_int_equal(iso_door_io_open("gate", NULL, 0, &clock, &initial, &io, &fault), -ENOENT);
    assert_non_null(strstr(fault.text, "no door 'gate'; there are: null"));
    assert_null(io);
}

static void knows_its_lines(void **state)
{
    (void)state;
    assert_string_equal(iso_door_output_name(ISO_DOOR_RELAY), "relay");
    assert_string_equal(iso_door_output_name(ISO_DOOR_BUZZER), "buzzer");
    assert_null(iso_door_output_name(ISO_DOOR_OUTPUTS));
    assert_string_equal(iso_door_input_name(ISO_DOOR_EXIT_BUTTON), "exit_button");
    assert_null(iso_door_input_name((enum iso_door_input) - 1));
}

static void refuses_a_back_end_with_holes(void **state)
{
    const struct iso_door_outputs initial = {{false}};
    struct iso_clock clock = manual_clock(&now_ns);
    struct iso_door_io *io = NULL;
    (void)state;
    for (int i = 0; i < 5; i++) {
        struct iso_door_io_ops ops = puppet_ops;
        ops.name = i == 0 ? NULL : ops.name;
        ops.open = i == 1 ? NULL : ops.open;
        ops.set_output = i == 2 ? NULL : ops.set_output;
        ops.get_inputs = i == 3 ? NULL : ops.get_inputs;
        ops.close = i == 4 ? NULL : ops.close;
        assert_int_equal(iso_door_io_open_ops(&ops, NULL, 0, &clock, &initial, &io, NULL), -EINVAL);
    }
    assert_null(io);
}

/* Options that the table refuses do not reach the back end. */
static void asks_the_table_of_options_first(void **state)
{
    static const struct iso_option_spec specs[] = {
        {.name = "port", .standard = ""},
        {.name = NULL},
    };
    const struct iso_option unknown = {"size", "3"}, good = {"port", "3"};
    const struct iso_door_outputs initial = {{false}};
    struct iso_clock clock = manual_clock(&now_ns);
    struct iso_door_io_ops ops = puppet_ops;
    struct iso_door_io *io = NULL;
    struct iso_fault fault;
    (void)state;
    puppet = (struct puppet){.open_error = -ENODEV};
    assert_int_equal(iso_door_io_open_ops(&ops, &good, 1, &clock, &initial, &io, &fault), -EINVAL);
    assert_string_equal(fault.text, "door puppet: unknown option 'port'"); /* it has no table */
    ops.options = specs;
    assert_int_equal(iso_door_io_open_ops(&ops, &unknown, 1, &clock, &initial, &io, &fault),
                     -EINVAL);
    assert_string_equal(fault.text, "door puppet: unknown option 'size'");
    assert_int_equal(puppet.checks, 0);
    assert_int_equal(iso_door_io_open_ops(&ops, &good, 1, &clock, &initial, &io, &fault), -ENODEV);
    assert_int_equal(puppet.checks, 1);
    assert_null(io);
    puppet = (struct puppet){0};
}

/* Options are checked before the device is opened: with a wrong option and a missing device, the
 * fault names the option. */
static void checks_options_before_it_opens(void **state)
{
    struct iso_clock clock = manual_clock(&now_ns);
    const struct iso_door_outputs initial = {{false}};
    struct iso_door_io *io = NULL;
    struct iso_fault fault;
    (void)state;
    puppet = (struct puppet){.check_error = -EINVAL, .open_error = -ENODEV};
    assert_int_equal(iso_door_io_open_ops(&puppet_ops, NULL, 0, &clock, &initial, &io, &fault),
                     -EINVAL);
    assert_string_equal(fault.text, "puppet: wrong option");
    assert_null(io);
    puppet.check_error = 0;
    assert_int_equal(iso_door_io_open_ops(&puppet_ops, NULL, 0, &clock, &initial, &io, &fault),
                     -ENODEV);
    assert_int_equal(puppet.checks, 2);
    puppet = (struct puppet){0};
}

static void passes_on_why_it_does_not_open(void **state)
{
    const struct iso_door_outputs initial = {{false}};
    struct iso_clock clock = manual_clock(&now_ns);
    struct iso_door_io *io = NULL;
    struct iso_fault fault;
    (void)state;
    puppet.open_error = -EBUSY;
    assert_int_equal(iso_door_io_open_ops(&puppet_ops, NULL, 0, &clock, &initial, &io, &fault),
                     -EBUSY);
    assert_string_equal(fault.text, "puppet: will not open");
    assert_null(io);
}

static void passes_levels_both_ways(void **state)
{
    struct iso_door_io *io = open_puppet();
    struct iso_door_inputs inputs = {{false}};
    (void)state;
    assert_true(puppet.initial.active[ISO_DOOR_RELAY]);
    assert_false(puppet.initial.active[ISO_DOOR_BUZZER]);
    assert_int_equal(iso_door_io_set_output(io, ISO_DOOR_LED_REFUSED, true, NULL), 0);
    assert_int_equal(puppet.output, ISO_DOOR_LED_REFUSED);
    assert_true(puppet.active);
    assert_int_equal(iso_door_io_get_inputs(io, &inputs, NULL), 0);
    assert_true(inputs.active[ISO_DOOR_TAMPER]);
    assert_false(inputs.active[ISO_DOOR_CONTACT]);
    assert_int_equal(iso_door_io_poll_fd(io), -ENOSYS);
    assert_string_equal(iso_door_io_name(io), "puppet");
    iso_door_io_close(io);
    assert_int_equal(puppet.closes, 1);
    iso_door_io_close(NULL);
}

static void refuses_unknown_lines(void **state)
{
    struct iso_door_io *io = open_puppet();
    struct iso_fault fault;
    (void)state;
    puppet.output = -7;
    assert_int_equal(iso_door_io_set_output(io, ISO_DOOR_OUTPUTS, true, &fault), -EINVAL);
    assert_string_equal(fault.text, "door puppet: no output 5");
    assert_int_equal(puppet.output, -7);
    iso_door_io_close(io);
}

static void every_fault_has_a_text(void **state)
{
    struct iso_door_io *io = open_puppet();
    struct iso_door_inputs inputs = {{[ISO_DOOR_CONTACT] = true}};
    struct iso_fault fault;
    (void)state;
    puppet.error = -EIO;
    assert_int_equal(iso_door_io_set_output(io, ISO_DOOR_RELAY, true, &fault), -EIO);
    assert_string_equal(fault.text, "door puppet: Input/output error");
    puppet.text = "chip 3: short circuit";
    assert_int_equal(iso_door_io_get_inputs(io, &inputs, &fault), -EIO);
    assert_string_equal(fault.text, "chip 3: short circuit");
    assert_true(inputs.active[ISO_DOOR_CONTACT]); /* unchanged */
    puppet.error = 0;
    assert_int_equal(iso_door_io_get_inputs(io, &inputs, NULL), 0);
    iso_door_io_close(io);
}

static void a_lost_device_can_only_be_closed(void **state)
{
    struct iso_door_io *io = open_puppet();
    struct iso_door_inputs inputs;
    struct iso_fault fault;
    (void)state;
    puppet.error = -ENODEV;
    assert_int_equal(iso_door_io_set_output(io, ISO_DOOR_RELAY, true, NULL), -ENODEV);
    puppet.error = 0;
    assert_int_equal(iso_door_io_set_output(io, ISO_DOOR_RELAY, true, &fault), -ENODEV);
    assert_string_equal(fault.text, "door puppet: the device is gone");
    assert_int_equal(iso_door_io_get_inputs(io, &inputs, NULL), -ENODEV);
    assert_int_equal(iso_door_io_poll_fd(io), -ENODEV);
    assert_true(iso_door_io_is_lost(io));
    iso_door_io_close(io);
    assert_int_equal(puppet.closes, 1);
}

static void a_lost_device_can_be_opened_anew(void **state)
{
    const struct iso_door_outputs levels = {{[ISO_DOOR_BUZZER] = true}};
    struct iso_door_io *io = open_puppet();
    struct iso_fault fault;
    (void)state;
    assert_int_equal(iso_door_io_reopen(io, &levels, &fault), -EALREADY);
    assert_string_equal(fault.text, "door puppet: is open");
    puppet.error = -ENODEV;
    assert_int_equal(iso_door_io_set_output(io, ISO_DOOR_RELAY, true, NULL), -ENODEV);
    puppet.open_error = -EBUSY;
    assert_int_equal(iso_door_io_reopen(io, &levels, &fault), -EBUSY);
    assert_string_equal(fault.text, "puppet: will not open");
    assert_int_equal(puppet.closes, 1);
    assert_true(iso_door_io_is_lost(io));
    assert_null(iso_door_io_self(io, &puppet_ops));
    puppet.open_error = puppet.error = 0;
    assert_int_equal(iso_door_io_reopen(io, &levels, NULL), 0);
    assert_true(puppet.initial.active[ISO_DOOR_BUZZER]);
    assert_int_equal(puppet.closes, 1); /* not closed twice */
    assert_int_equal(iso_door_io_set_output(io, ISO_DOOR_RELAY, true, NULL), 0);
    iso_door_io_close(io);
    assert_int_equal(puppet.closes, 2);
}

/* The options of iso_door_io_new hold for every reopen, also after the caller has changed its copy.
 */
static void begins_lost_if_asked(void **state)
{
    char value[] = "/nonexistent/inputs";
    const struct iso_option option = {"inputs", value};
    const struct iso_door_outputs unpowered = {{false}};
    struct iso_clock clock = manual_clock(&now_ns);
    struct iso_door_inputs inputs;
    struct iso_door_io *io = NULL;
    struct iso_fault fault;
    (void)state;
    assert_int_equal(iso_door_io_new("gate", NULL, 0, &clock, &io, &fault), -ENOENT);
    assert_null(io);
    assert_int_equal(iso_door_io_new("null", &option, 1, &clock, &io, NULL), 0);
    memset(value, 'x', sizeof value - 1);
    assert_true(iso_door_io_is_lost(io));
    assert_int_equal(iso_door_io_get_inputs(io, &inputs, NULL), -ENODEV);
    assert_int_equal(iso_door_io_reopen(io, &unpowered, NULL), 0);
    assert_int_equal(iso_door_io_get_inputs(io, &inputs, &fault), -EBADMSG);
    assert_string_equal(fault.text, "/nonexistent/inputs: No such file or directory");
    iso_door_io_close(io);
}

static void keeps_back_ends_apart(void **state)
{
    struct iso_door_io *io = open_puppet();
    struct iso_door_null_event event;
    bool active;
    size_t count;
    (void)state;
    assert_ptr_equal(iso_door_io_self(io, &puppet_ops), &puppet);
    assert_null(iso_door_io_self(io, &iso_door_null_ops));
    assert_int_equal(iso_door_null_set_input(io, ISO_DOOR_CONTACT, true), -EINVAL);
    assert_int_equal(iso_door_null_get_output(io, ISO_DOOR_RELAY, &active), -EINVAL);
    assert_int_equal(iso_door_null_event_count(io, &count), -EINVAL);
    assert_int_equal(iso_door_null_event(io, 0, &event), -EINVAL);
    iso_door_io_close(io);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(knows_its_back_ends),
        cmocka_unit_test(knows_its_lines),
        cmocka_unit_test(refuses_a_back_end_with_holes),
        cmocka_unit_test(checks_options_before_it_opens),
        cmocka_unit_test(asks_the_table_of_options_first),
        cmocka_unit_test(passes_on_why_it_does_not_open),
        cmocka_unit_test(passes_levels_both_ways),
        cmocka_unit_test(refuses_unknown_lines),
        cmocka_unit_test(every_fault_has_a_text),
        cmocka_unit_test(a_lost_device_can_only_be_closed),
        cmocka_unit_test(a_lost_device_can_be_opened_anew),
        cmocka_unit_test(begins_lost_if_asked),
        cmocka_unit_test(keeps_back_ends_apart),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
