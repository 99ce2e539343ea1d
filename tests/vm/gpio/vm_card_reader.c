/* A card reader with Wiegand lines on lines of the kernel: the test pulls the other ends. A pulse
 * of a test is longer than that of a reader, because the machine is emulated. */
#include <poll.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

#include "drivers/door/wiegand.h"
#include "drivers/reader/wiegand_in.h"
#include "tests/vm/gpio/gpio_sim.h"

enum { CARDS = 100, ATTEMPTS = 1000, PATIENCE_MS = 20000 };

static struct iso_gpio_spec spec_of(const char *text)
{
    struct iso_gpio_spec spec;
    assert_int_equal(iso_gpio_spec_parse("test", text, &spec, NULL), 0);
    return spec;
}

static struct iso_wiegand_in *open_reader(void)
{
    const struct iso_gpio_spec lines[2] = {spec_of("CARD2 active-low pull-up"),
                                           spec_of("CARD3 active-low pull-up")};
    struct iso_wiegand_in *reader = NULL;
    struct iso_fault fault = {.text = ""};
    if (iso_wiegand_in_new(lines, &reader, &fault)) {
        fail_msg("%s", fault.text);
    }
    return reader;
}

static int64_t clock_ns(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec * INT64_C(1000000000) + now.tv_nsec;
}

/* Sends a code. Returns false if a pulse of it came so late that it is no frame of a reader,
 * because the machine that is emulated stood still. */
static bool send(uint64_t code, int bits)
{
    bool in_time = true;
    int64_t last_ns = clock_ns();
    for (int i = bits - 1; i >= 0; i--) {
        const unsigned line = code >> i & 1 ? 3 : 2;
        gpio_sim_pull("reader", line, false);
        gpio_sim_pull("reader", line, true);
        const int64_t now_ns = clock_ns();
        in_time = in_time && now_ns - last_ns < ISO_WIEGAND_GAP_NS / 2;
        last_ns = now_ns;
    }
    return in_time;
}

static struct iso_reader_event take(struct iso_wiegand_in *reader)
{
    struct iso_reader_event event;
    struct pollfd fd = {.fd = iso_wiegand_in_fd(reader), .events = POLLIN};
    while (!iso_wiegand_in_take(reader, &event)) {
        assert_int_equal(poll(&fd, 1, PATIENCE_MS), 1);
    }
    return event;
}

/* Sends a code until it was in time, and returns what the reader made of it. What became of the
 * attempts that were not in time is not judged. */
static struct iso_reader_event deliver(struct iso_wiegand_in *reader, uint64_t code, int bits)
{
    struct iso_reader_event event;
    for (int attempt = 0; !send(code, bits); attempt++) {
        assert_true(attempt < ATTEMPTS);
        (void)usleep(200000);
        while (iso_wiegand_in_take(reader, &event)) {
        }
    }
    return take(reader);
}

static void every_card_and_key_arrives_once(void **state)
{
    struct iso_wiegand_in *reader = open_reader();
    struct iso_reader_event event;
    (void)state;
    for (unsigned i = 0; i < CARDS; i++) {
        const struct iso_wiegand_card card = {i, 40 * i + 7};
        uint64_t code = 0;
        assert_int_equal(iso_wiegand_encode(26, &card, &code), 0);
        event = deliver(reader, code, 26);
        assert_int_equal(event.kind, ISO_READER_CARD);
        assert_int_equal(event.code, code);
        event = deliver(reader, i % 10, 4);
        assert_int_equal(event.kind, ISO_READER_KEY);
        assert_int_equal(event.key, '0' + i % 10);
    }
    (void)usleep(200000);
    assert_false(iso_wiegand_in_take(reader, &event));
    iso_wiegand_in_free(reader);
}

static void wait_for_fault(struct iso_wiegand_in *reader, bool wanted)
{
    struct iso_fault fault = {.text = ""};
    for (int i = 0; i < PATIENCE_MS / 10; i++) {
        iso_wiegand_in_fault(reader, &fault);
        if ((*fault.text != '\0') == wanted) {
            return;
        }
        (void)usleep(10000);
    }
    fail_msg("after %d ms the fault is '%s'", PATIENCE_MS, fault.text);
}

static void a_reader_comes_back(void **state)
{
    struct iso_wiegand_in *reader = open_reader();
    (void)state;
    for (int i = 0; i < 5; i++) {
        gpio_sim_plug("reader", false);
        wait_for_fault(reader, true);
        gpio_sim_plug("reader", true);
        gpio_sim_pull("reader", 2, true);
        gpio_sim_pull("reader", 3, true);
        wait_for_fault(reader, false);
        assert_int_equal(deliver(reader, 5, 4).key, '5');
    }
    iso_wiegand_in_free(reader);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_card_and_key_arrives_once),
        cmocka_unit_test(a_reader_comes_back),
    };
    gpio_sim_make("reader", "CARD");
    gpio_sim_pull("reader", 2, true);
    gpio_sim_pull("reader", 3, true);
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    gpio_sim_remove("reader");
    return failed;
}
