/* The side of OSDP that asks a reader, with the project's own device of OSDP as the reader. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "drivers/door/osdp/osdp_codes.h"
#include "tests/drivers/reader/reader_duo.h"

static void move_events(bool secure, uint32_t loss)
{
    struct duo duo;
    struct iso_reader_event event;
    unsigned queued = 0, arrived = 0;
    duo_open(&duo, secure);
    duo_run_until_online(&duo);
    duo.loss = loss;
    while (arrived < 2000) {
        while (queued < 2000 && duo_add(&duo, queued) == 0) {
            queued++;
        }
        duo_exchange(&duo);
        while (iso_osdp_reader_take(duo.reader, &event)) {
            duo_expect(&event, arrived++);
        }
    }
    duo.loss = 0;
    duo_run_for(&duo, 2000 * MS);
    assert_false(iso_osdp_reader_take(duo.reader, &event));
    const struct iso_osdp_reader_status status = duo_status(&duo);
    assert_int_equal(status.secure, secure);
    assert_int_equal(status.events, 2000);
    assert_int_equal(status.starts, 0);
    assert_int_equal(status.dropped, 0);
    assert_int_equal(status.refused, 0);
    assert_true(loss == 0 ? status.repeated == 0 : status.repeated > 200);
    assert_true(loss == 0 ? status.damaged == 0 : status.damaged > 20);
    duo_close(&duo);
}

static void test_two_thousand_events(void **state)
{
    (void)state;
    move_events(false, 0);
    move_events(true, 0);
    move_events(false, 8);
    move_events(true, 8);
}

static void test_other_key(void **state)
{
    (void)state;
    struct duo duo;
    duo_open(&duo, true);
    struct iso_osdp_reader_setup setup = duo_reader_setup(&duo, true);
    setup.key[15] ^= 1;
    iso_osdp_reader_free(duo.reader);
    assert_int_equal(iso_osdp_reader_new(&setup, duo.now_ns, &duo.reader), 0);
    duo_run_for(&duo, 5000 * MS);
    assert_false(duo_status(&duo).online);
    assert_false(duo_status(&duo).secure);
    assert_int_equal(duo_status(&duo).problem, ISO_OSDP_READER_OTHER_KEY);
    /* The reader had to prove its key first, and did not get a proof of ours. */
    struct iso_osdp_status device;
    iso_osdp_peripheral_status(duo.device, duo.now_ns, &device);
    assert_int_equal(device.refused, 0);
    /* It tries again once a second. */
    assert_in_range(duo_status(&duo).starts, 4, 6);
    /* The right key comes into the reader later. */
    duo_open_reader(&duo, true);
    duo_run_until_online(&duo);
    assert_true(duo_status(&duo).secure);
    duo_close(&duo);
}

static void test_reader_without_a_key(void **state)
{
    (void)state;
    struct duo duo;
    duo_open(&duo, true);
    duo_plug_device(&duo, false, true);
    duo_run_for(&duo, 20000 * MS);
    assert_int_equal(duo_status(&duo).problem, ISO_OSDP_READER_REFUSES);
    assert_false(duo_status(&duo).online);
    duo_close(&duo);
}

static void test_key_that_is_not_configured(void **state)
{
    (void)state;
    struct duo duo;
    duo_open(&duo, false);
    duo_plug_device(&duo, true, false);
    duo_run_for(&duo, 5000 * MS);
    assert_int_equal(duo_status(&duo).problem, ISO_OSDP_READER_WANTS_KEY);
    assert_false(duo_status(&duo).online);
    duo_close(&duo);
}

/* Somebody on the wire answers a POLL of the secure channel in plain. */
static void test_plain_replies_are_refused(void **state)
{
    (void)state;
    struct duo duo;
    struct iso_reader_event event;
    uint8_t frame[ISO_OSDP_FRAME_BYTES], forged[ISO_OSDP_FRAME_BYTES];
    const uint8_t card[] = {0, 1, 0x20, 0, 0xDE, 0xAD, 0xBE, 0xEF};
    duo_open(&duo, true);
    duo_run_until_online(&duo);
    duo.now_ns = iso_osdp_reader_due_ns(duo.reader);
    assert_true(iso_osdp_reader_send(duo.reader, duo.now_ns, frame) > 0);
    struct iso_osdp_header header = {
        .address = 0x85, .sequence = frame[4] & 3, .has_crc = true, .code = ISO_OSDP_RAW};
    size_t n = iso_osdp_packet_begin(&header, card, sizeof card, forged);
    n = iso_osdp_packet_end(forged, n);
    iso_osdp_reader_receive(duo.reader, forged, n, duo.now_ns);
    assert_int_equal(duo_status(&duo).refused, 1);
    /* With a block that says that there is a MAC, too. */
    header.block = ISO_OSDP_SCS_16;
    header.block_data = -1;
    n = iso_osdp_packet_begin(&header, card, sizeof card, forged);
    memset(forged + n, 0xA5, ISO_OSDP_MAC_BYTES);
    n = iso_osdp_packet_end(forged, n + ISO_OSDP_MAC_BYTES);
    iso_osdp_reader_receive(duo.reader, forged, n, duo.now_ns);
    assert_int_equal(duo_status(&duo).refused, 2);
    assert_false(iso_osdp_reader_take(duo.reader, &event));
    assert_true(duo_status(&duo).secure);
    /* The channel goes on. */
    assert_int_equal(duo_add(&duo, 0), 0);
    duo_exchange(&duo);
    assert_true(iso_osdp_reader_take(duo.reader, &event));
    duo_expect(&event, 0);
    duo_close(&duo);
}

/* Somebody on the wire changes the last step of the handshake, and its CRC. */
static void test_changed_rmac(void **state)
{
    (void)state;
    struct duo duo;
    uint8_t frame[ISO_OSDP_FRAME_BYTES], answer[ISO_OSDP_FRAME_BYTES];
    struct iso_osdp_packet packet = {.code = 0};
    duo_open(&duo, true);
    while (packet.code != ISO_OSDP_RMAC_I) {
        duo.now_ns = iso_osdp_reader_due_ns(duo.reader);
        size_t n = iso_osdp_reader_send(duo.reader, duo.now_ns, frame);
        n = iso_osdp_peripheral_receive(duo.device, frame, n, duo.now_ns, answer);
        assert_int_equal(iso_osdp_packet_parse(answer, n, &packet), 0);
        if (packet.code == ISO_OSDP_RMAC_I) {
            answer[n - 3] ^= 1;
            n = iso_osdp_packet_end(answer, n - 2);
        }
        iso_osdp_reader_receive(duo.reader, answer, n, duo.now_ns);
    }
    assert_int_equal(duo_status(&duo).problem, ISO_OSDP_READER_OTHER_KEY);
    assert_false(duo_status(&duo).secure);
    duo_close(&duo);
}

/* A recorded reply of the channel is worth nothing later, nor in another channel. */
static void test_recorded_reply(void **state)
{
    (void)state;
    struct duo duo;
    struct iso_reader_event event;
    uint8_t recorded[ISO_OSDP_FRAME_BYTES], frame[ISO_OSDP_FRAME_BYTES];
    duo_open(&duo, true);
    duo_run_until_online(&duo);
    assert_int_equal(duo_add(&duo, 0), 0);
    duo_exchange(&duo);
    assert_true(iso_osdp_reader_take(duo.reader, &event));
    const size_t n_recorded = duo.n_reply;
    memcpy(recorded, duo.reply, n_recorded);
    for (int i = 0; i < 2; i++) {
        /* Until the same sequence number comes again. */
        do {
            duo_exchange(&duo);
            duo.now_ns = iso_osdp_reader_due_ns(duo.reader);
        } while ((recorded[4] & 3) != (duo.reply[4] & 3) % 3 + 1);
        assert_true(iso_osdp_reader_send(duo.reader, duo.now_ns, frame) > 0);
        assert_int_equal(frame[4] & 3, recorded[4] & 3);
        iso_osdp_reader_receive(duo.reader, recorded, n_recorded, duo.now_ns);
        assert_int_equal(duo_status(&duo).refused, 1);
        assert_false(iso_osdp_reader_take(duo.reader, &event));
        duo_open_reader(&duo, true);
        duo_run_until_online(&duo);
    }
    duo_close(&duo);
}

static void test_unplugged_and_back(void **state)
{
    (void)state;
    for (int secure = 0; secure < 2; secure++) {
        struct duo duo;
        struct iso_reader_event event;
        duo_open(&duo, secure);
        duo_run_until_online(&duo);
        duo.unplugged = true;
        duo_run_for(&duo, 9000 * MS);
        assert_false(duo_status(&duo).online);
        assert_int_equal(duo_status(&duo).problem, ISO_OSDP_READER_SILENT);
        duo.unplugged = false;
        duo_run_until_online(&duo);
        assert_int_equal(duo_status(&duo).problem, ISO_OSDP_READER_FINE);
        assert_int_equal(duo_add(&duo, 1), 0);
        duo_exchange(&duo);
        assert_true(iso_osdp_reader_take(duo.reader, &event));
        duo_expect(&event, 1);
        /* The reader alone loses its power for a moment. */
        duo_plug_device(&duo, secure, !secure);
        duo_run_for(&duo, 2000 * MS);
        duo_run_until_online(&duo);
        assert_int_equal(duo_status(&duo).secure, secure);
        assert_int_equal(duo_add(&duo, 2), 0);
        duo_exchange(&duo);
        assert_true(iso_osdp_reader_take(duo.reader, &event));
        duo_expect(&event, 2);
        duo_close(&duo);
    }
}

/* The reply with a card arrives, and then the wire is cut: the reader does not know that the card
 * has arrived. Whatever it does with the card, it counts once. */
static void test_cut_after_a_card(void **state)
{
    (void)state;
    struct duo duo;
    struct iso_reader_event event;
    duo_open(&duo, false);
    duo_run_until_online(&duo);
    assert_int_equal(duo_add(&duo, 0), 0);
    duo_exchange(&duo);
    assert_true(iso_osdp_reader_take(duo.reader, &event));
    duo.unplugged = true;
    duo_run_for(&duo, 9000 * MS);
    duo.unplugged = false;
    duo_run_until_online(&duo);
    duo_run_for(&duo, 1000 * MS);
    assert_false(iso_osdp_reader_take(duo.reader, &event));
    duo_close(&duo);
}

static void test_reader_shows_the_outcome(void **state)
{
    (void)state;
    for (int secure = 0; secure < 2; secure++) {
        struct duo duo;
        struct iso_osdp_status shown;
        duo_open(&duo, secure);
        duo_run_until_online(&duo);
        iso_osdp_reader_show(duo.reader, false);
        duo_exchange(&duo);
        duo_exchange(&duo);
        iso_osdp_peripheral_status(duo.device, duo.now_ns, &shown);
        assert_int_equal(shown.shown.lamp, ISO_OSDP_RED);
        assert_true(shown.shown.buzzer);
        iso_osdp_reader_show(duo.reader, true);
        duo_exchange(&duo);
        duo_exchange(&duo);
        iso_osdp_peripheral_status(duo.device, duo.now_ns, &shown);
        assert_int_equal(shown.shown.lamp, ISO_OSDP_GREEN);
        iso_osdp_peripheral_status(duo.device, duo.now_ns + 2500 * MS, &shown);
        assert_int_equal(shown.shown.lamp, ISO_OSDP_BLACK);
        assert_false(shown.shown.buzzer);
        duo_close(&duo);
    }
}

static int fail_random(void *context, void *bytes, size_t n)
{
    (void)context;
    (void)bytes;
    return n ? -5 : 0;
}

static void test_no_random_numbers(void **state)
{
    (void)state;
    struct duo duo;
    duo_open(&duo, true);
    struct iso_osdp_reader_setup setup = duo_reader_setup(&duo, true);
    setup.random = fail_random;
    iso_osdp_reader_free(duo.reader);
    assert_int_equal(iso_osdp_reader_new(&setup, duo.now_ns, &duo.reader), 0);
    duo_run_for(&duo, 10000 * MS);
    assert_false(duo_status(&duo).online);
    assert_int_equal(duo_status(&duo).problem, ISO_OSDP_READER_SILENT);
    duo_close(&duo);
}

/* More events than have room are dropped, the oldest stay. */
static void test_full_queue(void **state)
{
    (void)state;
    struct duo duo;
    struct iso_reader_event event;
    unsigned n = 0;
    duo_open(&duo, false);
    duo_run_until_online(&duo);
    for (unsigned i = 0; i < 100; i++) {
        assert_int_equal(duo_add(&duo, i), 0);
        duo_exchange(&duo);
    }
    while (iso_osdp_reader_take(duo.reader, &event)) {
        duo_expect(&event, n++);
    }
    assert_int_equal(n, ISO_OSDP_READER_EVENTS);
    assert_int_equal(duo_status(&duo).dropped, 100 - ISO_OSDP_READER_EVENTS);
    duo_close(&duo);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_two_thousand_events),
        cmocka_unit_test(test_other_key),
        cmocka_unit_test(test_reader_without_a_key),
        cmocka_unit_test(test_key_that_is_not_configured),
        cmocka_unit_test(test_plain_replies_are_refused),
        cmocka_unit_test(test_changed_rmac),
        cmocka_unit_test(test_recorded_reply),
        cmocka_unit_test(test_unplugged_and_back),
        cmocka_unit_test(test_cut_after_a_card),
        cmocka_unit_test(test_reader_shows_the_outcome),
        cmocka_unit_test(test_no_random_numbers),
        cmocka_unit_test(test_full_queue),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
