/* The door I/O back end `gpiod`: GPIO lines of the kernel, through their character devices.
 *
 * Options. Only `relay` is required; a line that is not given is not wired:
 *   relay, led_granted, led_refused, buzzer, projector    outputs
 *   contact, exit_button, tamper                          inputs
 *       each a line as iso_gpio_spec_parse() (gpio_line.h) reads it: "GPIO17 active-low",
 *       "gpiochip0:22 active-low pull-up"
 *   wiegand_d0, wiegand_d1                                outputs to an access controller, both
 *       or none; active is a pulse. With them `relay` is optional, since the controller has one.
 *   wiegand_bits  26, which is the default, or 34
 *   debounce_ms   how long an input must keep a level before it counts, 0 to 1000; 10 by default
 *
 * The injected clock must be CLOCK_MONOTONIC, which the kernel uses for the times of edges.
 *
 * The GPIO chip decides what a line does when no process holds it, that is before open, after close
 * and after the process has died. Many chips keep the last level; some turn the line into an input,
 * whose pull resistor then sets the level. Therefore, after a process that may have been killed
 * with the door unlocked, another one opens the lines with all outputs inactive and closes them
 * (`isothermd --rest-door`). The wiring makes "not driven" the resting level (board/README.md). */
#ifndef ISO_DRIVERS_DOOR_DOOR_GPIOD_H
#define ISO_DRIVERS_DOOR_DOOR_GPIOD_H

#include "drivers/door/door_io.h"

enum { ISO_DOOR_GPIOD_DEBOUNCE_MS = 10, ISO_DOOR_GPIOD_DEBOUNCE_MAX_MS = 1000 };

extern const struct iso_door_io_ops iso_door_gpiod_ops;

#endif
