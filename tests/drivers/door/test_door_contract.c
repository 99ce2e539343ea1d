/* Runs the contract suite of the door class on every back end of this build: null, and gpiod over
 * simulated lines. tests/vm runs it over simulated lines of a real kernel. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "drivers/door/door_null.h"
#include "tests/drivers/door/door_contract.h"
#include "tests/support/devices/fake_gpio.h"
#include "tests/support/devices/manual_clock.h"

static int64_t now_ns;

static void prepare_null(void)
{
}

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

#ifdef ISOTHERM_WITH_GPIOD

/* The lines are given by number and by name, active high and active low. */
static const struct iso_option wiring[] = {
    {"relay", "fake:0"},      {"led_granted", "fake:1 active-low"},
    {"led_refused", "LINE2"}, {"buzzer", "LINE3 active-low open-drain"},
    {"projector", "fake:4"},  {"contact", "fake:5 active-low pull-up"},
    {"exit_button", "LINE6"}, {"tamper", "fake:7 active-low pull-up"},
    {"debounce_ms", "0"},
};

static bool is_active_low(unsigned line)
{
    return line == 1 || line == 3 || line == 5 || line == 7;
}

static void prepare_gpiod(void)
{
    fake_gpio_reset(&now_ns);
    fake_gpio_drive(5, true);
    fake_gpio_drive(7, true);
}

static bool see_gpiod_output(struct iso_door_io *io, enum iso_door_output output)
{
    (void)io;
    assert_true(fake_gpio_is_output(output));
    return fake_gpio_voltage(output) != is_active_low(output);
}

static void move_gpiod_input(struct iso_door_io *io, enum iso_door_input input, bool active)
{
    const unsigned line = ISO_DOOR_OUTPUTS + (unsigned)input;
    (void)io;
    now_ns += 1000;
    fake_gpio_drive(line, active != is_active_low(line));
}

#endif

/* Returns how many registered back ends the table lacks. */
static int no_back_end_is_left_out(const struct door_back_end *table, size_t n)
{
    int missing = 0;
    for (size_t r = 0; iso_door_io_registered(r); r++) {
        size_t i = 0;
        while (i < n && strcmp(table[i].name, iso_door_io_registered(r)) != 0) {
            i++;
        }
        missing += i == n;
    }
    return missing;
}

int main(void)
{
    const struct door_back_end table[] = {
        {"null", NULL, 0, manual_clock(&now_ns), false, prepare_null, see_null_output,
         move_null_input},
#ifdef ISOTHERM_WITH_GPIOD
        {"gpiod", wiring, sizeof wiring / sizeof *wiring, manual_clock(&now_ns), true,
         prepare_gpiod, see_gpiod_output, move_gpiod_input},
#endif
    };
    const size_t n = sizeof table / sizeof *table;
    return door_contract_run(table, n) + no_back_end_is_left_out(table, n);
}
