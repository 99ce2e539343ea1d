#include "tests/support/devices/fake_gpio.h"

#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <cmocka.h>

#include "drivers/door/gpio_line.h"

struct iso_gpio_line {
    unsigned number;
    bool output, active_low;
    int fd;
    unsigned n_edges;
    struct iso_gpio_edge edges[FAKE_GPIO_EDGES];
};

static struct {
    const int64_t *now_ns;
    bool out;
    int broken;
    struct {
        bool high;
        int refusal;
        unsigned changes;
        struct iso_gpio_line *user;
    } lines[FAKE_GPIO_LINES];
} fake;

void fake_gpio_reset(const int64_t *now_ns)
{
    memset(&fake, 0, sizeof fake);
    fake.now_ns = now_ns;
}

void fake_gpio_refuse(unsigned line, int error)
{
    fake.lines[line].refusal = error;
}

void fake_gpio_break(int error)
{
    fake.broken = error;
}

static void make_readable(const struct iso_gpio_line *line)
{
    const uint64_t one = 1;
    assert_int_equal(write(line->fd, &one, sizeof one), sizeof one);
}

void fake_gpio_pull_out(bool out)
{
    fake.out = out;
    for (int i = 0; out && i < FAKE_GPIO_LINES; i++) {
        if (fake_gpio_is_input((unsigned)i)) {
            make_readable(fake.lines[i].user);
        }
    }
}

void fake_gpio_drive(unsigned number, bool high)
{
    struct iso_gpio_line *line = fake.lines[number].user;
    assert_false(fake_gpio_is_output(number));
    if (fake.lines[number].high == high) {
        return;
    }
    fake.lines[number].high = high;
    if (line && line->n_edges < FAKE_GPIO_EDGES) {
        line->edges[line->n_edges++] = (struct iso_gpio_edge){
            .active = high != line->active_low,
            .t_ns = *fake.now_ns,
        };
        make_readable(line);
    }
}

bool fake_gpio_voltage(unsigned line)
{
    return fake.lines[line].high;
}

bool fake_gpio_is_output(unsigned line)
{
    return fake.lines[line].user && fake.lines[line].user->output;
}

bool fake_gpio_is_input(unsigned line)
{
    return fake.lines[line].user && !fake.lines[line].user->output;
}

unsigned fake_gpio_changes(unsigned line)
{
    return fake.lines[line].changes;
}

unsigned fake_gpio_open(void)
{
    unsigned n = 0;
    for (int i = 0; i < FAKE_GPIO_LINES; i++) {
        n += fake.lines[i].user != NULL;
    }
    return n;
}

/* ---- the interface of gpio_line.h ---- */

static int number_of(const struct iso_gpio_spec *spec)
{
    unsigned number = spec->offset;
    if (*spec->chip) {
        return strcmp(spec->chip, "fake") == 0 && number < FAKE_GPIO_LINES ? (int)number : -1;
    }
    return sscanf(spec->name, "LINE%u", &number) == 1 && number < FAKE_GPIO_LINES ? (int)number
                                                                                  : -1;
}

static int open_line(const struct iso_gpio_spec *spec, bool output, struct iso_gpio_line **out,
                     struct iso_fault *fault)
{
    const int number = number_of(spec);
    int error = number < 0 || fake.out ? -ENODEV : fake.lines[number].refusal;
    if (!error && fake.lines[number].user) {
        error = -EBUSY;
    }
    if (error) {
        return iso_fault_set_code(fault, iso_gpio_fault_code(error), error, "line: %s",
                                  strerror(-error));
    }
    struct iso_gpio_line *line = calloc(1, sizeof *line);
    if (!line) {
        return iso_fault_set(fault, -ENOMEM, "line: out of memory");
    }
    line->number = (unsigned)number;
    line->output = output;
    line->active_low = spec->active_low;
    line->fd = output ? -1 : eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
    fake.lines[number].user = line;
    *out = line;
    return 0;
}

static void take_voltage(const struct iso_gpio_line *line, bool active)
{
    const bool high = active != line->active_low;
    fake.lines[line->number].changes++;
    fake.lines[line->number].high = high;
}

int iso_gpio_line_open_output(const struct iso_gpio_spec *spec, bool active,
                              struct iso_gpio_line **out, struct iso_fault *fault)
{
    const int error = open_line(spec, true, out, fault);
    if (!error) {
        take_voltage(*out, active);
    }
    return error;
}

int iso_gpio_line_open_input(const struct iso_gpio_spec *spec, struct iso_gpio_line **out,
                             struct iso_fault *fault)
{
    return open_line(spec, false, out, fault);
}

void iso_gpio_line_close(struct iso_gpio_line *line)
{
    if (line) {
        assert_ptr_equal(fake.lines[line->number].user, line);
        fake.lines[line->number].user = NULL;
        if (line->fd >= 0) {
            assert_int_equal(close(line->fd), 0);
        }
        free(line);
    }
}

static int state_of(const struct iso_gpio_line *line)
{
    assert_ptr_equal(fake.lines[line->number].user, line);
    return fake.out ? -ENODEV : fake.broken;
}

int iso_gpio_line_set(struct iso_gpio_line *line, bool active)
{
    const int error = state_of(line);
    assert_true(line->output);
    if (!error && active != (fake.lines[line->number].high != line->active_low)) {
        take_voltage(line, active);
    }
    return error;
}

int iso_gpio_line_get(struct iso_gpio_line *line, bool *active)
{
    const int error = state_of(line);
    if (!error) {
        *active = fake.lines[line->number].high != line->active_low;
    }
    return error;
}

int iso_gpio_line_fd(const struct iso_gpio_line *line)
{
    return line->fd;
}

int iso_gpio_line_next_edge(struct iso_gpio_line *line, struct iso_gpio_edge *out)
{
    const int error = state_of(line);
    uint64_t count;
    assert_false(line->output);
    if (error) {
        return error;
    }
    if (line->n_edges == 0) {
        return -EAGAIN;
    }
    *out = line->edges[0];
    line->n_edges--;
    memmove(line->edges, line->edges + 1, line->n_edges * sizeof *line->edges);
    if (line->n_edges == 0) {
        (void)!read(line->fd, &count, sizeof count);
    }
    return 0;
}
