/* One GPIO line of the kernel's character devices. Only gpio_line.c uses libgpiod. It uses version
 * 1, which Debian 12 has; version 2 has another API and would need another file behind this header.
 *
 * Levels are logical: a line that is `active-low` is active when its voltage is low. A line is used
 * by one thread at a time; no function here blocks.
 *
 * After the chip is gone (unplugged, its driver unbound) set, get and next_edge return -ENODEV. */
#ifndef ISO_DRIVERS_DOOR_GPIO_LINE_H
#define ISO_DRIVERS_DOOR_GPIO_LINE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/base/fault.h"

enum { ISO_GPIO_NAME_SIZE = 64 };

enum iso_gpio_bias {
    ISO_GPIO_BIAS_AS_IS = 0, /* as the board's firmware or overlay has set it */
    ISO_GPIO_BIAS_NONE,
    ISO_GPIO_PULL_UP,
    ISO_GPIO_PULL_DOWN,
};

enum iso_gpio_drive {
    ISO_GPIO_PUSH_PULL = 0,
    ISO_GPIO_OPEN_DRAIN,
    ISO_GPIO_OPEN_SOURCE,
};

/* Which line, and how it is wired. */
struct iso_gpio_spec {
    char chip[ISO_GPIO_NAME_SIZE]; /* name, label or path of the chip; "": the line is named */
    unsigned offset;               /* in the chip */
    char name[ISO_GPIO_NAME_SIZE]; /* of the line, looked for in all chips */
    bool active_low;
    enum iso_gpio_bias bias;
    enum iso_gpio_drive drive;
};

/* Reads "LINE [WORD...]" with single blanks: LINE is CHIP:OFFSET (such as gpiochip0:17) or the
 * line's name (such as GPIO17; without blanks), the words are active-low, one of pull-up, pull-down
 * and no-pull, and one of open-drain and open-source. -EINVAL with a fault that begins with
 * `owner` and a colon, unless that is NULL. */
int iso_gpio_spec_parse(const char *owner, const char *text, struct iso_gpio_spec *out,
                        struct iso_fault *fault) __attribute__((warn_unused_result));

struct iso_gpio_line;

/* The code of a fault of a line, by the negative errno of one of the functions below: LINE_DENIED,
 * LINE_BUSY, CHIP_GONE, OUT_OF_MEMORY, else LINE_FAILED. */
enum iso_fault_code iso_gpio_fault_code(int error);

/* Claims a line as an output with the level `active` from the first moment, or as an input that
 * reports its edges. The spec need not outlive the call.
 *
 * -ENODEV no such chip or line; -EBUSY another process or the kernel has the line (the fault names
 * it); -EACCES no permission for the chip, or for one of the chips if a named line was not found;
 * -EINVAL the name is not unique, or the chip does not support such a wiring; -ENOMEM; -EIO. */
int iso_gpio_line_open_output(const struct iso_gpio_spec *spec, bool active,
                              struct iso_gpio_line **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));
int iso_gpio_line_open_input(const struct iso_gpio_spec *spec, struct iso_gpio_line **out,
                             struct iso_fault *fault) __attribute__((warn_unused_result));

/* Releases the line; its level is then up to the hardware. NULL is fine. */
void iso_gpio_line_close(struct iso_gpio_line *line);

/* -EIO, -ENODEV. The level of an output reads as it was set. */
int iso_gpio_line_set(struct iso_gpio_line *line, bool active) __attribute__((warn_unused_result));
int iso_gpio_line_get(struct iso_gpio_line *line, bool *active) __attribute__((warn_unused_result));

/* A change of an input: to which level, and when by CLOCK_MONOTONIC of the kernel. */
struct iso_gpio_edge {
    bool active;
    int64_t t_ns;
};

/* The descriptor that polls readable while an input has edges that were not taken, and when its
 * chip is gone. Owned by the line. */
int iso_gpio_line_fd(const struct iso_gpio_line *line);

/* Takes the next edge of an input. -EAGAIN there is none now, -EIO, -ENODEV. The kernel keeps 16
 * edges and drops further ones: after the last edge, iso_gpio_line_get gives the true level. */
int iso_gpio_line_next_edge(struct iso_gpio_line *line, struct iso_gpio_edge *out)
    __attribute__((warn_unused_result));

#endif
