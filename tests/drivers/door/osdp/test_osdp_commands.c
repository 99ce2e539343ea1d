/* Each command of a panel, and what the door station shows then. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "tests/drivers/door/osdp/osdp_bench.h"

#define UNIT_NS (BENCH_SECOND_NS / 10)

static void assert_nak(struct bench *bench, uint8_t command, const void *data, size_t n, int reason)
{
    struct panel_reply reply;
    assert_int_equal(bench_ask(bench, command, data, n, &reply), 0x41);
    assert_int_equal(reply.n, 1);
    assert_int_equal(reply.data[0], reason);
}

static void assert_ack(struct bench *bench, uint8_t command, const void *data, size_t n)
{
    struct panel_reply reply;
    assert_int_equal(bench_ask(bench, command, data, n, &reply), 0x40);
    assert_int_equal(reply.n, 0);
}

static void assert_reply(struct bench *bench, uint8_t command, int code, const void *data, size_t n)
{
    struct panel_reply reply;
    const bool form = command == 0x61 || command == 0x62;
    assert_int_equal(bench_ask(bench, command, "", form, &reply), code);
    assert_int_equal(reply.n, n);
    assert_memory_equal(reply.data, data, n);
}

static void test_identity_and_abilities(void **state)
{
    (void)state;
    struct bench bench;
    static const uint8_t identity[] = {0x11, 0x22, 0x33, 0x44, 0x55, 0x99,
                                       0x88, 0x77, 0x66, 1,    2,    3};
    static const uint8_t abilities[] = {1, 1, 3, 2, 0, 0, 3, 1,  0,    4, 4,  1,    5, 2,  1, 6, 2,
                                        1, 8, 1, 0, 9, 1, 1, 10, 0xA0, 5, 11, 0xA0, 5, 13, 0, 1};
    bench_init(&bench, false, true);
    assert_reply(&bench, 0x61, 0x45, identity, sizeof identity);
    assert_reply(&bench, 0x62, 0x46, abilities, sizeof abilities);
    assert_nak(&bench, 0x61, NULL, 0, 2);
    assert_nak(&bench, 0x62, "12", 2, 2);
    bench_done(&bench);
}

static void test_states(void **state)
{
    (void)state;
    struct bench bench;
    bench_init(&bench, false, true);
    assert_ack(&bench, 0x60, NULL, 0);
    assert_reply(&bench, 0x64, 0x48, "\0\0", 2);
    assert_reply(&bench, 0x65, 0x49, "\0\0\0", 3);
    assert_reply(&bench, 0x66, 0x4A, "", 0);
    assert_reply(&bench, 0x67, 0x4B, "\0", 1);
    iso_osdp_peripheral_set_tamper(bench.device, true);
    iso_osdp_peripheral_set_input(bench.device, 1, true);
    iso_osdp_peripheral_set_input(bench.device, 3, true); /* there are three */
    iso_osdp_peripheral_set_reader(bench.device, 1);
    /* Each change is told once by itself. */
    assert_reply(&bench, 0x60, 0x48, "\1\0", 2);
    assert_reply(&bench, 0x60, 0x4B, "\1", 1);
    assert_reply(&bench, 0x60, 0x49, "\0\1\0", 3);
    assert_ack(&bench, 0x60, NULL, 0);
    assert_reply(&bench, 0x64, 0x48, "\1\0", 2);
    assert_reply(&bench, 0x65, 0x49, "\0\1\0", 3);
    assert_nak(&bench, 0x60, "x", 1, 2);
    assert_nak(&bench, 0x68, "\0\1\0\0", 4, 3); /* OUT */
    assert_nak(&bench, 0xA7, NULL, 0, 3);
    bench_done(&bench);
}

static enum iso_osdp_color lamp(struct bench *bench, int units)
{
    struct iso_osdp_status status;
    iso_osdp_peripheral_status(bench->device, bench->now_ns + units * UNIT_NS, &status);
    return status.shown.lamp;
}

static void test_lamp(void **state)
{
    (void)state;
    struct bench bench;
    bench_init(&bench, false, true);
    assert_int_equal(lamp(&bench, 0), ISO_OSDP_BLACK);
    /* For good: 3 units blue, 2 units off. */
    const uint8_t good[14] = {0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 3, 2, 4, 0};
    assert_ack(&bench, 0x69, good, 14);
    assert_int_equal(lamp(&bench, 0), ISO_OSDP_BLUE);
    assert_int_equal(lamp(&bench, 2), ISO_OSDP_BLUE);
    assert_int_equal(lamp(&bench, 3), ISO_OSDP_BLACK);
    assert_int_equal(lamp(&bench, 5), ISO_OSDP_BLUE);
    /* For 300 units: green. */
    const uint8_t timed[14] = {0, 0, 2, 1, 0, 2, 1, 0x2C, 0x01, 0, 0, 0, 0, 0};
    assert_ack(&bench, 0x69, timed, 14);
    assert_int_equal(lamp(&bench, 299), ISO_OSDP_GREEN);
    assert_int_equal(lamp(&bench, 300), ISO_OSDP_BLUE);
    /* Ended before its time. */
    const uint8_t cancel[14] = {0, 0, 1};
    assert_ack(&bench, 0x69, cancel, 14);
    assert_int_equal(lamp(&bench, 0), ISO_OSDP_BLUE);
    /* Two records: the second one holds. All times 0: the first colour. */
    const uint8_t two[28] = {0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 0, 1, 1,
                             0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 7, 3};
    assert_ack(&bench, 0x69, two, 28);
    assert_int_equal(lamp(&bench, 77), ISO_OSDP_WHITE);
    assert_nak(&bench, 0x69, two, 27, 2);
    assert_nak(&bench, 0x69, NULL, 0, 2);
    const uint8_t wrong[3][14] = {
        {1}, {0, 1}, {0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 8, 0}}; /* reader, lamp, colour */
    for (int i = 0; i < 3; i++) {
        assert_nak(&bench, 0x69, wrong[i], 14, 9);
    }
    assert_int_equal(lamp(&bench, 0), ISO_OSDP_WHITE);
    bench_done(&bench);
}

static bool buzzer(struct bench *bench, int units)
{
    struct iso_osdp_status status;
    iso_osdp_peripheral_status(bench->device, bench->now_ns + units * UNIT_NS, &status);
    return status.shown.buzzer;
}

static void test_buzzer(void **state)
{
    (void)state;
    struct bench bench;
    bench_init(&bench, false, true);
    assert_ack(&bench, 0x6A, "\0\2\2\3\2", 5); /* twice 2 units on, 3 off */
    assert_true(buzzer(&bench, 0));
    assert_true(buzzer(&bench, 1));
    assert_false(buzzer(&bench, 2));
    assert_true(buzzer(&bench, 5));
    assert_false(buzzer(&bench, 10));
    assert_ack(&bench, 0x6A, "\0\2\1\1\0", 5); /* until it is switched off */
    assert_true(buzzer(&bench, 1000));
    assert_false(buzzer(&bench, 1001));
    assert_ack(&bench, 0x6A, "\0\1\0\0\0", 5);
    assert_false(buzzer(&bench, 0));
    assert_nak(&bench, 0x6A, "\0\2\2\2", 4, 2);
    assert_nak(&bench, 0x6A, "\1\2\2\2\1", 5, 9);
    assert_nak(&bench, 0x6A, "\0\3\2\2\1", 5, 9);
    assert_nak(&bench, 0x6A, "\0\2\0\2\1", 5, 9); /* a tone without length */
    bench_done(&bench);
}

static void assert_text(struct bench *bench, const char *first, const char *second)
{
    const struct iso_osdp_status status = bench_status(bench);
    assert_string_equal(status.shown.text[0], first);
    assert_string_equal(status.shown.text[1], second);
}

static void test_text(void **state)
{
    (void)state;
    struct bench bench;
    bench_init(&bench, false, true);
    assert_ack(&bench, 0x6B, "\0\1\0\1\1\5Hello", 11);
    assert_text(&bench, "Hello", "");
    assert_ack(&bench, 0x6B, "\0\1\0\2\3\4door", 10); /* added in row 2, column 3 */
    assert_text(&bench, "Hello", "  door");
    /* It goes on in the next row, or is cut off. */
    assert_ack(&bench, 0x6B, "\0\2\0\1\1\24abcdefghijklmnopqrst", 26);
    assert_text(&bench, "abcdefghijklmnop", "qrst");
    assert_ack(&bench, 0x6B, "\0\1\0\1\1\24abcdefghijklmnopqrst", 26);
    assert_text(&bench, "abcdefghijklmnop", "");
    assert_ack(&bench, 0x6B, "\0\2\0\2\17\4abcd", 10); /* beyond the last row */
    assert_text(&bench, "abcdefghijklmnop", "              ab");
    /* For three seconds. */
    assert_ack(&bench, 0x6B, "\0\3\3\2\1\4wait", 10);
    assert_text(&bench, "", "wait");
    bench.now_ns += 3 * BENCH_SECOND_NS - 1;
    assert_text(&bench, "", "wait");
    bench.now_ns++;
    assert_text(&bench, "abcdefghijklmnop", "              ab");
    /* Control codes and bytes beyond ASCII are not shown. */
    assert_ack(&bench, 0x6B, "\0\1\0\1\1\4a\n\xE4z", 10);
    assert_text(&bench, "a??z", "");
    assert_nak(&bench, 0x6B, "\0\1\0\1\1\5four", 10, 2);
    assert_nak(&bench, 0x6B, "\0\1\0\1\1", 5, 2);
    assert_nak(&bench, 0x6B, "\1\1\0\1\1\1x", 7, 9);
    assert_nak(&bench, 0x6B, "\0\5\0\1\1\1x", 7, 9);
    assert_nak(&bench, 0x6B, "\0\1\0\0\1\1x", 7, 9);
    assert_nak(&bench, 0x6B, "\0\1\0\3\1\1x", 7, 9);
    assert_nak(&bench, 0x6B, "\0\1\0\1\21\1x", 7, 9);
    assert_text(&bench, "a??z", "");
    bench_done(&bench);
}

static void test_address_and_speed(void **state)
{
    (void)state;
    struct bench bench;
    struct panel_reply reply;
    bench_init(&bench, false, true);
    /* What is not possible stays as it is: a speed, an address, and what cannot be stored. */
    const uint8_t speed[5] = {9, 0x39, 0x30}, address[5] = {0x7F, 0x80, 0x25};
    const uint8_t right[5] = {9, 0x00, 0xC2, 0x01, 0x00}, now[5] = {5, 0x80, 0x25};
    assert_int_equal(bench_ask(&bench, 0x6E, speed, 5, &reply), 0x54);
    assert_memory_equal(reply.data, now, 5);
    assert_int_equal(bench_ask(&bench, 0x6E, address, 5, &reply), 0x54);
    assert_memory_equal(reply.data, now, 5);
    bench.store_error = -ENOSPC;
    assert_int_equal(bench_ask(&bench, 0x6E, right, 5, &reply), 0x54);
    assert_memory_equal(reply.data, now, 5);
    bench.store_error = 0;
    assert_nak(&bench, 0x6E, right, 4, 2);
    /* To the address of all devices; the reply comes from there, too. */
    bench.panel.address = 0x7F;
    assert_int_equal(bench_ask(&bench, 0x6E, right, 5, &reply), 0x54);
    assert_int_equal(reply.n, 5);
    assert_memory_equal(reply.data, right, 5);
    assert_int_equal(bench.stores, 1);
    assert_int_equal(bench.saved.address, 9);
    assert_int_equal(bench.saved.baud, 115200);
    assert_int_equal(iso_osdp_peripheral_sent(bench.device), 115200);
    assert_int_equal(bench_status(&bench).address, 9);
    /* The old address is silent; at the new one the panel begins anew. */
    bench.panel.address = 5;
    assert_int_equal(bench_ask(&bench, 0x60, NULL, 0, &reply), -1);
    bench.panel.address = 9;
    assert_nak(&bench, 0x60, NULL, 0, 4);
    bench.panel.sequence = -1;
    assert_ack(&bench, 0x60, NULL, 0);
    bench_done(&bench);
}

static void test_only_some_commands_without_a_channel(void **state)
{
    (void)state;
    struct bench bench;
    struct panel_reply reply;
    bench_init(&bench, true, false);
    assert_nak(&bench, 0x60, NULL, 0, 6);
    const uint8_t closed[] = {0x60, 0x64, 0x65, 0x66, 0x67, 0x68,
                              0x69, 0x6A, 0x6B, 0x6E, 0x75, 0xA0};
    for (size_t i = 0; i < sizeof closed; i++) {
        assert_nak(&bench, closed[i], "\x09\x80\x25\0", 5, 6);
    }
    assert_int_equal(bench_ask(&bench, 0x61, "", 1, &reply), 0x45);
    assert_int_equal(bench_ask(&bench, 0x62, "", 1, &reply), 0x46);
    /* In the install mode the address may be set, too. */
    iso_osdp_peripheral_install(bench.device, bench.now_ns);
    assert_int_equal(bench_ask(&bench, 0x6E, "\x09\x80\x25\0", 5, &reply), 0x54);
    assert_int_equal(reply.data[0], 9);
    bench_done(&bench);
}

static void test_setups_that_are_not_possible(void **state)
{
    (void)state;
    struct bench bench = {0};
    struct iso_osdp_peripheral *device = NULL;
    struct iso_osdp_setup setup = bench_setup(&bench, false, true);
    setup.saved.address = 0x7F;
    assert_int_equal(iso_osdp_peripheral_new(&setup, &device), -EINVAL);
    setup = bench_setup(&bench, false, true);
    setup.saved.baud = 4800;
    assert_int_equal(iso_osdp_peripheral_new(&setup, &device), -EINVAL);
    setup = bench_setup(&bench, false, true);
    setup.inputs = ISO_OSDP_INPUTS + 1;
    assert_int_equal(iso_osdp_peripheral_new(&setup, &device), -EINVAL);
    assert_null(device);
    iso_osdp_peripheral_free(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_identity_and_abilities),
        cmocka_unit_test(test_states),
        cmocka_unit_test(test_lamp),
        cmocka_unit_test(test_buzzer),
        cmocka_unit_test(test_text),
        cmocka_unit_test(test_address_and_speed),
        cmocka_unit_test(test_only_some_commands_without_a_channel),
        cmocka_unit_test(test_setups_that_are_not_possible),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
