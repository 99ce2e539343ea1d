/* Replaces drivers/door/gpio_line.c in a test program: GPIO lines in memory, set and read by
 * voltage. A line can be missing, busy or forbidden, and the chip can be unplugged. It is stricter
 * than a kernel: the use of a line that is not open fails the test. */
#ifndef TESTS_SUPPORT_DEVICES_FAKE_GPIO_H
#define TESTS_SUPPORT_DEVICES_FAKE_GPIO_H

#include <stdbool.h>
#include <stdint.h>

enum { FAKE_GPIO_LINES = 10, FAKE_GPIO_EDGES = 16 };

/* The lines are fake:0 .. fake:9, named LINE0 .. LINE9. All are low and free. *now_ns is the time
 * of edges. */
void fake_gpio_reset(const int64_t *now_ns);

/* Opening the line fails with this error from now on; 0: it succeeds. */
void fake_gpio_refuse(unsigned line, int error);

/* Unplugs the chip (every operation returns -ENODEV, and the descriptors of inputs are readable),
 * or plugs it in again. */
void fake_gpio_pull_out(bool out);

/* Every operation on an open line fails with this error; 0: it succeeds. */
void fake_gpio_break(int error);

/* Sets the voltage of an input from outside. Beyond FAKE_GPIO_EDGES edges get lost. */
void fake_gpio_drive(unsigned line, bool high);

/* The voltage of a line. An output keeps its last voltage after it was closed. */
bool fake_gpio_voltage(unsigned line);

/* Whether the line is open, as an output or an input. */
bool fake_gpio_is_output(unsigned line);
bool fake_gpio_is_input(unsigned line);

/* How often an output was switched; each opening counts once. */
unsigned fake_gpio_changes(unsigned line);

/* How many lines are open, so that a test can check that all were closed. */
unsigned fake_gpio_open(void);

#endif
