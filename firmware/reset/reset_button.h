/* The button of the factory reset: a GPIO line that has to be held while the daemon starts. */
#ifndef ISO_FIRMWARE_RESET_RESET_BUTTON_H
#define ISO_FIRMWARE_RESET_RESET_BUTTON_H

#include <stdbool.h>

#include "core/base/clock.h"
#include "core/base/fault.h"

/* So long the button has to be held without a break. */
enum { ISO_RESET_HOLD_S = 10 };

/* How the button is read. */
struct iso_reset_button {
    const char *line; /* as iso_gpio_spec_parse() reads it (gpio_line.h) */
    struct iso_clock clock;
    void (*wait)(void *context, int64_t ns); /* returns after about this time */
    void *context;
};

/* Whether the text describes a line: -EINVAL. */
int iso_reset_button_check(const char *line, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Reads the line until it is not active, and *held is then false, or until it has been active for
 * ISO_RESET_HOLD_S, and *held is then true. If the button is not pressed it returns at once. The
 * errors of iso_gpio_spec_parse, iso_gpio_line_open_input and iso_gpio_line_get; -ENOENT this build
 * has no libgpiod. */
int iso_reset_button_read(const struct iso_reset_button *button, bool *held,
                          struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
