/* The back end gpiod over simulated lines: options, order, faults, debouncing. */
#include <errno.h>
#include <poll.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <time.h>

#include <cmocka.h>

#include "drivers/door/door_gpiod.h"
#include "tests/support/devices/fake_gpio.h"
#include "tests/support/devices/manual_clock.h"

#define MS INT64_C(1000000)

static int64_t now_ns;
static const struct iso_door_outputs unpowered;

/* Contact and button are active low, the tamper switch is active high. */
static const struct iso_option wiring[] = {
    {"relay", "fake:0 active-low"},
    {"buzzer", "fake:3"},
    {"contact", "fake:5 active-low pull-up"},
    {"exit_button", "fake:6 active-low pull-up"},
    {"tamper", "fake:7"},
};

enum { WIRED = sizeof wiring / sizeof *wiring };

static int set_up_chip(void **state)
{
    (void)state;
    now_ns = 1000 * MS;
    fake_gpio_reset(&now_ns);
    fake_gpio_drive(5, true);
    fake_gpio_drive(6, true);
    return 0;
}

static int tear_down_chip(void **state)
{
    (void)state;
    return fake_gpio_open() == 0 ? 0 : -1;
}

static struct iso_door_io *open_door(void)
{
    const struct iso_clock clock = manual_clock(&now_ns);
    struct iso_door_io *io = NULL;
    struct iso_fault fault = {.text = ""};
    if (iso_door_io_open("gpiod", wiring, WIRED, &clock, &unpowered, &io, &fault)) {
        fail_msg("%s", fault.text);
    }
    return io;
}

static void refuses_options(const struct iso_option *options, size_t n, int error,
                            enum iso_fault_code code, const char *text)
{
    const struct iso_clock clock = manual_clock(&now_ns);
    struct iso_door_io *io = NULL;
    struct iso_fault fault = {.text = ""};
    assert_int_equal(iso_door_io_open("gpiod", options, n, &clock, &unpowered, &io, &fault), error);
    if (!strstr(fault.text, text)) {
        fail_msg("'%s' lacks '%s'", fault.text, text);
    }
    assert_int_equal(fault.code, code);
    assert_null(io);
    assert_int_equal(fake_gpio_open(), 0);
}

static void refuses_bad_options(void **state)
{
    const struct iso_option no_relay[] = {{"buzzer", "fake:3"}};
    const struct iso_option no_line[] = {{"relay", "fake:0"}, {"tamper", "fake:7 high"}};
    const struct iso_option no_time[] = {{"relay", "fake:0"}, {"debounce_ms", "soon"}};
    const struct iso_option too_long[] = {{"relay", "fake:0"}, {"debounce_ms", "1001"}};
    const struct iso_option no_d0[] = {{"relay", "fake:0"}, {"wiegand_d1", "fake:9"}};
    const struct iso_option no_d1[] = {{"relay", "fake:0"}, {"wiegand_d0", "fake:8"}};
    const struct iso_option no_bits[] = {{"relay", "fake:0"}, {"wiegand_bits", "37"}};
    (void)state;
    refuses_options(no_relay, 1, -EINVAL, ISO_FAULT_OPTION_WRONG,
                    "door gpiod: option 'relay' is missing");
    refuses_options(no_line, 2, -EINVAL, ISO_FAULT_OPTION_WRONG,
                    "door gpiod: tamper: 'high' in 'fake:7 high' is unknown");
    refuses_options(no_time, 2, -EINVAL, ISO_FAULT_OPTION_WRONG,
                    "door gpiod: bad value 'soon' for 'debounce_ms'");
    refuses_options(too_long, 2, -EINVAL, ISO_FAULT_OPTION_WRONG,
                    "'1001' for 'debounce_ms' (a whole number, 0 to 1000)");
    refuses_options(no_d0, 2, -EINVAL, ISO_FAULT_OPTION_WRONG,
                    "door gpiod: option 'wiegand_d0' is missing");
    refuses_options(no_d1, 2, -EINVAL, ISO_FAULT_OPTION_WRONG,
                    "door gpiod: option 'wiegand_d1' is missing");
    refuses_options(no_bits, 2, -EINVAL, ISO_FAULT_OPTION_WRONG,
                    "door gpiod: bad value '37' for 'wiegand_bits' (26|34)");
    assert_int_equal(fake_gpio_changes(0), 0); /* an invalid configuration changes no line */
}

/* If any line cannot be opened, no line stays open. */
static void names_the_line_that_is_not_available(void **state)
{
    static const struct {
        unsigned line;
        int error;
        enum iso_fault_code code;
        const char *text;
    } cases[] = {
        {0, -EBUSY, ISO_FAULT_LINE_BUSY, "door gpiod: relay: line: Device or resource busy"},
        {3, -EACCES, ISO_FAULT_LINE_DENIED, "door gpiod: buzzer: line: Permission denied"},
        {5, -ENODEV, ISO_FAULT_CHIP_GONE, "door gpiod: contact: line: No such device"},
        {7, -EIO, ISO_FAULT_LINE_FAILED, "door gpiod: tamper: line: Input/output error"},
    };
    const struct iso_option twice[] = {{"relay", "fake:0"}, {"tamper", "LINE0"}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        fake_gpio_refuse(cases[i].line, cases[i].error);
        refuses_options(wiring, WIRED, cases[i].error, cases[i].code, cases[i].text);
        fake_gpio_refuse(cases[i].line, 0);
    }
    refuses_options(twice, 2, -EBUSY, ISO_FAULT_LINE_BUSY, "door gpiod: tamper: line:");
}

/* The opening causes no short pulse: a strike that must stay energised does not drop, and one that
 * must stay off does not click. */
static void outputs_have_no_other_level_first(void **state)
{
    const struct iso_clock clock = manual_clock(&now_ns);
    const struct iso_door_outputs powered = {{[ISO_DOOR_RELAY] = true}};
    struct iso_door_io *io = open_door();
    (void)state;
    assert_int_equal(fake_gpio_changes(0), 1);
    assert_true(fake_gpio_voltage(0)); /* active low, inactive */
    iso_door_io_close(io);
    assert_int_equal(fake_gpio_changes(0), 1);
    assert_int_equal(iso_door_io_open("gpiod", wiring, WIRED, &clock, &powered, &io, NULL), 0);
    assert_int_equal(fake_gpio_changes(0), 2);
    assert_false(fake_gpio_voltage(0));
    iso_door_io_close(io);
    assert_false(fake_gpio_voltage(0)); /* the close does not change the level */
}

static void unwired_lines_have_no_effect(void **state)
{
    const struct iso_option relay = {"relay", "LINE0"};
    const struct iso_clock clock = manual_clock(&now_ns);
    struct iso_door_inputs inputs = {{true, true, true}};
    struct iso_door_io *io = NULL;
    (void)state;
    assert_int_equal(iso_door_io_open("gpiod", &relay, 1, &clock, &unpowered, &io, NULL), 0);
    assert_int_equal(fake_gpio_open(), 1);
    assert_int_equal(iso_door_io_set_output(io, ISO_DOOR_LED_GRANTED, true, NULL), 0);
    assert_int_equal(iso_door_io_get_inputs(io, &inputs, NULL), 0);
    for (int i = 0; i < ISO_DOOR_INPUTS; i++) {
        assert_false(inputs.active[i]);
    }
    iso_door_io_close(io);
}

static struct iso_door_inputs look_at_inputs(struct iso_door_io *io)
{
    struct iso_door_inputs inputs;
    struct iso_fault fault = {.text = ""};
    if (iso_door_io_get_inputs(io, &inputs, &fault)) {
        fail_msg("%s", fault.text);
    }
    return inputs;
}

static void contacts_bounce(void **state)
{
    struct iso_door_io *io = open_door();
    (void)state;
    for (int i = 0; i < 7; i++) { /* 12 ms of bouncing, then the contact stays open */
        fake_gpio_drive(5, i % 2 != 0);
        assert_false(look_at_inputs(io).active[ISO_DOOR_CONTACT]);
        now_ns += 2 * MS;
    }
    now_ns += (ISO_DOOR_GPIOD_DEBOUNCE_MS - 3) * MS;
    assert_false(look_at_inputs(io).active[ISO_DOOR_CONTACT]);
    now_ns += 1 * MS;
    assert_true(look_at_inputs(io).active[ISO_DOOR_CONTACT]);
    iso_door_io_close(io);
}

/* The edges have the times of a press, although the level was not read for half a second. A short
 * spike does not count. */
static void a_press_between_two_looks(void **state)
{
    struct iso_door_io *io = open_door();
    (void)state;
    now_ns += 100 * MS;
    fake_gpio_drive(6, false);
    now_ns += ISO_DOOR_GPIOD_DEBOUNCE_MS * MS;
    fake_gpio_drive(6, true);
    now_ns += 380 * MS;
    assert_true(look_at_inputs(io).active[ISO_DOOR_EXIT_BUTTON]);
    assert_false(look_at_inputs(io).active[ISO_DOOR_EXIT_BUTTON]);
    fake_gpio_drive(6, false);
    now_ns += (ISO_DOOR_GPIOD_DEBOUNCE_MS - 1) * MS;
    fake_gpio_drive(6, true);
    now_ns += 380 * MS;
    assert_false(look_at_inputs(io).active[ISO_DOOR_EXIT_BUTTON]);
    iso_door_io_close(io);
}

/* There are more edges than the kernel keeps, so the back end reads the level itself. */
static void edges_beyond_the_kernels_memory(void **state)
{
    struct iso_door_io *io = open_door();
    (void)state;
    for (int i = 0; i < FAKE_GPIO_EDGES + 3; i++) {
        fake_gpio_drive(7, i % 2 == 0);
        now_ns += 1000;
    }
    assert_true(fake_gpio_voltage(7));
    (void)look_at_inputs(io);
    now_ns += ISO_DOOR_GPIOD_DEBOUNCE_MS * MS;
    assert_true(look_at_inputs(io).active[ISO_DOOR_TAMPER]);
    iso_door_io_close(io);
}

static bool is_readable(struct iso_door_io *io, int timeout_ms)
{
    struct pollfd poll_fd = {.fd = iso_door_io_poll_fd(io), .events = POLLIN};
    return poll(&poll_fd, 1, timeout_ms) == 1;
}

/* The descriptor becomes readable again when the level counts. Its timer uses the kernel's clock,
 * by which the due time on the test's clock is long past. */
static void the_descriptor_tells_when_a_level_counts(void **state)
{
    struct iso_door_io *io = open_door();
    (void)state;
    assert_false(is_readable(io, 0));
    fake_gpio_drive(7, true);
    assert_true(is_readable(io, 0));
    assert_false(look_at_inputs(io).active[ISO_DOOR_TAMPER]);
    assert_true(is_readable(io, 5000));
    now_ns += ISO_DOOR_GPIOD_DEBOUNCE_MS * MS;
    assert_true(look_at_inputs(io).active[ISO_DOOR_TAMPER]);
    assert_false(is_readable(io, 0));
    iso_door_io_close(io);
}

static void a_chip_that_is_pulled_out(void **state)
{
    struct iso_door_inputs inputs = {{true, false, true}};
    struct iso_door_io *io = open_door();
    struct iso_fault fault;
    (void)state;
    fake_gpio_pull_out(true);
    assert_true(is_readable(io, 0)); /* it is readable at once */
    assert_int_equal(iso_door_io_get_inputs(io, &inputs, &fault), -ENODEV);
    assert_string_equal(fault.text, "door gpiod: relay: No such device");
    assert_true(inputs.active[0] && !inputs.active[1] && inputs.active[2]);
    assert_int_equal(iso_door_io_reopen(io, &unpowered, &fault), -ENODEV);
    assert_string_equal(fault.text, "door gpiod: relay: line: No such device");
    assert_int_equal(fake_gpio_open(), 0);
    fake_gpio_pull_out(false);
    assert_int_equal(iso_door_io_reopen(io, &unpowered, NULL), 0);
    assert_int_equal(fake_gpio_open(), WIRED);
    (void)look_at_inputs(io);
    fake_gpio_pull_out(true);
    assert_int_equal(iso_door_io_set_output(io, ISO_DOOR_RELAY, true, &fault), -ENODEV);
    assert_string_equal(fault.text, "door gpiod: relay: No such device");
    iso_door_io_close(io);
}

/* No relay is wired, because the controller has one. */
static void sends_cards_to_a_controller(void **state)
{
    const struct iso_option options[] = {{"wiegand_d0", "fake:8 active-low"},
                                         {"wiegand_d1", "fake:9 active-low"},
                                         {"contact", "fake:5 active-low"}};
    const struct iso_clock clock = manual_clock(&now_ns);
    const struct iso_wiegand_card card = {1, 1}, too_big = {256, 1};
    struct iso_door_io *io = NULL;
    struct iso_fault fault;
    (void)state;
    assert_int_equal(iso_door_io_open("gpiod", options, 3, &clock, &unpowered, &io, NULL), 0);
    assert_true(fake_gpio_voltage(8) && fake_gpio_voltage(9));
    (void)look_at_inputs(io);
    assert_int_equal(iso_door_io_send_card(io, &too_big, &fault), -ERANGE);
    assert_string_equal(fault.text, "door gpiod: 256:1 does not fit in 26 bits");
    assert_int_equal(iso_door_io_send_card(io, &card, NULL), 0);
    assert_int_equal(iso_door_io_send_card(io, &card, &fault), -EBUSY);
    assert_string_equal(fault.text, "door gpiod: wiegand: Device or resource busy");
    const struct timespec code = {0, 10000000};
    while (iso_door_io_send_card(io, &card, NULL) == -EBUSY) {
        (void)nanosleep(&code, NULL);
    }
    /* At least one code was sent: 23 zeros and 3 ones, two changes each. The second code has begun.
     */
    assert_true(fake_gpio_changes(8) >= 1 + 2 * 23);
    assert_true(fake_gpio_changes(9) >= 1 + 2 * 3);
    iso_door_io_close(io); /* while the second code is sent */
    assert_true(fake_gpio_voltage(8) && fake_gpio_voltage(9));
}

static void without_a_controller_no_card_is_sent(void **state)
{
    const struct iso_wiegand_card card = {1, 1};
    struct iso_door_io *io = open_door();
    struct iso_fault fault;
    (void)state;
    assert_int_equal(iso_door_io_send_card(io, &card, &fault), -ENOSYS);
    assert_string_equal(fault.text, "door gpiod: no controller is wired");
    iso_door_io_close(io);
}

static void other_failures_are_not_for_ever(void **state)
{
    struct iso_door_inputs inputs;
    struct iso_door_io *io = open_door();
    struct iso_fault fault;
    (void)state;
    fake_gpio_break(-EIO);
    assert_int_equal(iso_door_io_get_inputs(io, &inputs, &fault), -EIO);
    assert_int_equal(iso_door_io_set_output(io, ISO_DOOR_BUZZER, true, &fault), -EIO);
    assert_string_equal(fault.text, "door gpiod: buzzer: Input/output error");
    fake_gpio_break(0);
    assert_int_equal(iso_door_io_set_output(io, ISO_DOOR_BUZZER, true, NULL), 0);
    assert_true(fake_gpio_voltage(3));
    iso_door_io_close(io);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, set_up_chip, tear_down_chip)
    const struct CMUnitTest tests[] = {
        TEST(refuses_bad_options),
        TEST(names_the_line_that_is_not_available),
        TEST(outputs_have_no_other_level_first),
        TEST(unwired_lines_have_no_effect),
        TEST(contacts_bounce),
        TEST(a_press_between_two_looks),
        TEST(edges_beyond_the_kernels_memory),
        TEST(the_descriptor_tells_when_a_level_counts),
        TEST(a_chip_that_is_pulled_out),
        TEST(sends_cards_to_a_controller),
        TEST(without_a_controller_no_card_is_sent),
        TEST(other_failures_are_not_for_ever),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
