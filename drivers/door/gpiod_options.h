/* The options of the door back end `gpiod` (door_gpiod.h), for door_gpiod.c. */
#ifndef ISO_DRIVERS_DOOR_GPIOD_OPTIONS_H
#define ISO_DRIVERS_DOOR_GPIOD_OPTIONS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "drivers/door/door_io.h"
#include "drivers/door/gpio_line.h"

/* Ended by an entry without a name. */
extern const struct iso_option_spec iso__gpiod_options[];

/* The names of the options of the Wiegand lines D0 and D1. */
extern const char *const iso__gpiod_wiegand_names[2];

/* The wiring of the lines. */
struct iso__gpiod_wiring {
    bool has_output[ISO_DOOR_OUTPUTS], has_input[ISO_DOOR_INPUTS];
    struct iso_gpio_spec outputs[ISO_DOOR_OUTPUTS], inputs[ISO_DOOR_INPUTS];
    bool has_wiegand[2]; /* D0, D1 */
    struct iso_gpio_spec wiegand[2];
    int wiegand_bits;
    int64_t debounce_ns;
};

/* Reads the options. -EINVAL with a fault if one is bad or missing; *out is unchanged then. */
int iso__gpiod_parse_options(const struct iso_option *options, size_t n_options,
                             struct iso__gpiod_wiring *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
