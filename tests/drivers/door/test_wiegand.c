/* Wiegand: the bits of codes on the wire, and the sender on lines that the test records. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <time.h>

#include <cmocka.h>

#include "drivers/door/wiegand.h"
#include "drivers/door/wiegand_out.h"

/* ---- codes ---- */

/* Calculated by hand from the definitions of the formats. */
static const struct {
    int bits;
    struct iso_wiegand_card card;
    const char *wire;
} known[] = {
    {26, {1, 1}, "10000000100000000000000010"},
    {26, {255, 65535}, "01111111111111111111111111"},
    {26, {0, 0}, "00000000000000000000000001"},
    {26, {18, 52 * 256 + 86}, "00001001000110100010101100"},
    {34, {1, 3}, "1000000000000000100000000000000111"},
    {34, {0x8001, 0x0100}, "0100000000000000100000001000000000"},
};

static uint64_t code_of(const char *wire)
{
    uint64_t code = 0;
    for (; *wire; wire++) {
        code = code << 1 | (*wire == '1');
    }
    return code;
}

static void encodes_and_decodes(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        struct iso_wiegand_card card = {4711, 4711};
        uint64_t code = 4711;
        assert_int_equal(strlen(known[i].wire), known[i].bits);
        assert_int_equal(iso_wiegand_encode(known[i].bits, &known[i].card, &code), 0);
        assert_int_equal(code, code_of(known[i].wire));
        assert_int_equal(iso_wiegand_decode(known[i].bits, code, &card), 0);
        assert_memory_equal(&card, &known[i].card, sizeof card);
    }
}

static void refuses_what_does_not_fit(void **state)
{
    const struct iso_wiegand_card facility = {256, 1}, wide = {65536, 1}, number = {1, 65536};
    uint64_t code = 4711;
    (void)state;
    assert_int_equal(iso_wiegand_encode(26, &facility, &code), -ERANGE);
    assert_int_equal(iso_wiegand_encode(34, &wide, &code), -ERANGE);
    assert_int_equal(iso_wiegand_encode(26, &number, &code), -ERANGE);
    assert_int_equal(iso_wiegand_encode(37, &facility, &code), -EINVAL);
    assert_int_equal(code, 4711);
    assert_int_equal(iso_wiegand_encode(34, &facility, &code), 0);
}

/* Tries an error in each bit. */
static void every_single_error_is_seen(void **state)
{
    const struct iso_wiegand_card card = {0x5a, 0x1234};
    (void)state;
    for (int bits = 26; bits <= 34; bits += 8) {
        uint64_t code = 0;
        assert_int_equal(iso_wiegand_encode(bits, &card, &code), 0);
        for (int bit = 0; bit < bits; bit++) {
            struct iso_wiegand_card read = {4711, 4711};
            assert_int_equal(iso_wiegand_decode(bits, code ^ UINT64_C(1) << bit, &read), -EBADMSG);
            assert_int_equal(read.facility, 4711);
        }
        assert_int_equal(iso_wiegand_decode(bits, code | UINT64_C(1) << bits, NULL), -EINVAL);
    }
    assert_int_equal(iso_wiegand_decode(37, 0, NULL), -EINVAL);
}

/* ---- the sender ---- */

struct wire {
    char bits[65]; /* the bits that a reader receives */
    int n, fail_at, error;
    bool pulse[2];
    int64_t delay_ns; /* how long a line takes to be switched on */
    int64_t on_ns, shortest_ns;
    bool strange; /* two lines at a time, or the same level twice */
};

static int64_t clock_ns(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec * INT64_C(1000000000) + now.tv_nsec;
}

static void measure_pulses(struct wire *wire, bool pulse)
{
    const int64_t begin_ns = clock_ns();
    if (!pulse && (wire->shortest_ns == 0 || begin_ns - wire->on_ns < wire->shortest_ns)) {
        wire->shortest_ns = begin_ns - wire->on_ns;
    }
    while (pulse && clock_ns() < begin_ns + wire->delay_ns) {
    }
    wire->on_ns = clock_ns();
}

static int set_line(void *context, int line, bool pulse)
{
    struct wire *wire = context;
    wire->strange |= pulse == wire->pulse[line] || (pulse && wire->pulse[!line]);
    wire->pulse[line] = pulse;
    measure_pulses(wire, pulse);
    if (pulse && wire->n < 64) {
        wire->bits[wire->n++] = (char)('0' + line);
    }
    return pulse && wire->error && wire->n == wire->fail_at ? wire->error : 0;
}

static struct iso_wiegand_out *open_out(struct wire *wire)
{
    const struct iso_wiegand_lines lines = {set_line, wire};
    struct iso_wiegand_out *out = NULL;
    assert_int_equal(iso_wiegand_out_new(&lines, &out, NULL), 0);
    return out;
}

static void sends_what_a_reader_reads(void **state)
{
    struct wire wire = {.n = 0};
    struct iso_wiegand_out *out = open_out(&wire);
    struct iso_wiegand_report report;
    (void)state;
    assert_int_equal(iso_wiegand_out_send(out, code_of(known[3].wire), 26), 0);
    assert_int_equal(iso_wiegand_out_send(out, 1, 26), -EBUSY);
    assert_int_equal(iso_wiegand_out_flush(out), 0);
    assert_string_equal(wire.bits, known[3].wire);
    wire.n = 0;
    assert_int_equal(iso_wiegand_out_send(out, code_of(known[4].wire), 34), 0);
    assert_int_equal(iso_wiegand_out_flush(out), 0);
    assert_string_equal(wire.bits, known[4].wire);
    iso_wiegand_out_report(out, &report);
    iso_wiegand_out_free(out);
    assert_true(!wire.strange && !wire.pulse[0] && !wire.pulse[1]);
    assert_int_equal(report.codes, 2);
    assert_int_equal(report.pulses, 60);
    /* The pulses are never too short. How much longer they are depends on the machine. */
    assert_true(report.pulse_min_ns >= ISO_WIEGAND_PULSE_NS);
    assert_true(report.interval_min_ns >= ISO_WIEGAND_INTERVAL_NS);
    assert_true(report.pulse_max_ns >= report.pulse_min_ns);
    assert_true(report.interval_max_ns >= report.interval_min_ns);
    print_message("%s: pulses %.0f to %.0f us, intervals %.0f to %.0f us\n",
                  report.realtime ? "SCHED_FIFO" : "no SCHED_FIFO",
                  (double)report.pulse_min_ns / 1e3, (double)report.pulse_max_ns / 1e3,
                  (double)report.interval_min_ns / 1e3, (double)report.interval_max_ns / 1e3);
}

/* Simulates another process that gets the processor just before the line is switched. */
static void a_late_pulse_is_no_shorter(void **state)
{
    struct wire wire = {.delay_ns = 3 * ISO_WIEGAND_PULSE_NS};
    struct iso_wiegand_out *out = open_out(&wire);
    (void)state;
    assert_int_equal(iso_wiegand_out_send(out, code_of(known[3].wire), 26), 0);
    assert_int_equal(iso_wiegand_out_flush(out), 0);
    iso_wiegand_out_free(out);
    assert_string_equal(wire.bits, known[3].wire);
    assert_true(wire.shortest_ns >= ISO_WIEGAND_PULSE_NS);
}

static void reports_a_failure_once(void **state)
{
    struct wire wire = {.fail_at = 5, .error = -ENODEV};
    struct iso_wiegand_out *out = open_out(&wire);
    (void)state;
    assert_int_equal(iso_wiegand_out_send(out, 0, 26), 0);
    int error;
    while ((error = iso_wiegand_out_send(out, 0, 26)) == -EBUSY) {
        const struct timespec ms = {0, 1000000};
        (void)nanosleep(&ms, NULL);
    }
    assert_int_equal(error, -ENODEV);
    assert_int_equal(wire.n, 5); /* the code was cut off */
    assert_false(wire.pulse[0]);
    assert_int_equal(iso_wiegand_out_flush(out), 0);
    wire.error = 0;
    assert_int_equal(iso_wiegand_out_send(out, 0, 26), 0);
    assert_int_equal(iso_wiegand_out_flush(out), 0);
    iso_wiegand_out_free(out);
}

static void ends_in_the_middle_with_lines_at_rest(void **state)
{
    struct wire wire = {.n = 0};
    struct iso_wiegand_out *out = open_out(&wire);
    (void)state;
    assert_int_equal(iso_wiegand_out_send(out, UINT64_MAX, 64), 0);
    iso_wiegand_out_free(out);
    assert_true(wire.n < 64);
    assert_true(!wire.strange && !wire.pulse[0] && !wire.pulse[1]);
    iso_wiegand_out_free(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(encodes_and_decodes),
        cmocka_unit_test(refuses_what_does_not_fit),
        cmocka_unit_test(every_single_error_is_seen),
        cmocka_unit_test(sends_what_a_reader_reads),
        cmocka_unit_test(a_late_pulse_is_no_shorter),
        cmocka_unit_test(reports_a_failure_once),
        cmocka_unit_test(ends_in_the_middle_with_lines_at_rest),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
