/* The door I/O back end `gpiod`: GPIO lines of the kernel, by their character devices.
 *
 * Options, all but `relay` optional; what is not given is not wired:
 *   relay, led_granted, led_refused, buzzer, projector    outputs
 *   contact, exit_button, tamper                          inputs
 *       each a line as iso_gpio_spec_parse() (gpio_line.h) reads it: "GPIO17 active-low",
 *       "gpiochip0:22 active-low pull-up"
 *   wiegand_d0, wiegand_d1                                outputs to an access controller, both
 *       or none; active is a pulse. With them `relay` is optional, since the controller has one.
 *   wiegand_bits  26, which is the default, or 34
 *   debounce_ms   how long an input has to keep a level until it counts, 0 to 1000; 10 by default
 *
 * The injected clock has to be CLOCK_MONOTONIC, by which the kernel stamps edges.
 *
 * What a line does when nobody holds it (before open, after close, and when the process died, which
 * is the same to the kernel) is the GPIO chip's business: many keep the last level, some turn the
 * line into an input, at which its pull resistor decides. So a process that may have been killed
 * with the door unlocked is followed by one that opens the lines with all outputs inactive and
 * closes them (`isothermd --rest-door`), and the wiring makes "not driven" the resting level:
 * board/README.md. */
#ifndef ISO_DRIVERS_DOOR_DOOR_GPIOD_H
#define ISO_DRIVERS_DOOR_DOOR_GPIOD_H

#include "drivers/door/door_io.h"

enum { ISO_DOOR_GPIOD_DEBOUNCE_MS = 10, ISO_DOOR_GPIOD_DEBOUNCE_MAX_MS = 1000 };

extern const struct iso_door_io_ops iso_door_gpiod_ops;

#endif
