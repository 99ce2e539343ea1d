/* The daemon with a card reader over OSDP, on a pseudo-terminal. It is confined as always. It takes
 * cards, warns of a wire without a key, and finds the line again when it was unplugged. */
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/base/times.h"
#include "drivers/door/osdp/osdp_port.h"
#include "tests/drivers/reader/reader_wire.h"
#include "tests/support/programs/private_bus.h"
#include "tests/support/programs/run.h"
#include "tests/support/scratch.h"

#define DATA ISOTHERM_SOURCE_DIR "/core/data"
#define WARNING \
    "[reader] osdp_key is empty: anyone on the wire of the card reader can read and forge"

static const char program[] = ISOTHERM_BINARY_DIR "/firmware/isothermd";
static const uint8_t key[16] = {0xFE, 0xDC, 0xBA, 0x98, 0x76, 0x54, 0x32, 0x10,
                                0x01, 0x23, 0x45, 0x67, 0x89, 0xAB, 0xCD, 0xEF};
static struct private_bus bus;

struct rig {
    struct reader_wire wire;
    struct iso_osdp_port *device;
    struct run run;
};

static int store(void *context, const struct iso_osdp_saved *saved)
{
    (void)context;
    (void)saved;
    return 0;
}

static const char *write_configuration(const char *directory, const char *line, const char *more)
{
    static char text[2048];
    const char *path = scratch_path(directory, "c.conf");
    (void)snprintf(text, sizeof text,
                   "[sensor]\npath = %s/slot\n[gallery]\npath = %s/g.db\n[log]\npath = %s/a.log\n"
                   "[bus]\naddress = %s\n"
                   "[model]\nhead = " DATA "/head.model\nmetric = " DATA "/face.metric\n"
                   "[reader]\nosdp_port = %s\nosdp_address = 3\nosdp_baud = 38400\n%s\n",
                   directory, directory, directory, bus.address, line, more);
    scratch_write_text(path, text);
    return path;
}

static void start(struct rig *rig, const char *directory, bool secure, const char *more)
{
    const struct iso_times times = iso_times_system();
    struct iso_fault absent = {.text = ""}, fault;
    struct iso_osdp_setup setup = {
        .saved = {.address = 3, .baud = 38400, .has_key = secure},
        .plain = !secure,
        .store = store,
    };
    memcpy(setup.saved.key, key, secure ? sizeof key : 0);
    memset(rig, 0, sizeof *rig);
    reader_wire_open(&rig->wire, directory);
    assert_int_equal(iso_osdp_port_new(rig->wire.reader_path, &setup, &times.monotonic,
                                       &rig->device, &absent, &fault),
                     0);
    const char *path = write_configuration(directory, rig->wire.appliance_path, more);
    const char *const argv[] = {program, "--config", path, NULL};
    run_start(&rig->run, argv);
    run_until(&rig->run, "ready");
}

static void stop(struct rig *rig)
{
    assert_int_equal(kill(rig->run.pid, SIGTERM), 0);
    run_finish(&rig->run);
    run_expect(&rig->run, 0);
    iso_osdp_port_free(rig->device);
    reader_wire_close(&rig->wire);
}

/* Shows cards until the daemon has taken so many. */
static void show_cards(struct rig *rig, unsigned n)
{
    const uint8_t card[4] = {0xDE, 0xAD, 0xBE, 0xEF};
    const struct timespec moment = {0, 10000000};
    struct iso_osdp_port_status status;
    do {
        (void)nanosleep(&moment, NULL);
        iso_osdp_port_look(rig->device, &status);
        if (status.device.waiting == 0) {
            (void)!iso_osdp_port_card(rig->device, card, 32);
        }
    } while (status.device.delivered < n);
}

static void takes_cards_of_a_plain_reader(void **state)
{
    struct rig rig;
    start(&rig, *state, false, "");
    run_until(&rig.run, WARNING);
    show_cards(&rig, 3);
    reader_wire_unplug(&rig.wire);
    run_until(&rig.run, ": No such file or directory");
    reader_wire_plug(&rig.wire);
    run_until(&rig.run, "the card reader works again");
    show_cards(&rig, 6);
    stop(&rig);
    run_free(&rig.run);
}

static void takes_cards_in_the_secure_channel(void **state)
{
    struct rig rig;
    struct iso_osdp_port_status status;
    char more[300];
    const char *path = scratch_path(*state, "reader.key");
    if (geteuid() != 0) {
        print_message("the key has to belong to root\n");
        skip();
    }
    scratch_write_text(path, "fedcba98765432100123456789abcdef\n");
    assert_int_equal(chmod(path, 0640), 0);
    (void)snprintf(more, sizeof more, "osdp_key = %s\n", path);
    start(&rig, *state, true, more);
    show_cards(&rig, 3);
    iso_osdp_port_look(rig.device, &status);
    assert_true(status.device.secure);
    stop(&rig);
    assert_null(strstr(rig.run.err, WARNING));
    assert_null(strstr(rig.run.err, "card reader"));
    run_free(&rig.run);
}

static void does_not_start_without_its_key(void **state)
{
    struct run run;
    const char *path = write_configuration(*state, "/dev/ttyS0", "osdp_key = /nonexistent/key\n");
    const char *const argv[] = {program, "--check-config", "--config", path, NULL};
    run_start(&run, argv);
    run_finish(&run);
    run_expect(&run, 3);
    assert_non_null(strstr(run.err, "/nonexistent/key: No such file or directory"));
    run_free(&run);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, scratch_setup, scratch_teardown)
    const struct CMUnitTest tests[] = {
        TEST(takes_cards_of_a_plain_reader),
        TEST(takes_cards_in_the_secure_channel),
        TEST(does_not_start_without_its_key),
    };
    if (!private_bus_start(&bus)) {
        return TEST_SKIPPED;
    }
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    private_bus_stop(&bus);
    return failed;
}
