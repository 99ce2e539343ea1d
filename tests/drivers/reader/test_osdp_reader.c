/* The side of OSDP that asks a reader, against bytes that are written out in full: the conversation
 * of drivers/reader/README.md, and frames that follow from it. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "drivers/reader/osdp_reader.h"

#define MS INT64_C(1000000)

/* Replies that have no row of their own. */
#define ACK_2 "53 85 08 00 06 40 6C E9"
#define ACK_3 "53 85 08 00 07 40 5D DA"
#define BUSY  "53 85 08 00 04 79 74 28"

struct rig {
    struct iso_osdp_reader *reader;
    int64_t now_ns;
    uint8_t sent[ISO_OSDP_FRAME_BYTES];
    size_t n_sent;
};

static void open_rig(struct rig *rig)
{
    const struct iso_osdp_reader_setup setup = {.address = 5, .baud = 9600};
    *rig = (struct rig){.now_ns = 5};
    assert_int_equal(iso_osdp_reader_new(&setup, rig->now_ns, &rig->reader), 0);
}

static size_t parse(const char *text, uint8_t *bytes)
{
    size_t n = 0;
    for (char *end; *text && *text != '`'; text = end + (*end == ' ')) {
        assert_true(n < 64);
        bytes[n++] = (uint8_t)strtoul(text, &end, 16);
        assert_int_equal(end - text, 2);
    }
    return n;
}

static bool send(struct rig *rig)
{
    rig->n_sent = iso_osdp_reader_send(rig->reader, rig->now_ns, rig->sent);
    return rig->n_sent > 0;
}

static void send_next(struct rig *rig)
{
    rig->now_ns = iso_osdp_reader_due_ns(rig->reader);
    assert_true(send(rig));
}

static void expect_sent(const struct rig *rig, const char *text)
{
    uint8_t bytes[64];
    const size_t n = parse(text, bytes);
    assert_int_equal(rig->n_sent, n);
    assert_memory_equal(rig->sent, bytes, n);
}

static void reply(struct rig *rig, const char *text)
{
    uint8_t bytes[64];
    const size_t n = parse(text, bytes);
    iso_osdp_reader_receive(rig->reader, bytes, n, rig->now_ns);
}

static struct iso_osdp_reader_status status_of(const struct rig *rig)
{
    struct iso_osdp_reader_status status;
    iso_osdp_reader_status(rig->reader, &status);
    return status;
}

static void expect_nothing(struct rig *rig)
{
    struct iso_reader_event event;
    assert_false(iso_osdp_reader_take(rig->reader, &event));
}

static void expect_card(struct rig *rig, int bits, uint64_t code)
{
    struct iso_reader_event event;
    assert_true(iso_osdp_reader_take(rig->reader, &event));
    assert_int_equal(event.kind, ISO_READER_CARD);
    assert_int_equal(event.bits, bits);
    assert_int_equal(event.code, code);
}

static void expect_kind(struct rig *rig, enum iso_reader_event_kind kind)
{
    struct iso_reader_event event;
    assert_true(iso_osdp_reader_take(rig->reader, &event));
    assert_int_equal(event.kind, kind);
}

static void expect_key(struct rig *rig, char key)
{
    struct iso_reader_event event;
    assert_true(iso_osdp_reader_take(rig->reader, &event));
    assert_int_equal(event.kind, ISO_READER_KEY);
    assert_int_equal(event.key, key);
}

/* What the replies of the rows mean. */
static void check_meaning(struct rig *rig, int row)
{
    switch (row) {
    case 2:
        assert_true(status_of(rig).online);
        assert_int_equal(status_of(rig).serial, 0x12345678);
        break;
    case 3:
        assert_int_equal(status_of(rig).stale, 1);
        break;
    case 5:
        expect_card(rig, 26, 0x22224CF);
        break;
    case 6:
        expect_key(rig, '7');
        expect_key(rig, '*');
        expect_key(rig, '#');
        break;
    case 7:
        expect_card(rig, 32, 0xDEADBEEF);
        break;
    case 8:
        assert_int_equal(status_of(rig).problem, ISO_OSDP_READER_TAMPERED);
        break;
    case 9:
        assert_int_equal(status_of(rig).problem, ISO_OSDP_READER_FINE);
        iso_osdp_reader_show(rig->reader, true);
        break;
    case 12:
        expect_kind(rig, ISO_READER_DAMAGED);
        break;
    default:
        break;
    }
    expect_nothing(rig);
}

static void test_conversation(void **state)
{
    (void)state;
    struct rig rig;
    char row[1024];
    int rows = 0;
    open_rig(&rig);
    FILE *file = fopen(ISOTHERM_SOURCE_DIR "/drivers/reader/README.md", "r");
    assert_non_null(file);
    while (fgets(row, sizeof row, file)) {
        const char *command = strchr(row, '`');
        if (row[0] != '|' || !command || strncmp(command, "`53 ", 4) != 0) {
            continue;
        }
        const char *answer = strchr(strchr(command + 1, '`') + 1, '`');
        print_message("%.60s\n", row);
        send_next(&rig);
        expect_sent(&rig, command + 1);
        reply(&rig, answer + 1);
        check_meaning(&rig, rows++);
    }
    assert_int_equal(fclose(file), 0);
    assert_int_equal(rows, 14);
    assert_int_equal(status_of(&rig).repeated, 0);
    iso_osdp_reader_free(rig.reader);
}

/* The start of the conversation, up to the POLL with the number 2. */
static void start(struct rig *rig)
{
    static const char *const replies[] = {
        "53 85 14 00 04 45 0A 0B 0C 01 01 78 56 34 12 00 01 00 BC 3E",
        "53 85 0B 00 05 46 03 01 01 6E 1B", "53 85 0A 00 06 48 00 00 E1 25", ACK_3,
        "53 85 08 00 05 40 3F BC"};
    open_rig(rig);
    for (size_t i = 0; i < sizeof replies / sizeof *replies; i++) {
        send_next(rig);
        reply(rig, replies[i]);
    }
    send_next(rig);
    expect_sent(rig, "53 05 08 00 06 60 DE EF");
}

static void test_times(void **state)
{
    (void)state;
    struct rig rig;
    start(&rig);
    reply(&rig, ACK_2);
    /* A POLL 50 ms later. */
    rig.now_ns += 50 * MS - 1;
    assert_false(send(&rig));
    rig.now_ns++;
    assert_true(send(&rig));
    expect_sent(&rig, "53 05 08 00 07 60 EF DC");
    /* No reply: the same bytes after 200 ms and the time of 8 and 96 bytes at 9600 baud. */
    rig.now_ns += 200 * MS + 108333333 - 1;
    assert_false(send(&rig));
    rig.now_ns++;
    assert_true(send(&rig));
    expect_sent(&rig, "53 05 08 00 07 60 EF DC");
    assert_int_equal(status_of(&rig).repeated, 1);
    iso_osdp_reader_free(rig.reader);
}

static void test_card_counts_once(void **state)
{
    (void)state;
    struct rig rig;
    static const char card[] = "53 85 10 00 06 50 00 01 1A 00 88 89 33 C0 1A E7";
    start(&rig);
    /* The reply to the first frame and that to its repetition both arrive. */
    send_next(&rig);
    reply(&rig, card);
    reply(&rig, card);
    expect_card(&rig, 26, 0x22224CF);
    expect_nothing(&rig);
    send_next(&rig);
    expect_sent(&rig, "53 05 08 00 07 60 EF DC");
    reply(&rig, card);
    expect_nothing(&rig);
    reply(&rig, ACK_3);
    reply(&rig, card);
    expect_nothing(&rig);
    send_next(&rig);
    reply(&rig, "53 85 08 00 05 40 3F BC");
    /* Its number is that of the next command, which has not been sent yet. */
    reply(&rig, card);
    expect_nothing(&rig);
    assert_int_equal(status_of(&rig).events, 1);
    iso_osdp_reader_free(rig.reader);
}

static void test_frames_that_are_ignored(void **state)
{
    (void)state;
    struct rig rig;
    start(&rig);
    /* Another device, a command of ours that comes back, a damaged card, noise before a good one.
     */
    reply(&rig, "53 86 08 00 06 40 BE 07");
    reply(&rig, "53 05 08 00 06 60 DE EF");
    reply(&rig, "53 85 10 00 06 50 00 01 1A 00 88 89 33 C1 1A E7");
    expect_nothing(&rig);
    send_next(&rig);
    expect_sent(&rig, "53 05 08 00 06 60 DE EF");
    reply(&rig, "FF 00 53 53 85 10 00 06 50 00 01 1A 00 88 89 33 C0 1A E7");
    expect_card(&rig, 26, 0x22224CF);
    iso_osdp_reader_free(rig.reader);
}

static void test_busy_delays(void **state)
{
    (void)state;
    struct rig rig;
    start(&rig);
    rig.now_ns += 150 * MS;
    reply(&rig, BUSY);
    rig.now_ns += 200 * MS - 1;
    assert_false(send(&rig));
    rig.now_ns++;
    assert_true(send(&rig));
    expect_sent(&rig, "53 05 08 00 06 60 DE EF");
    /* Nobody keeps a reader alive with BUSY alone. */
    for (int i = 0; i < 100; i++) {
        rig.now_ns += 100 * MS;
        reply(&rig, BUSY);
        (void)send(&rig);
    }
    assert_false(status_of(&rig).online);
    assert_int_equal(status_of(&rig).problem, ISO_OSDP_READER_SILENT);
    iso_osdp_reader_free(rig.reader);
}

static void test_silence(void **state)
{
    (void)state;
    struct rig rig;
    start(&rig);
    reply(&rig, ACK_2);
    const int64_t heard_ns = rig.now_ns;
    while (rig.now_ns < heard_ns + 8000 * MS) {
        assert_true(status_of(&rig).online);
        send_next(&rig);
    }
    assert_int_equal(rig.now_ns, heard_ns + 8000 * MS);
    assert_false(status_of(&rig).online);
    assert_int_equal(status_of(&rig).problem, ISO_OSDP_READER_SILENT);
    /* It begins with the number 0 again. */
    expect_sent(&rig, "53 05 09 00 04 61 00 C1 25");
    iso_osdp_reader_free(rig.reader);
}

static void test_refusals(void **state)
{
    (void)state;
    struct rig rig;
    /* The reader has lost the conversation (NAK 4): a new start after a second, without an alarm.
     */
    start(&rig);
    reply(&rig, "53 85 09 00 06 41 04 E3 D9");
    assert_false(status_of(&rig).online);
    assert_int_equal(status_of(&rig).problem, ISO_OSDP_READER_FINE);
    rig.now_ns += 1000 * MS - 1;
    assert_false(send(&rig));
    rig.now_ns++;
    assert_true(send(&rig));
    expect_sent(&rig, "53 05 09 00 04 61 00 C1 25");
    iso_osdp_reader_free(rig.reader);
    /* It takes POLL in the secure channel only (NAK 6). */
    start(&rig);
    reply(&rig, "53 85 09 00 06 41 06 A1 F9");
    assert_int_equal(status_of(&rig).problem, ISO_OSDP_READER_WANTS_KEY);
    iso_osdp_reader_free(rig.reader);
}

/* A card that says too many bits, one of 65 bits, one with a wrong parity, keys that are not all
 * there, a key F1 between two digits. */
static void test_strange_events(void **state)
{
    (void)state;
    struct rig rig;
    static const char *const strange[] = {
        "53 85 0F 00 06 50 00 00 20 00 DE AD BE CB 28",
        "53 85 15 00 07 50 00 00 41 00 01 02 03 04 05 06 07 08 80 88 34",
        "53 85 10 00 05 50 00 01 1A 00 88 89 33 80 11 1E", "53 85 0C 00 06 53 00 05 31 32 37 B7"};
    start(&rig);
    for (size_t i = 0; i < sizeof strange / sizeof *strange; i++) {
        reply(&rig, strange[i]);
        expect_kind(&rig, ISO_READER_DAMAGED);
        expect_nothing(&rig);
        send_next(&rig);
    }
    reply(&rig, "53 85 0D 00 07 53 00 03 31 41 32 FC DF");
    expect_key(&rig, '1');
    expect_key(&rig, '2');
    expect_nothing(&rig);
    iso_osdp_reader_free(rig.reader);
}

static void test_setups_that_are_refused(void **state)
{
    (void)state;
    struct iso_osdp_reader *reader = NULL;
    const struct iso_osdp_reader_setup setups[] = {{.address = 0x7F, .baud = 9600},
                                                   {.address = 1, .baud = 4800},
                                                   {.address = 1, .baud = 9600, .has_key = true}};
    for (size_t i = 0; i < sizeof setups / sizeof *setups; i++) {
        assert_int_equal(iso_osdp_reader_new(&setups[i], 0, &reader), -EINVAL);
        assert_null(reader);
    }
    iso_osdp_reader_free(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_conversation),
        cmocka_unit_test(test_times),
        cmocka_unit_test(test_card_counts_once),
        cmocka_unit_test(test_frames_that_are_ignored),
        cmocka_unit_test(test_busy_delays),
        cmocka_unit_test(test_silence),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_strange_events),
        cmocka_unit_test(test_setups_that_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
