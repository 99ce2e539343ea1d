/* The button of the factory reset, on GPIO lines in memory. Time passes only while the button is
 * waited for. */
#include <errno.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/base/times.h"
#include "firmware/reset/reset_button.h"
#include "tests/support/devices/fake_gpio.h"
#include "tests/support/devices/manual_clock.h"

static int64_t now_ns;

/* The button changes its voltage at this time; 0: never. */
static int64_t change_ns;
static bool change_to;

static void pass_time(void *context, int64_t ns)
{
    (void)context;
    now_ns += ns;
    if (change_ns && now_ns >= change_ns) {
        change_ns = 0;
        fake_gpio_drive(5, change_to);
    }
}

static int read_button(const char *line, bool *held)
{
    const struct iso_reset_button button = {
        .line = line, .clock = manual_clock(&now_ns), .wait = pass_time};
    struct iso_fault fault = {.text = ""};
    const int error = iso_reset_button_read(&button, held, &fault);
    assert_true(error == 0 || fault.text[0]);
    assert_int_equal(fake_gpio_open(), 0);
    return error;
}

static int set_up(void **state)
{
    (void)state;
    now_ns = ISO_NS_PER_S;
    change_ns = 0;
    fake_gpio_reset(&now_ns);
    return 0;
}

/* A start must not wait for a button that nobody presses. */
static void a_button_that_is_not_pressed_costs_no_time(void **state)
{
    bool held = true;
    (void)state;
    assert_int_equal(read_button("fake:5", &held), 0);
    assert_false(held);
    assert_int_equal(now_ns, ISO_NS_PER_S);
    held = true;
    fake_gpio_drive(5, true);
    assert_int_equal(read_button("fake:5 active-low", &held), 0);
    assert_false(held);
}

static void a_button_that_is_held_for_ten_seconds_counts(void **state)
{
    bool held = false;
    (void)state;
    fake_gpio_drive(5, true);
    assert_int_equal(read_button("LINE5", &held), 0);
    assert_true(held);
    assert_true(now_ns >= 11 * ISO_NS_PER_S && now_ns < 11 * ISO_NS_PER_S + ISO_NS_PER_S / 5);
}

/* It is let go shortly before the end, and does not count. */
static void a_button_that_is_let_go_does_not_count(void **state)
{
    bool held = true;
    (void)state;
    fake_gpio_drive(5, true);
    change_ns = 11 * ISO_NS_PER_S - 100 * ISO_NS_PER_MS;
    change_to = false;
    assert_int_equal(read_button("fake:5", &held), 0);
    assert_false(held);
    assert_true(now_ns < 11 * ISO_NS_PER_S);
}

static void a_line_that_cannot_be_read_is_a_fault(void **state)
{
    bool held = false;
    struct iso_fault fault = {.text = ""};
    (void)state;
    assert_int_equal(iso_reset_button_check("", &fault), -EINVAL);
    assert_int_equal(iso_reset_button_check("fake:5 active-low", &fault), 0);
    assert_int_equal(read_button("fake:5 sideways", &held), -EINVAL);
    assert_int_equal(read_button("fake:99", &held), -ENODEV);
    fake_gpio_refuse(5, -EBUSY);
    assert_int_equal(read_button("fake:5", &held), -EBUSY);
    fake_gpio_refuse(5, 0);
    fake_gpio_break(-EIO);
    assert_int_equal(read_button("fake:5", &held), -EIO);
    assert_false(held);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(a_button_that_is_not_pressed_costs_no_time, set_up),
        cmocka_unit_test_setup(a_button_that_is_held_for_ten_seconds_counts, set_up),
        cmocka_unit_test_setup(a_button_that_is_let_go_does_not_count, set_up),
        cmocka_unit_test_setup(a_line_that_cannot_be_read_is_a_fault, set_up),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
