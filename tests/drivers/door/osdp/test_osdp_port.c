/* A device on a serial line. The line is a pseudo-terminal; the panel of the tests is at its other
 * end and sends its bytes as fast as the line would carry them. Time is real here. */
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

#include "drivers/door/osdp/osdp_port.h"
#include "drivers/door/osdp/osdp_serial.h"
#include "tests/drivers/door/osdp/osdp_bench.h"

static int64_t read_clock(void *context)
{
    struct timespec now;
    (void)context;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec * BENCH_SECOND_NS + now.tv_nsec;
}

static const struct iso_clock real_clock = {read_clock, NULL};

struct line {
    int master;
    char path[64];
    uint32_t baud;      /* 0: as fast as possible */
    struct bench bench; /* only its panel and its store are used */
    struct iso_osdp_port *port;
};

static void open_line(struct line *line, bool has_key, bool plain, uint32_t baud)
{
    struct iso_fault fault;
    memset(line, 0, sizeof *line);
    line->master = posix_openpt(O_RDWR | O_NOCTTY);
    assert_true(line->master >= 0);
    assert_int_equal(grantpt(line->master), 0);
    assert_int_equal(unlockpt(line->master), 0);
    assert_int_equal(ptsname_r(line->master, line->path, sizeof line->path), 0);
    line->baud = baud;
    line->bench.panel.address = 5;
    line->bench.panel.sequence = -1;
    struct iso_osdp_setup setup = bench_setup(&line->bench, has_key, plain);
    setup.saved.baud = baud ? baud : 115200;
    setup.random = NULL; /* the port has its own */
    assert_int_equal(iso_osdp_port_new(line->path, &setup, &real_clock, &line->port, &fault), 0);
}

static void close_line(struct line *line)
{
    iso_osdp_port_free(line->port);
    (void)close(line->master);
}

/* Writes bytes as fast as the line would carry them: ten bits a byte. */
static void write_paced(const struct line *line, const uint8_t *bytes, size_t n)
{
    for (size_t at = 0; at < n;) {
        const size_t piece = line->baud && n - at > 4 ? 4 : n - at;
        assert_int_equal(write(line->master, bytes + at, piece), piece);
        at += piece;
        if (line->baud) {
            const struct timespec time = {
                0, (long)(piece * 10 * (uint64_t)BENCH_SECOND_NS / line->baud)};
            (void)nanosleep(&time, NULL);
        }
    }
}

/* Reads a reply into the panel, or finds that there is none within 200 ms. */
static void read_reply(struct line *line, struct panel_reply *reply)
{
    uint8_t bytes[PANEL_FRAME_BYTES];
    size_t n = 0;
    reply->code = -1;
    for (;;) {
        struct pollfd wait = {.fd = line->master, .events = POLLIN};
        if (poll(&wait, 1, 200) <= 0) {
            return;
        }
        const ssize_t more = read(line->master, bytes + n, sizeof bytes - n);
        assert_true(more > 0);
        n += (size_t)more;
        const uint8_t *som = memchr(bytes, 0x53, n);
        const size_t rest = som ? n - (size_t)(som - bytes) : 0;
        if (rest >= 5 && rest >= (som[2] | (size_t)som[3] << 8)) {
            panel_read(&line->bench.panel, som, rest, reply);
            return;
        }
    }
}

/* Repeats the frame until there is a reply. */
static void insist(struct line *line, struct panel_reply *reply)
{
    const struct panel *panel = &line->bench.panel;
    do {
        write_paced(line, panel->frame, panel->n_frame);
        read_reply(line, reply);
    } while (reply->code < 0);
}

static int ask(struct line *line, uint8_t command, const void *data, size_t n,
               struct panel_reply *reply)
{
    panel_make(&line->bench.panel, command, data, n);
    insist(line, reply);
    return reply->code;
}

static void make_secure(struct line *line)
{
    static const uint8_t rnd_a[8] = {9, 8, 7, 6, 5, 4, 3, 2};
    struct panel *panel = &line->bench.panel;
    struct panel_reply reply;
    uint8_t proof[16];
    panel->sequence = -1;
    panel_challenge(panel, bench_key, rnd_a);
    panel_make_plain(panel, 0x76, 0x11, 1, rnd_a, 8);
    insist(line, &reply);
    assert_true(panel_answer(panel, &reply, proof));
    panel_make_plain(panel, 0x77, 0x13, 1, proof, 16);
    insist(line, &reply);
    assert_true(panel_begin(panel, &reply));
}

static void test_every_speed(void **state)
{
    (void)state;
    static const uint32_t speeds[] = {9600, 19200, 38400, 57600, 115200};
    static const speed_t codes[] = {B9600, B19200, B38400, B57600, B115200};
    for (size_t i = 0; i < sizeof speeds / sizeof *speeds; i++) {
        struct line line;
        struct panel_reply reply;
        struct termios now;
        const uint8_t text[] = "\0\2\0\1\1\40"
                               "A text that is as long as can be";
        const uint8_t card[5] = {0xDE, 0xAD, 0xBE, 0xEF, 0x40};
        open_line(&line, true, i % 2, speeds[i]);
        assert_int_equal(tcgetattr(line.master, &now), 0);
        assert_int_equal(cfgetospeed(&now), codes[i]);
        assert_int_equal(now.c_lflag & (ICANON | ECHO), 0);
        if (i % 2 == 0) {
            make_secure(&line);
        }
        assert_int_equal(ask(&line, 0x61, "", 1, &reply), 0x45);
        assert_int_equal(ask(&line, 0x6B, text, 6 + 32, &reply), 0x40);
        assert_int_equal(iso_osdp_port_card(line.port, card, 34), 0);
        assert_int_equal(ask(&line, 0x60, NULL, 0, &reply), 0x50);
        assert_memory_equal(reply.data + 4, card, 5);
        assert_int_equal(ask(&line, 0x60, NULL, 0, &reply), 0x40);
        struct iso_osdp_port_status status;
        iso_osdp_port_look(line.port, &status);
        assert_string_equal(status.device.shown.text[1], "s long as can be");
        assert_int_equal(status.device.delivered, 1);
        assert_int_equal(status.device.secure, i % 2 == 0);
        close_line(&line);
    }
}

static uint32_t dice = 4711;

static uint32_t throw_dice(uint32_t sides)
{
    dice = dice * 1664525 + 1013904223;
    return (dice >> 8) % sides;
}

/* The panel damages or cuts off some of its frames, and misses some replies. It knows that, so it
 * need not wait. */
static void spoil(struct line *line, struct panel_reply *reply)
{
    const struct panel *panel = &line->bench.panel;
    uint8_t frame[PANEL_FRAME_BYTES];
    switch (throw_dice(12)) {
    case 0:
        memcpy(frame, panel->frame, panel->n_frame);
        frame[5 + throw_dice((uint32_t)panel->n_frame - 5)] ^= 0x10;
        write_paced(line, frame, panel->n_frame);
        break;
    case 1:
        write_paced(line, panel->frame, 5 + throw_dice((uint32_t)panel->n_frame - 5));
        break;
    case 2: {
        struct panel deaf = *panel;
        write_paced(line, panel->frame, panel->n_frame);
        read_reply(line, reply);
        line->bench.panel = deaf;
        break;
    }
    default:
        break;
    }
}

static void test_ten_thousand_cards(void **state)
{
    (void)state;
    struct line line;
    struct panel_reply reply;
    unsigned queued = 0, arrived = 0;
    open_line(&line, true, false, 0);
    make_secure(&line);
    while (arrived < 10000) {
        uint8_t card[4] = {1, 2, (uint8_t)(queued >> 8), (uint8_t)queued};
        while (queued < 10000 && iso_osdp_port_card(line.port, card, 32) == 0) {
            queued++;
            card[2] = (uint8_t)(queued >> 8);
            card[3] = (uint8_t)queued;
        }
        panel_make(&line.bench.panel, 0x60, NULL, 0);
        spoil(&line, &reply);
        insist(&line, &reply);
        if (reply.code == 0x50) {
            assert_int_equal(reply.data[6] << 8 | reply.data[7], arrived);
            arrived++;
        }
    }
    assert_int_equal(ask(&line, 0x60, NULL, 0, &reply), 0x40);
    struct iso_osdp_port_status status;
    iso_osdp_port_look(line.port, &status);
    assert_int_equal(status.device.delivered, 10000);
    assert_int_equal(status.device.undelivered, 0);
    assert_true(status.device.repeated > 400);
    assert_true(status.device.damaged > 400);
    close_line(&line);
}

static void test_comset_changes_the_line(void **state)
{
    (void)state;
    struct line line;
    struct panel_reply reply;
    struct termios now;
    const uint8_t comset[5] = {9, 0x00, 0xE1, 0x00, 0x00};
    open_line(&line, false, true, 9600);
    assert_int_equal(ask(&line, 0x6E, comset, 5, &reply), 0x54);
    assert_memory_equal(reply.data, comset, 5);
    line.bench.panel.address = 9;
    line.bench.panel.sequence = -1;
    assert_int_equal(ask(&line, 0x60, NULL, 0, &reply), 0x40);
    assert_int_equal(tcgetattr(line.master, &now), 0);
    assert_int_equal(cfgetospeed(&now), B57600);
    assert_int_equal(line.bench.saved.address, 9);
    assert_int_equal(line.bench.saved.baud, 57600);
    close_line(&line);
}

static bool has_news(const struct line *line, int wait_ms)
{
    struct pollfd wait = {.fd = iso_osdp_port_event_fd(line->port), .events = POLLIN};
    return poll(&wait, 1, wait_ms) == 1;
}

static void test_owner_is_told(void **state)
{
    (void)state;
    struct line line;
    struct panel_reply reply;
    struct iso_osdp_port_status status;
    open_line(&line, true, true, 0);
    assert_false(has_news(&line, 0));
    assert_int_equal(ask(&line, 0x60, NULL, 0, &reply), 0x40);
    assert_true(has_news(&line, 10000));
    iso_osdp_port_look(line.port, &status);
    assert_true(status.device.online);
    assert_false(has_news(&line, 0));
    /* What is the same as before is no news. */
    assert_int_equal(ask(&line, 0x60, NULL, 0, &reply), 0x40);
    assert_false(has_news(&line, 0));
    assert_int_equal(ask(&line, 0x6B, "\0\1\0\1\1\1x", 7, &reply), 0x40);
    assert_true(has_news(&line, 10000));
    iso_osdp_port_look(line.port, &status);
    assert_string_equal(status.device.shown.text[0], "x");
    iso_osdp_port_install(line.port);
    assert_true(has_news(&line, 0));
    /* The other states reach the panel, too. */
    iso_osdp_port_set_tamper(line.port, true);
    assert_int_equal(ask(&line, 0x60, NULL, 0, &reply), 0x48);
    iso_osdp_port_set_reader(line.port, 1);
    assert_int_equal(ask(&line, 0x60, NULL, 0, &reply), 0x4B);
    iso_osdp_port_set_input(line.port, 2, true);
    assert_int_equal(ask(&line, 0x60, NULL, 0, &reply), 0x49);
    assert_int_equal(iso_osdp_port_digits(line.port, "7#"), 0);
    assert_int_equal(ask(&line, 0x60, NULL, 0, &reply), 0x53);
    close_line(&line);
}

static void test_line_that_is_gone(void **state)
{
    (void)state;
    struct line line;
    struct iso_osdp_port_status status;
    open_line(&line, false, true, 0);
    (void)close(line.master);
    assert_true(has_news(&line, 10000));
    iso_osdp_port_look(line.port, &status);
    assert_true(status.line_gone);
    iso_osdp_port_free(line.port);
}

static void assert_refused(const char *path, int error, enum iso_fault_code code, const char *text)
{
    struct bench bench = {0};
    struct iso_osdp_setup setup = bench_setup(&bench, false, true);
    struct iso_osdp_port *port = NULL;
    struct iso_fault fault = {.text = ""};
    assert_int_equal(iso_osdp_port_new(path, &setup, &real_clock, &port, &fault), error);
    assert_null(port);
    assert_int_equal(fault.code, code);
    assert_string_equal(fault.text, text);
}

static void test_lines_that_are_refused(void **state)
{
    (void)state;
    struct line line;
    char text[128];
    assert_refused("/dev/tty-of-nobody", -ENODEV, ISO_FAULT_LINE_MISSING,
                   "osdp: /dev/tty-of-nobody: No such file or directory");
    assert_refused("/dev/null", -ENODEV, ISO_FAULT_LINE_MISSING,
                   "osdp: /dev/null is not a serial line");
    open_line(&line, false, true, 0);
    (void)strcat(strcat(strcpy(text, "osdp: "), line.path), ": another program uses this line");
    assert_refused(line.path, -EBUSY, ISO_FAULT_LINE_BUSY, text);
    struct bench bench = {0};
    struct iso_osdp_setup setup = bench_setup(&bench, false, true);
    struct iso_osdp_port *port = NULL;
    struct iso_fault fault;
    setup.saved.address = 0x7F;
    assert_int_equal(iso_osdp_port_new(line.path, &setup, &real_clock, &port, &fault), -EINVAL);
    int fd = -1;
    close_line(&line);
    open_line(&line, false, true, 0);
    iso_osdp_port_free(line.port);
    assert_int_equal(iso_osdp_serial_open(line.path, 4800, &fd, &fault), -EINVAL);
    assert_int_equal(fd, -1);
    (void)close(line.master);
    iso_osdp_port_free(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_speed),
        cmocka_unit_test(test_ten_thousand_cards),
        cmocka_unit_test(test_comset_changes_the_line),
        cmocka_unit_test(test_owner_is_told),
        cmocka_unit_test(test_line_that_is_gone),
        cmocka_unit_test(test_lines_that_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
