/* A device on a serial line. The line is a pseudo-terminal; the panel of the tests is at its other
 * end and sends its bytes as fast as the line would carry them. Time is real here. */
#include <errno.h>
#include <poll.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

#include "drivers/door/osdp/osdp_port.h"
#include "drivers/door/osdp/osdp_serial.h"
#include "tests/drivers/door/osdp/osdp_bench.h"
#include "tests/drivers/door/osdp/osdp_line.h"

static int64_t read_clock(void *context)
{
    struct timespec now;
    (void)context;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec * BENCH_SECOND_NS + now.tv_nsec;
}

static const struct iso_clock real_clock = {read_clock, NULL};

struct rig {
    struct osdp_line line;
    struct bench bench; /* only its store is used */
    struct iso_osdp_port *port;
};

static void open_rig(struct rig *rig, bool has_key, bool plain, uint32_t baud)
{
    struct iso_fault absent, fault;
    memset(rig, 0, sizeof *rig);
    osdp_line_open(&rig->line, baud);
    struct iso_osdp_setup setup = bench_setup(&rig->bench, has_key, plain);
    setup.saved.baud = baud ? baud : 115200;
    setup.random = NULL; /* the port has its own */
    assert_int_equal(
        iso_osdp_port_new(rig->line.path, &setup, &real_clock, &rig->port, &absent, &fault), 0);
    assert_string_equal(absent.text, "");
}

static void close_rig(struct rig *rig)
{
    iso_osdp_port_free(rig->port);
    osdp_line_close(&rig->line);
}

static int ask(struct rig *rig, uint8_t command, const void *data, size_t n,
               struct panel_reply *reply)
{
    return osdp_line_ask(&rig->line, command, data, n, reply);
}

static void test_every_speed(void **state)
{
    (void)state;
    static const uint32_t speeds[] = {9600, 19200, 38400, 57600, 115200};
    static const speed_t codes[] = {B9600, B19200, B38400, B57600, B115200};
    for (size_t i = 0; i < sizeof speeds / sizeof *speeds; i++) {
        struct rig rig;
        struct panel_reply reply;
        struct termios now;
        const uint8_t text[] = "\0\2\0\1\1\40"
                               "A text that is as long as can be";
        const uint8_t card[5] = {0xDE, 0xAD, 0xBE, 0xEF, 0x40};
        open_rig(&rig, true, i % 2, speeds[i]);
        assert_int_equal(tcgetattr(rig.line.master, &now), 0);
        assert_int_equal(cfgetospeed(&now), codes[i]);
        assert_int_equal(now.c_lflag & (ICANON | ECHO), 0);
        if (i % 2 == 0) {
            assert_true(osdp_line_secure(&rig.line, bench_key));
        }
        assert_int_equal(ask(&rig, 0x61, "", 1, &reply), 0x45);
        assert_int_equal(ask(&rig, 0x6B, text, 6 + 32, &reply), 0x40);
        assert_int_equal(iso_osdp_port_card(rig.port, card, 34), 0);
        assert_int_equal(ask(&rig, 0x60, NULL, 0, &reply), 0x50);
        assert_memory_equal(reply.data + 4, card, 5);
        assert_int_equal(ask(&rig, 0x60, NULL, 0, &reply), 0x40);
        struct iso_osdp_port_status status;
        iso_osdp_port_look(rig.port, &status);
        assert_string_equal(status.device.shown.text[1], "s long as can be");
        assert_int_equal(status.device.delivered, 1);
        assert_int_equal(status.device.secure, i % 2 == 0);
        close_rig(&rig);
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
static void spoil(struct rig *rig, struct panel_reply *reply)
{
    const struct panel *panel = &rig->line.panel;
    uint8_t frame[PANEL_FRAME_BYTES];
    switch (throw_dice(12)) {
    case 0:
        memcpy(frame, panel->frame, panel->n_frame);
        frame[5 + throw_dice((uint32_t)panel->n_frame - 5)] ^= 0x10;
        osdp_line_write(&rig->line, frame, panel->n_frame);
        break;
    case 1:
        osdp_line_write(&rig->line, panel->frame, 5 + throw_dice((uint32_t)panel->n_frame - 5));
        break;
    case 2: {
        struct panel deaf = *panel;
        osdp_line_write(&rig->line, panel->frame, panel->n_frame);
        osdp_line_read(&rig->line, reply);
        rig->line.panel = deaf;
        break;
    }
    default:
        break;
    }
}

static void test_ten_thousand_cards(void **state)
{
    (void)state;
    struct rig rig;
    struct panel_reply reply;
    unsigned queued = 0, arrived = 0;
    open_rig(&rig, true, false, 0);
    assert_true(osdp_line_secure(&rig.line, bench_key));
    while (arrived < 10000) {
        uint8_t card[4] = {1, 2, (uint8_t)(queued >> 8), (uint8_t)queued};
        while (queued < 10000 && iso_osdp_port_card(rig.port, card, 32) == 0) {
            queued++;
            card[2] = (uint8_t)(queued >> 8);
            card[3] = (uint8_t)queued;
        }
        panel_make(&rig.line.panel, 0x60, NULL, 0);
        spoil(&rig, &reply);
        osdp_line_insist(&rig.line, &reply);
        if (reply.code == 0x50) {
            assert_int_equal(reply.data[6] << 8 | reply.data[7], arrived);
            arrived++;
        }
    }
    assert_int_equal(ask(&rig, 0x60, NULL, 0, &reply), 0x40);
    struct iso_osdp_port_status status;
    iso_osdp_port_look(rig.port, &status);
    assert_int_equal(status.device.delivered, 10000);
    assert_int_equal(status.device.undelivered, 0);
    assert_true(status.device.repeated > 400);
    assert_true(status.device.damaged > 400);
    close_rig(&rig);
}

static void test_comset_changes_the_line(void **state)
{
    (void)state;
    struct rig rig;
    struct panel_reply reply;
    struct termios now;
    const uint8_t comset[5] = {9, 0x00, 0xE1, 0x00, 0x00};
    open_rig(&rig, false, true, 9600);
    assert_int_equal(ask(&rig, 0x6E, comset, 5, &reply), 0x54);
    assert_memory_equal(reply.data, comset, 5);
    rig.line.panel.address = 9;
    rig.line.panel.sequence = -1;
    assert_int_equal(ask(&rig, 0x60, NULL, 0, &reply), 0x40);
    assert_int_equal(tcgetattr(rig.line.master, &now), 0);
    assert_int_equal(cfgetospeed(&now), B57600);
    close_rig(&rig);
    assert_int_equal(rig.bench.saved.address, 9);
    assert_int_equal(rig.bench.saved.baud, 57600);
}

static bool has_news(const struct rig *rig, int wait_ms)
{
    struct pollfd wait = {.fd = iso_osdp_port_event_fd(rig->port), .events = POLLIN};
    return poll(&wait, 1, wait_ms) == 1;
}

static void test_owner_is_told(void **state)
{
    (void)state;
    struct rig rig;
    struct panel_reply reply;
    struct iso_osdp_port_status status;
    open_rig(&rig, true, true, 0);
    assert_false(has_news(&rig, 0));
    assert_int_equal(ask(&rig, 0x60, NULL, 0, &reply), 0x40);
    assert_true(has_news(&rig, 10000));
    iso_osdp_port_look(rig.port, &status);
    assert_true(status.device.online);
    assert_false(has_news(&rig, 0));
    /* What is the same as before is no news. */
    assert_int_equal(ask(&rig, 0x60, NULL, 0, &reply), 0x40);
    assert_false(has_news(&rig, 0));
    assert_int_equal(ask(&rig, 0x6B, "\0\1\0\1\1\1x", 7, &reply), 0x40);
    assert_true(has_news(&rig, 10000));
    iso_osdp_port_look(rig.port, &status);
    assert_string_equal(status.device.shown.text[0], "x");
    iso_osdp_port_install(rig.port);
    assert_true(has_news(&rig, 0));
    /* The other states reach the panel, too. */
    iso_osdp_port_set_tamper(rig.port, true);
    assert_int_equal(ask(&rig, 0x60, NULL, 0, &reply), 0x48);
    iso_osdp_port_set_reader(rig.port, 1);
    assert_int_equal(ask(&rig, 0x60, NULL, 0, &reply), 0x4B);
    iso_osdp_port_set_input(rig.port, 2, true);
    assert_int_equal(ask(&rig, 0x60, NULL, 0, &reply), 0x49);
    assert_int_equal(iso_osdp_port_digits(rig.port, "7#"), 0);
    assert_int_equal(ask(&rig, 0x60, NULL, 0, &reply), 0x53);
    close_rig(&rig);
}

static void test_line_that_is_gone(void **state)
{
    (void)state;
    struct rig rig;
    struct iso_osdp_port_status status;
    open_rig(&rig, false, true, 0);
    (void)close(rig.line.master);
    assert_true(has_news(&rig, 10000));
    iso_osdp_port_look(rig.port, &status);
    assert_true(status.line_gone);
    iso_osdp_port_free(rig.port);
}

/* The line is gone, for this reason, and may come. */
static void assert_absent(const char *path, const char *text)
{
    struct bench bench = {0};
    const struct iso_osdp_setup setup = bench_setup(&bench, false, true);
    struct iso_osdp_port *port = NULL;
    struct iso_osdp_port_status status;
    struct iso_fault absent = {.text = ""}, fault;
    assert_int_equal(iso_osdp_port_new(path, &setup, &real_clock, &port, &absent, &fault), 0);
    assert_int_equal(absent.code, ISO_FAULT_PANEL_LINE);
    assert_string_equal(absent.text, text);
    iso_osdp_port_look(port, &status);
    assert_true(status.line_gone);
    iso_osdp_port_free(port);
}

static void test_lines_that_may_come(void **state)
{
    (void)state;
    struct rig rig;
    char text[128];
    assert_absent("/dev/tty-of-nobody", "osdp: /dev/tty-of-nobody: No such file or directory");
    open_rig(&rig, false, true, 0);
    (void)snprintf(text, sizeof text, "osdp: %s: another program uses this line", rig.line.path);
    assert_absent(rig.line.path, text);
    close_rig(&rig);
}

static void test_lines_that_are_refused(void **state)
{
    (void)state;
    struct rig rig;
    struct bench bench = {0};
    struct iso_osdp_setup setup = bench_setup(&bench, false, true);
    struct iso_osdp_port *port = NULL;
    struct iso_fault absent, fault = {.text = ""};
    int fd = -1;
    assert_int_equal(iso_osdp_port_new("/dev/null", &setup, &real_clock, &port, &absent, &fault),
                     -EINVAL);
    assert_string_equal(fault.text, "osdp: /dev/null is not a serial line");
    assert_int_equal(fault.code, ISO_FAULT_PANEL_LINE);
    setup.saved.address = 0x7F;
    assert_int_equal(iso_osdp_port_new("/dev/null", &setup, &real_clock, &port, &absent, &fault),
                     -EINVAL);
    assert_string_equal(fault.text, "osdp: this setup is not possible");
    assert_null(port);
    open_rig(&rig, false, true, 0);
    iso_osdp_port_free(rig.port);
    assert_int_equal(iso_osdp_serial_open(rig.line.path, 4800, &fd, &fault), -EINVAL);
    assert_int_equal(fd, -1);
    osdp_line_close(&rig.line);
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
        cmocka_unit_test(test_lines_that_may_come),
        cmocka_unit_test(test_lines_that_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
