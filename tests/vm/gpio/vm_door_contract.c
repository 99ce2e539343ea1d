/* The contract suite of the door class on lines of the kernel. */
#include <poll.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "drivers/base/times.h"
#include "tests/drivers/door/door_contract.h"
#include "tests/vm/gpio/gpio_sim.h"

static const char chip[] = "door";

/* Lines by label and by name, active high and active low. */
static const struct iso_option wiring[] = {
    {"relay", "door:0"},
    {"led_granted", "door:1 active-low"},
    {"led_refused", "LINE2"},
    {"buzzer", "LINE3 active-low"},
    {"projector", "door:4"},
    {"contact", "door:5 active-low"}, /* gpio-sim has only one pull, which pull-up would replace */
    {"exit_button", "LINE6"},
    {"tamper", "door:7 active-low pull-up"},
    {"debounce_ms", "0"},
};

static bool is_active_low(unsigned line)
{
    return line == 1 || line == 3 || line == 5 || line == 7;
}

static void prepare(void)
{
    for (unsigned line = 5; line <= 7; line++) {
        gpio_sim_pull(chip, line, is_active_low(line));
    }
}

static bool see_output(struct iso_door_io *io, enum iso_door_output output)
{
    (void)io;
    return gpio_sim_voltage(chip, output) != is_active_low(output);
}

/* A thread of the kernel records an edge a little after the pull has changed, and a test cannot
 * wait for the second of two edges. */
static void move_input(struct iso_door_io *io, enum iso_door_input input, bool active)
{
    const unsigned line = ISO_DOOR_OUTPUTS + (unsigned)input;
    (void)io;
    gpio_sim_pull(chip, line, active != is_active_low(line));
    (void)poll(NULL, 0, 50);
}

int main(void)
{
    const struct iso_times times = iso_times_system();
    const struct door_back_end gpiod = {
        .name = "gpiod",
        .options = wiring,
        .n_options = sizeof wiring / sizeof *wiring,
        .clock = times.monotonic,
        .has_world = true,
        .prepare = prepare,
        .see_output = see_output,
        .move_input = move_input,
    };
    gpio_sim_make(chip, "LINE");
    return door_contract_run(&gpiod, 1);
}
