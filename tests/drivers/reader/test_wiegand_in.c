/* The thread of a Wiegand reader. The lines are pipes: each edge that a test writes is an edge of
 * the line. Real lines are tested in the virtual machine (tests/vm/gpio/card_reader.sh). */
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

#include "drivers/door/wiegand.h"
#include "drivers/reader/wiegand_in.h"

/* ---- lines ---- */

struct iso_gpio_line {
    int fd;
};

static int pipes[2][2];            /* the pipe of line D0 and of D1 */
static atomic_bool absent, broken; /* the chip is not there; open lines fail */

int iso_gpio_line_open_input(const struct iso_gpio_spec *spec, struct iso_gpio_line **out,
                             struct iso_fault *fault)
{
    if (absent) {
        return iso_fault_set(fault, -ENODEV, "no such chip");
    }
    *out = malloc(sizeof **out);
    (*out)->fd = dup(pipes[spec->offset][0]);
    return 0;
}

void iso_gpio_line_close(struct iso_gpio_line *line)
{
    if (line) {
        (void)close(line->fd);
        free(line);
    }
}

int iso_gpio_line_fd(const struct iso_gpio_line *line)
{
    return line->fd;
}

int iso_gpio_line_next_edge(struct iso_gpio_line *line, struct iso_gpio_edge *out)
{
    const ssize_t n = read(line->fd, out, sizeof *out);
    if (n == sizeof *out) {
        return out->t_ns < 0 || broken ? -ENODEV : 0;
    }
    return -EAGAIN;
}

int iso_gpio_line_get(struct iso_gpio_line *line, bool *active)
{
    (void)line;
    *active = false;
    return broken ? -ENODEV : 0;
}

enum iso_fault_code iso_gpio_fault_code(int error)
{
    (void)error;
    return ISO_FAULT_CHIP_GONE;
}

/* ---- tests ---- */

static int64_t clock_ns(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec * INT64_C(1000000000) + now.tv_nsec;
}

static void edge(int line, bool active, int64_t t_ns)
{
    const struct iso_gpio_edge sent = {active, t_ns};
    assert_int_equal(write(pipes[line][1], &sent, sizeof sent), sizeof sent);
}

/* All pulses of a code are in the lines at once, with the times that they would have. */
static void send(uint64_t code, int bits)
{
    const int64_t begin_ns = clock_ns() - bits * INT64_C(200000);
    for (int i = 0; i < bits; i++) {
        const int line = (int)(code >> (bits - 1 - i) & 1);
        edge(line, true, begin_ns + i * INT64_C(200000));
        edge(line, false, begin_ns + i * INT64_C(200000) + 50000);
    }
}

/* Waits for the descriptor, at most ten seconds, and takes an event. */
static struct iso_reader_event take(struct iso_wiegand_in *reader)
{
    struct iso_reader_event event = {.kind = ISO_READER_NOTHING};
    struct pollfd fd = {.fd = iso_wiegand_in_fd(reader), .events = POLLIN};
    while (!iso_wiegand_in_take(reader, &event)) {
        assert_int_equal(poll(&fd, 1, 10000), 1);
    }
    return event;
}

static int setup(void **state)
{
    static const struct iso_gpio_spec specs[2] = {{.chip = "x", .offset = 0},
                                                  {.chip = "x", .offset = 1}};
    struct iso_wiegand_in *reader = NULL;
    struct iso_fault fault = {.text = ""};
    for (int i = 0; i < 2; i++) {
        assert_int_equal(pipe2(pipes[i], O_CLOEXEC | O_NONBLOCK), 0);
    }
    broken = false;
    assert_int_equal(iso_wiegand_in_new(specs, &reader, &fault), 0);
    *state = reader;
    return 0;
}

static int teardown(void **state)
{
    iso_wiegand_in_free(*state);
    for (int i = 0; i < 2; i++) {
        (void)close(pipes[i][0]);
        (void)close(pipes[i][1]);
    }
    return 0;
}

static void cards_and_keys_come_in_order(void **state)
{
    struct iso_wiegand_in *reader = *state;
    const struct iso_wiegand_card card = {17, 4711};
    uint64_t code = 0;
    assert_int_equal(iso_wiegand_encode(26, &card, &code), 0);
    for (int round = 0; round < 20; round++) {
        send(code, 26);
        struct iso_reader_event event = take(reader);
        assert_int_equal(event.kind, ISO_READER_CARD);
        assert_int_equal(event.code, code);
        send(7, 4);
        event = take(reader);
        assert_int_equal(event.kind, ISO_READER_KEY);
        assert_int_equal(event.key, '7');
    }
    send(code ^ 1, 26);
    assert_int_equal(take(reader).kind, ISO_READER_DAMAGED);
}

/* The reader is unplugged and plugged in again; cards that come meanwhile are lost, not late. */
static void lines_come_back(void **state)
{
    struct iso_wiegand_in *reader = *state;
    struct iso_fault fault = {.text = ""};
    struct iso_reader_event event;
    absent = broken = true; /* no edge tells it: the thread has to ask */
    for (int i = 0; i < 1000 && !*fault.text; i++) {
        (void)usleep(10000);
        iso_wiegand_in_fault(reader, &fault);
    }
    assert_string_equal(fault.text, "the lines of the card reader are gone");
    assert_false(iso_wiegand_in_take(reader, &event));
    absent = broken = false;
    for (int i = 0; i < 1000 && *fault.text; i++) {
        (void)usleep(10000);
        iso_wiegand_in_fault(reader, &fault);
    }
    assert_string_equal(fault.text, "");
    send(3, 4);
    assert_int_equal(take(reader).key, '3');
}

static int setup_absent(void **state)
{
    absent = true;
    return setup(state);
}

static void absent_lines_are_no_error(void **state)
{
    struct iso_wiegand_in *reader = *state;
    struct iso_fault fault = {.text = ""};
    iso_wiegand_in_fault(reader, &fault);
    assert_string_equal(fault.text, "no such chip");
    absent = false;
    send(5, 4);
    assert_int_equal(take(reader).key, '5');
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(cards_and_keys_come_in_order, setup, teardown),
        cmocka_unit_test_setup_teardown(lines_come_back, setup, teardown),
        cmocka_unit_test_setup_teardown(absent_lines_are_no_error, setup_absent, teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
