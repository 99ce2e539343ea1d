/* The only file that uses libgpiod, by its API of version 1 (1.6 in Debian 12). */
#include "drivers/door/gpio_line.h"

#include <dirent.h>
#include <errno.h>
#include <gpiod.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char consumer[] = "isotherm";

struct iso_gpio_line {
    struct gpiod_chip *chip;
    struct gpiod_line *line; /* belongs to the chip */
    int fd;                  /* signals the edges of an input; -1 for an output */
};

/* ---- errors ---- */

static int error_of(int number)
{
    switch (number) {
    case EBUSY:
    case EINVAL:
    case ENOMEM:
        return -number;
    case EACCES:
    case EPERM:
        return -EACCES;
    case ENODEV:
    case ENOENT:
    case ENXIO:
    case ENOTTY: /* a file of this name exists, but it is not a GPIO chip */
        return -ENODEV;
    default:
        return -EIO;
    }
}

static const char *name_line(const struct iso_gpio_spec *spec, char *text, size_t size)
{
    if (*spec->chip) {
        (void)snprintf(text, size, "line %s:%u", spec->chip, spec->offset);
    } else {
        (void)snprintf(text, size, "line '%s'", spec->name);
    }
    return text;
}

static int fail_line(const struct iso_gpio_spec *spec, enum iso_fault_code code, int error,
                     const char *what, struct iso_fault *fault)
{
    char text[ISO_GPIO_NAME_SIZE + 32];
    return iso_fault_set_code(fault, code, error, "%s: %s", name_line(spec, text, sizeof text),
                              what);
}

/* Reports a system call that failed on the line. */
static int fail_call(const struct iso_gpio_spec *spec, int error, struct iso_fault *fault)
{
    return fail_line(spec, iso_gpio_fault_code(error), error, strerror(-error), fault);
}

/* ---- finding a line ---- */

static int find_by_offset(const struct iso_gpio_spec *spec, struct iso_gpio_line *line,
                          struct iso_fault *fault)
{
    line->chip = gpiod_chip_open_lookup(spec->chip);
    if (!line->chip) {
        const int error = error_of(errno);
        return error == -ENODEV
                   ? fail_line(spec, ISO_FAULT_CHIP_MISSING, error, "no such GPIO chip", fault)
                   : fail_call(spec, error, fault);
    }
    if (spec->offset >= gpiod_chip_num_lines(line->chip)) {
        return fail_line(spec, ISO_FAULT_LINE_MISSING, -ENODEV, "the chip has no such line", fault);
    }
    line->line = gpiod_chip_get_line(line->chip, spec->offset);
    return line->line ? 0 : fail_call(spec, error_of(errno), fault);
}

static struct gpiod_line *find_in_chip(struct gpiod_chip *chip, const char *name, size_t *n)
{
    struct gpiod_line *found = NULL;
    for (unsigned i = 0; i < gpiod_chip_num_lines(chip); i++) {
        struct gpiod_line *line = gpiod_chip_get_line(chip, i);
        const char *its_name = line ? gpiod_line_name(line) : NULL;
        if (its_name && strcmp(its_name, name) == 0) {
            found = line;
            (*n)++;
        }
    }
    return found;
}

/* Counts the lines of this name in a chip, and keeps the chip open if it has the first one. Notes
 * in *denied if the permission to open the chip is missing. */
static void look_into(const char *path, const char *name, struct iso_gpio_line *line, size_t *n,
                      bool *denied)
{
    struct gpiod_chip *chip = gpiod_chip_open(path);
    if (!chip) {
        *denied |= error_of(errno) == -EACCES;
        return;
    }
    struct gpiod_line *found = find_in_chip(chip, name, n);
    if (found && !line->line) {
        line->chip = chip;
        line->line = found;
    } else {
        gpiod_chip_close(chip);
    }
}

static int is_chip(const struct dirent *entry)
{
    return strncmp(entry->d_name, "gpiochip", 8) == 0;
}

/* gpiod_line_find() is not used: it stops at the first chip that it may not open, and does not
 * notice that two lines have the same name. */
static int find_by_name(const struct iso_gpio_spec *spec, struct iso_gpio_line *line,
                        struct iso_fault *fault)
{
    struct dirent **entries = NULL;
    size_t found = 0;
    bool denied = false;
    const int n = scandir("/dev", &entries, is_chip, alphasort);
    for (int i = 0; i < n; i++) {
        char path[300];
        (void)snprintf(path, sizeof path, "/dev/%s", entries[i]->d_name);
        look_into(path, spec->name, line, &found, &denied);
        free(entries[i]);
    }
    free(entries);
    if (n < 0) {
        return fail_call(spec, error_of(errno), fault);
    }
    if (found > 1) {
        return fail_line(spec, ISO_FAULT_OPTION_WRONG, -EINVAL,
                         "more than one line has this name: use CHIP:OFFSET", fault);
    }
    if (found == 0 && denied) {
        return fail_line(spec, ISO_FAULT_LINE_DENIED, -EACCES,
                         "not found, and not all GPIO chips may be opened", fault);
    }
    return found ? 0
                 : fail_line(spec, ISO_FAULT_LINE_MISSING, -ENODEV, "no GPIO chip has such a line",
                             fault);
}

/* ---- claiming it ---- */

static int flags_of(const struct iso_gpio_spec *spec)
{
    static const int bias[] = {
        [ISO_GPIO_BIAS_AS_IS] = 0,
        [ISO_GPIO_BIAS_NONE] = GPIOD_LINE_REQUEST_FLAG_BIAS_DISABLE,
        [ISO_GPIO_PULL_UP] = GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_UP,
        [ISO_GPIO_PULL_DOWN] = GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_DOWN,
    };
    static const int drive[] = {
        [ISO_GPIO_PUSH_PULL] = 0,
        [ISO_GPIO_OPEN_DRAIN] = GPIOD_LINE_REQUEST_FLAG_OPEN_DRAIN,
        [ISO_GPIO_OPEN_SOURCE] = GPIOD_LINE_REQUEST_FLAG_OPEN_SOURCE,
    };
    return bias[spec->bias] | drive[spec->drive] |
           (spec->active_low ? GPIOD_LINE_REQUEST_FLAG_ACTIVE_LOW : 0);
}

static int claim_line(const struct iso_gpio_spec *spec, int type, bool active,
                      struct iso_gpio_line *line, struct iso_fault *fault)
{
    const struct gpiod_line_request_config config = {
        .consumer = consumer,
        .request_type = type,
        .flags = flags_of(spec),
    };
    if (gpiod_line_request(line->line, &config, active) == 0) {
        return 0;
    }
    const int error = error_of(errno);
    const char *user = gpiod_line_consumer(line->line);
    char what[96];
    if (error == -EBUSY) {
        (void)snprintf(what, sizeof what, "in use by '%.32s'", user ? user : "the kernel");
    } else {
        (void)snprintf(what, sizeof what, "%s", strerror(-error));
    }
    return fail_line(spec, iso_gpio_fault_code(error), error, what, fault);
}

static int open_line(const struct iso_gpio_spec *spec, int type, bool active,
                     struct iso_gpio_line **out, struct iso_fault *fault)
{
    struct iso_gpio_line *line = calloc(1, sizeof *line);
    if (!line) {
        return fail_line(spec, ISO_FAULT_OUT_OF_MEMORY, -ENOMEM, "out of memory", fault);
    }
    line->fd = -1;
    int error = *spec->chip ? find_by_offset(spec, line, fault) : find_by_name(spec, line, fault);
    if (!error) {
        error = claim_line(spec, type, active, line, fault);
    }
    if (!error && type == GPIOD_LINE_REQUEST_EVENT_BOTH_EDGES) {
        line->fd = gpiod_line_event_get_fd(line->line);
        error = line->fd >= 0 ? 0 : fail_call(spec, error_of(errno), fault);
    }
    if (error) {
        iso_gpio_line_close(line);
        return error;
    }
    *out = line;
    return 0;
}

int iso_gpio_line_open_output(const struct iso_gpio_spec *spec, bool active,
                              struct iso_gpio_line **out, struct iso_fault *fault)
{
    return open_line(spec, GPIOD_LINE_REQUEST_DIRECTION_OUTPUT, active, out, fault);
}

int iso_gpio_line_open_input(const struct iso_gpio_spec *spec, struct iso_gpio_line **out,
                             struct iso_fault *fault)
{
    return open_line(spec, GPIOD_LINE_REQUEST_EVENT_BOTH_EDGES, false, out, fault);
}

void iso_gpio_line_close(struct iso_gpio_line *line)
{
    if (line) {
        if (line->chip) {
            gpiod_chip_close(line->chip); /* closing the chip releases its lines */
        }
        free(line);
    }
}

/* ---- using it ---- */

int iso_gpio_line_set(struct iso_gpio_line *line, bool active)
{
    return gpiod_line_set_value(line->line, active) == 0 ? 0 : error_of(errno);
}

int iso_gpio_line_get(struct iso_gpio_line *line, bool *active)
{
    const int value = gpiod_line_get_value(line->line);
    if (value < 0) {
        return error_of(errno);
    }
    *active = value != 0;
    return 0;
}

int iso_gpio_line_fd(const struct iso_gpio_line *line)
{
    return line->fd;
}

/* Asks the descriptor before reading: when the chip is gone, gpiod_line_event_wait() reports an
 * event each time it is called. */
int iso_gpio_line_next_edge(struct iso_gpio_line *line, struct iso_gpio_edge *out)
{
    struct pollfd poll_fd = {.fd = line->fd, .events = POLLIN | POLLPRI};
    struct gpiod_line_event event;
    const int n = poll(&poll_fd, 1, 0);
    if (n < 0) {
        return errno == EINTR ? -EAGAIN : -EIO;
    }
    if (n == 0) {
        return -EAGAIN;
    }
    if (poll_fd.revents & (POLLERR | POLLHUP | POLLNVAL)) {
        return -ENODEV;
    }
    if (gpiod_line_event_read_fd(line->fd, &event)) {
        return errno == EAGAIN ? -EAGAIN : error_of(errno);
    }
    *out = (struct iso_gpio_edge){
        .active = event.event_type == GPIOD_LINE_EVENT_RISING_EDGE,
        .t_ns = event.ts.tv_sec * INT64_C(1000000000) + event.ts.tv_nsec,
    };
    return 0;
}
