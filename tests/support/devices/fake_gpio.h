/* Stands in for drivers/door/gpio_line.c in a test program: GPIO lines in memory, by voltage, that
 * can be missing, busy, forbidden or pulled out. Stricter than a kernel: a line that is not closed,
 * or used by somebody who does not have it, fails the test. */
#ifndef TESTS_SUPPORT_DEVICES_FAKE_GPIO_H
#define TESTS_SUPPORT_DEVICES_FAKE_GPIO_H

#include <stdbool.h>
#include <stdint.h>

enum { FAKE_GPIO_LINES = 10, FAKE_GPIO_EDGES = 16 };

/* The lines are fake:0 .. fake:9, named LINE0 .. LINE9. All are low and free; edges are stamped by
 * *now_ns. */
void fake_gpio_reset(const int64_t *now_ns);

/* What opening the line fails with from now on; 0: it does not. */
void fake_gpio_refuse(unsigned line, int error);

/* The chip is pulled out: everything is -ENODEV, descriptors are readable. Or it is back. */
void fake_gpio_pull_out(bool out);

/* Every operation on a line that is open fails with this; 0: none does. */
void fake_gpio_break(int error);

/* Sets the voltage of an input from outside. Beyond FAKE_GPIO_EDGES edges get lost. */
void fake_gpio_drive(unsigned line, bool high);

/* The voltage; the last one that an output was given, after it was closed too. */
bool fake_gpio_voltage(unsigned line);

/* Whether somebody has it, as an output or an input. */
bool fake_gpio_is_output(unsigned line);
bool fake_gpio_is_input(unsigned line);

/* How often outputs changed their voltage, the first one at opening included. */
unsigned fake_gpio_changes(unsigned line);

/* How many lines are open. */
unsigned fake_gpio_open(void);

#endif
