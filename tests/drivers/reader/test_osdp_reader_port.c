/* A reader of OSDP on a serial line. The line is a pair of pseudo-terminals; the project's own
 * device of OSDP is at its other end, with a thread of its own. Time is real, except that a test
 * may let the clock of the appliance jump. */
#include <errno.h>
#include <poll.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include <cmocka.h>

#include "drivers/door/osdp/osdp_port.h"
#include "drivers/reader/osdp_reader_port.h"
#include "tests/drivers/reader/reader_wire.h"
#include "tests/support/scratch.h"

static const uint8_t key[16] = {2, 7, 1, 8, 2, 8, 1, 8, 2, 8, 4, 5, 9, 0, 4, 5};

struct rig {
    struct reader_wire wire;
    atomic_llong ahead_ns;
    struct iso_osdp_port *device;
    struct iso_osdp_reader_port *reader;
};

static int64_t read_clock(void *context)
{
    struct rig *rig = context;
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec * INT64_C(1000000000) + now.tv_nsec + (rig ? atomic_load(&rig->ahead_ns) : 0);
}

static int store(void *context, const struct iso_osdp_saved *saved)
{
    (void)context;
    (void)saved;
    return 0;
}

static void open_device(struct rig *rig, bool secure)
{
    struct iso_fault absent = {.text = ""}, fault;
    const struct iso_clock clock = {read_clock, NULL};
    struct iso_osdp_setup setup = {
        .saved = {.address = 9, .baud = 115200, .has_key = secure},
        .plain = !secure,
        .store = store,
    };
    memcpy(setup.saved.key, key, secure ? sizeof key : 0);
    assert_int_equal(
        iso_osdp_port_new(rig->wire.reader_path, &setup, &clock, &rig->device, &absent, &fault), 0);
}

static void open_reader(struct rig *rig, bool secure, uint8_t change, struct iso_fault *fault)
{
    const struct iso_clock clock = {read_clock, rig};
    struct iso_osdp_reader_setup setup = {.address = 9, .baud = 115200, .has_key = secure};
    memcpy(setup.key, key, secure ? sizeof key : 0);
    setup.key[0] ^= change;
    *fault = (struct iso_fault){.text = ""};
    assert_int_equal(
        iso_osdp_reader_port_new(rig->wire.appliance_path, &setup, &clock, &rig->reader, fault), 0);
}

static void open_rig(struct rig *rig, const char *directory, bool secure, uint8_t change)
{
    struct iso_fault fault;
    memset(rig, 0, sizeof *rig);
    reader_wire_open(&rig->wire, directory);
    open_device(rig, secure);
    open_reader(rig, secure, change, &fault);
    assert_string_equal(fault.text, "");
}

static void close_rig(struct rig *rig)
{
    iso_osdp_reader_port_free(rig->reader);
    iso_osdp_port_free(rig->device);
    reader_wire_close(&rig->wire);
}

static bool wait_for_news(struct rig *rig, int ms)
{
    struct pollfd wait = {.fd = iso_osdp_reader_port_fd(rig->reader), .events = POLLIN};
    return poll(&wait, 1, ms) == 1;
}

/* Waits until the fault has this text, with {} for the path of the line. */
static void expect_fault(struct rig *rig, const char *before, const char *after)
{
    char text[512];
    struct iso_fault fault = {.text = ""};
    struct iso_reader_event event;
    (void)snprintf(text, sizeof text, "%s%s%s", before, *before ? rig->wire.appliance_path : "",
                   after);
    do {
        iso_osdp_reader_port_fault(rig->reader, &fault);
        if (strcmp(fault.text, text) == 0) {
            return;
        }
        while (iso_osdp_reader_port_take(rig->reader, &event)) {
        }
        iso_osdp_reader_port_fault(rig->reader, &fault);
    } while (strcmp(fault.text, text) == 0 || wait_for_news(rig, 60000));
    fail_msg("\"%s\" instead of \"%s\"", fault.text, text);
}

static int add(struct rig *rig, unsigned i)
{
    const uint8_t card[4] = {0, 0x77, (uint8_t)(i >> 8), (uint8_t)i};
    const char digit[2] = {"0123456789*#"[i % 12], '\0'};
    return i % 2 ? iso_osdp_port_digits(rig->device, digit)
                 : iso_osdp_port_card(rig->device, card, 32);
}

static void expect_event(const struct iso_reader_event *event, unsigned i)
{
    if (i % 2) {
        assert_int_equal(event->kind, ISO_READER_KEY);
        assert_int_equal(event->key, "0123456789*#"[i % 12]);
    } else {
        assert_int_equal(event->kind, ISO_READER_CARD);
        assert_int_equal(event->bits, 32);
        assert_int_equal(event->code, 0x770000 + i);
    }
}

/* Moves n events through the line, in their order, each once. */
static void move_events(struct rig *rig, unsigned n)
{
    struct iso_reader_event event;
    unsigned queued = 0, arrived = 0;
    while (arrived < n) {
        while (queued < n && add(rig, queued) == 0) {
            queued++;
        }
        (void)wait_for_news(rig, 10);
        while (iso_osdp_reader_port_take(rig->reader, &event)) {
            expect_event(&event, arrived++);
        }
    }
    assert_int_equal(arrived, n);
    assert_false(wait_for_news(rig, 300));
}

/* Waits until the device has had a reply to a POLL accepted, so that nothing is dropped any more.
 */
static void wait_until_polled(struct rig *rig)
{
    struct iso_osdp_reader_status status;
    struct iso_osdp_port_status device;
    const struct timespec moment = {0, 10000000};
    uint64_t commands = 0;
    do {
        (void)nanosleep(&moment, NULL);
        iso_osdp_reader_port_status(rig->reader, &status);
        iso_osdp_port_look(rig->device, &device);
        commands = status.online && commands == 0 ? device.device.commands : commands;
    } while (!status.online || device.device.commands < commands + 3);
}

static void test_two_thousand_events(void **state)
{
    struct rig rig;
    struct iso_osdp_reader_status status;
    open_rig(&rig, *state, true, 0);
    wait_until_polled(&rig);
    atomic_store(&rig.wire.loss, 250);
    move_events(&rig, 2000);
    iso_osdp_reader_port_status(rig.reader, &status);
    assert_true(status.secure);
    assert_int_equal(status.events, 2000);
    assert_int_equal(status.dropped, 0);
    assert_true(status.repeated > 0);
    close_rig(&rig);
}

static void test_plain(void **state)
{
    struct rig rig;
    struct iso_osdp_reader_status status;
    open_rig(&rig, *state, false, 0);
    wait_until_polled(&rig);
    move_events(&rig, 200);
    iso_osdp_reader_port_status(rig.reader, &status);
    assert_false(status.secure);
    /* The reader shows that somebody is let in. */
    struct iso_osdp_port_status device;
    const struct timespec moment = {0, 10000000};
    iso_osdp_reader_port_show(rig.reader, true);
    do {
        (void)nanosleep(&moment, NULL);
        iso_osdp_port_look(rig.device, &device);
    } while (device.device.shown.lamp != ISO_OSDP_GREEN);
    close_rig(&rig);
}

static void test_other_key(void **state)
{
    struct rig rig;
    open_rig(&rig, *state, true, 1);
    expect_fault(&rig, "card reader: the reader on ",
                 " has another key than the one that is configured");
    close_rig(&rig);
}

static void test_adapter_unplugged_and_back(void **state)
{
    struct rig rig;
    open_rig(&rig, *state, true, 0);
    wait_until_polled(&rig);
    reader_wire_unplug(&rig.wire);
    expect_fault(&rig, "osdp: ", ": No such file or directory");
    reader_wire_plug(&rig.wire);
    expect_fault(&rig, "", "");
    wait_until_polled(&rig);
    move_events(&rig, 20);
    close_rig(&rig);
}

static void test_silent_reader_and_back(void **state)
{
    struct rig rig;
    open_rig(&rig, *state, true, 0);
    wait_until_polled(&rig);
    atomic_store(&rig.wire.loss, 1);
    atomic_store(&rig.ahead_ns, ISO_OSDP_READER_SILENCE_NS);
    expect_fault(&rig, "card reader: the reader on ", " does not answer");
    atomic_store(&rig.wire.loss, 0);
    expect_fault(&rig, "", "");
    wait_until_polled(&rig);
    move_events(&rig, 20);
    iso_osdp_port_set_tamper(rig.device, true);
    expect_fault(&rig, "card reader: the reader on ", " says that somebody has opened it");
    iso_osdp_port_set_tamper(rig.device, false);
    expect_fault(&rig, "", "");
    close_rig(&rig);
}

/* A line that is not there is no error: the reader may come later. */
static void test_line_that_comes_later(void **state)
{
    struct rig rig;
    struct iso_fault fault;
    memset(&rig, 0, sizeof rig);
    reader_wire_open(&rig.wire, *state);
    open_device(&rig, false);
    reader_wire_unplug(&rig.wire);
    open_reader(&rig, false, 0, &fault);
    assert_int_equal(fault.code, ISO_FAULT_READER_LOST);
    expect_fault(&rig, "osdp: ", ": No such file or directory");
    reader_wire_plug(&rig.wire);
    expect_fault(&rig, "", "");
    wait_until_polled(&rig);
    move_events(&rig, 20);
    close_rig(&rig);
    /* A setup that is not possible is one. */
    const struct iso_clock clock = {read_clock, NULL};
    const struct iso_osdp_reader_setup setup = {.address = 0x7F, .baud = 9600};
    rig.reader = NULL;
    assert_int_equal(iso_osdp_reader_port_new("/dev/null", &setup, &clock, &rig.reader, &fault),
                     -EINVAL);
    assert_null(rig.reader);
    iso_osdp_reader_port_free(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_two_thousand_events, scratch_setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(test_plain, scratch_setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(test_other_key, scratch_setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(test_adapter_unplugged_and_back, scratch_setup,
                                        scratch_teardown),
        cmocka_unit_test_setup_teardown(test_silent_reader_and_back, scratch_setup,
                                        scratch_teardown),
        cmocka_unit_test_setup_teardown(test_line_that_comes_later, scratch_setup,
                                        scratch_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
