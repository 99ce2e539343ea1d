#include "firmware/reset/reset_button.h"

#include <errno.h>

#include "drivers/base/times.h"
#include "drivers/door/gpio_line.h"

int iso_reset_button_check(const char *line, struct iso_fault *fault)
{
    struct iso_gpio_spec spec;
    return iso_gpio_spec_parse("[reset] button", line, &spec, fault);
}

#ifdef ISOTHERM_WITH_GPIOD

/* Reads the level twenty times a second: a button that bounces is pressed again for longer. */
static int watch(const struct iso_reset_button *button, struct iso_gpio_line *line, bool *held)
{
    static const int64_t step_ns = 50 * ISO_NS_PER_MS;
    const int64_t begin_ns = iso_clock_now_ns(&button->clock);
    bool active = true;
    int error = 0;
    while (!error && active &&
           iso_clock_now_ns(&button->clock) - begin_ns < ISO_RESET_HOLD_S * ISO_NS_PER_S) {
        error = iso_gpio_line_get(line, &active);
        if (!error && active) {
            button->wait(button->context, step_ns);
        }
    }
    *held = !error && active;
    return error;
}

int iso_reset_button_read(const struct iso_reset_button *button, bool *held,
                          struct iso_fault *fault)
{
    struct iso_gpio_spec spec;
    struct iso_gpio_line *line = NULL;
    bool active = false;
    int error = iso_gpio_spec_parse("[reset] button", button->line, &spec, fault);
    if (!error) {
        error = iso_gpio_line_open_input(&spec, &line, fault);
    }
    if (error) {
        return error;
    }
    error = watch(button, line, &active);
    iso_gpio_line_close(line);
    if (error) {
        return iso_fault_set_code(fault, iso_gpio_fault_code(error), error,
                                  "[reset] button: %s cannot be read", button->line);
    }
    *held = active;
    return 0;
}

#else

int iso_reset_button_read(const struct iso_reset_button *button, bool *held,
                          struct iso_fault *fault)
{
    (void)button;
    (void)held;
    return iso_fault_set_code(fault, ISO_FAULT_DRIVER_UNKNOWN, -ENOENT,
                              "[reset] button: this build has no libgpiod");
}

#endif
