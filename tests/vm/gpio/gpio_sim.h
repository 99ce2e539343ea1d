/* Chips of the kernel's gpio-sim, by configfs and sysfs: the test sets and reads the other end of
 * the lines. Needs root and the module; every failure ends the test. */
#ifndef TESTS_VM_GPIO_GPIO_SIM_H
#define TESTS_VM_GPIO_GPIO_SIM_H

#include <stdbool.h>

enum { GPIO_SIM_LINES = 10 };

/* Makes a chip with lines PREFIX0 .. PREFIX9 and the label `name`, and plugs it in. */
void gpio_sim_make(const char *name, const char *prefix);

/* Unplugs the chip, or plugs it in again. */
void gpio_sim_plug(const char *name, bool in);

/* Unplugs the chip and removes it. */
void gpio_sim_remove(const char *name);

/* The chip's name, such as "gpiochip0"; valid until the next call. */
const char *gpio_sim_chip(const char *name);

/* Sets the level to which a line is pulled from outside. */
void gpio_sim_pull(const char *name, unsigned line, bool high);

/* Whether the voltage of a line is high. */
bool gpio_sim_voltage(const char *name, unsigned line);

#endif
