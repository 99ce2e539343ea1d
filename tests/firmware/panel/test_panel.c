/* The access panel of an appliance: what it sets survives a restart, what happens is told, and
 * cards reach it. The other end of the line is the panel of the tests. */
#include <errno.h>
#include <poll.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include "drivers/base/times.h"
#include "firmware/panel/panel.h"
#include "firmware/panel/panel_file.h"
#include "tests/drivers/door/osdp/osdp_line.h"
#include "tests/support/scratch.h"

static const uint8_t key[16] = {3, 1, 4, 1, 5, 9, 2, 6, 5, 3, 5, 8, 9, 7, 9, 3};
static const uint8_t default_key[16] = "0123456789:;<=>?";

struct rig {
    struct osdp_line line;
    char file[256];
    struct iso_key_ring *ring;
    struct iso_panel *panel;
    struct iso_panel_options options;
};

static void open_panel(struct rig *rig)
{
    struct iso_fault fault = {.text = ""};
    if (iso_panel_open(&rig->options, &rig->panel, &fault)) {
        fail_msg("%s", fault.text);
    }
}

static void reopen_panel(struct rig *rig)
{
    iso_panel_close(rig->panel);
    osdp_line_close(&rig->line);
    osdp_line_open(&rig->line, 0);
    rig->options.port = rig->line.path;
    open_panel(rig);
}

static void open_rig(struct rig *rig, const char *directory, bool plain)
{
    struct iso_fault fault = {.text = ""};
    char ring[256], appliance_key[256];
    memset(rig, 0, sizeof *rig);
    osdp_line_open(&rig->line, 0);
    (void)snprintf(rig->file, sizeof rig->file, "%s", scratch_path(directory, "people.panel"));
    (void)snprintf(ring, sizeof ring, "%s", scratch_path(directory, "people.keys"));
    (void)snprintf(appliance_key, sizeof appliance_key, "%s",
                   scratch_path(directory, "people.key"));
    const struct iso_key_place place = {.ring = ring, .file = appliance_key};
    assert_int_equal(iso_seal_start(&fault), 0);
    assert_int_equal(iso_key_ring_open(&place, &rig->ring, &fault), 0);
    rig->options = (struct iso_panel_options){
        .port = rig->line.path,
        .address = 5,
        .baud = 38400,
        .plain = plain,
        .card_bits = 26,
        .path = rig->file,
        .ring = rig->ring,
        .clock = iso_times_system().monotonic,
    };
    open_panel(rig);
}

static void close_rig(struct rig *rig)
{
    iso_panel_close(rig->panel);
    iso_key_ring_close(rig->ring);
    osdp_line_close(&rig->line);
}

/* Waits for the next event of the panel, and expects this one. */
static void expect(struct rig *rig, const char *event, bool alarm)
{
    struct iso_panel_news news;
    struct pollfd wait = {.fd = iso_panel_fd(rig->panel), .events = POLLIN};
    while (!iso_panel_next(rig->panel, 0, &news)) {
        assert_int_equal(poll(&wait, 1, 10000), 1);
    }
    assert_string_equal(news.event, event);
    assert_int_equal(news.alarm, alarm);
}

static void set_key(struct rig *rig)
{
    struct panel_reply reply;
    uint8_t keyset[18] = {1, 16};
    memcpy(keyset + 2, key, 16);
    iso_panel_install(rig->panel);
    assert_true(osdp_line_secure(&rig->line, default_key));
    assert_int_equal(osdp_line_ask(&rig->line, 0x75, keyset, 18, &reply), 0x40);
}

static void test_key_survives_a_restart(void **state)
{
    struct rig rig;
    struct panel_reply reply;
    struct iso_panel_look look;
    struct stat status;
    open_rig(&rig, *state, false);
    assert_false(osdp_line_secure(&rig.line, key));
    iso_panel_look(rig.panel, &look);
    assert_string_equal(look.state, "waiting");
    assert_string_equal(look.fault.text, "");
    assert_false(look.has_key);
    set_key(&rig);
    assert_int_equal(stat(rig.file, &status), 0);
    assert_int_equal(status.st_mode & 0777, 0600);
    /* The key is not readable in the file. */
    size_t size;
    void *bytes = scratch_read(rig.file, &size);
    assert_null(memmem(bytes, size, key, 8));
    free(bytes);
    reopen_panel(&rig);
    assert_true(osdp_line_secure(&rig.line, key));
    assert_int_equal(osdp_line_ask(&rig.line, 0x60, NULL, 0, &reply), 0x40);
    iso_panel_look(rig.panel, &look);
    assert_string_equal(look.state, "secure");
    assert_true(look.has_key);
    assert_string_equal(iso_panel_fault(rig.panel)->text, "");
    close_rig(&rig);
}

static void test_key_that_cannot_be_stored_is_refused(void **state)
{
    struct rig rig;
    struct panel_reply reply;
    uint8_t keyset[18] = {1, 16, 42};
    open_rig(&rig, *state, false);
    iso_panel_install(rig.panel);
    assert_true(osdp_line_secure(&rig.line, default_key));
    assert_int_equal(mkdir(rig.file, 0700), 0); /* a directory is in the place of the file */
    assert_int_equal(osdp_line_ask(&rig.line, 0x75, keyset, 18, &reply), 0x41);
    assert_int_equal(reply.data[0], 9);
    assert_int_equal(rmdir(rig.file), 0);
    close_rig(&rig);
}

static void test_address_survives_until_the_configuration_changes(void **state)
{
    struct rig rig;
    struct panel_reply reply;
    const uint8_t comset[5] = {9, 0x00, 0x96, 0x00, 0x00}; /* 38400 baud, as configured */
    open_rig(&rig, *state, true);
    assert_int_equal(osdp_line_ask(&rig.line, 0x6E, comset, 5, &reply), 0x54);
    assert_memory_equal(reply.data, comset, 5);
    expect(&rig, "online", false);
    expect(&rig, "moved", true);
    reopen_panel(&rig);
    rig.line.panel.address = 9;
    assert_int_equal(osdp_line_ask(&rig.line, 0x60, NULL, 0, &reply), 0x40);
    rig.options.address = 6;
    reopen_panel(&rig);
    rig.line.panel.address = 6;
    assert_int_equal(osdp_line_ask(&rig.line, 0x60, NULL, 0, &reply), 0x40);
    close_rig(&rig);
}

static void test_damaged_file_is_told(void **state)
{
    struct rig rig;
    struct iso_panel_look look;
    open_rig(&rig, *state, false);
    set_key(&rig);
    FILE *file = fopen(rig.file, "r+");
    assert_non_null(file);
    assert_int_equal(fseek(file, -1, SEEK_END), 0);
    const int last = fgetc(file);
    assert_int_equal(fseek(file, -1, SEEK_END), 0);
    assert_int_equal(fputc(last ^ 1, file), last ^ 1);
    assert_int_equal(fclose(file), 0);
    reopen_panel(&rig);
    const struct iso_fault *fault = iso_panel_fault(rig.panel);
    assert_int_equal(fault->code, ISO_FAULT_PANEL_KEY);
    assert_non_null(strstr(fault->text, "people.panel: damaged"));
    iso_panel_look(rig.panel, &look);
    assert_false(look.has_key);
    assert_string_equal(look.fault.text, "the panel is silent");
    assert_int_equal(look.fault.code, ISO_FAULT_PANEL_SILENT);
    assert_false(osdp_line_secure(&rig.line, key));
    iso_panel_look(rig.panel, &look);
    assert_int_equal(look.fault.code, ISO_FAULT_PANEL_KEY);
    /* A new key is stored, and all is well again. */
    set_key(&rig);
    reopen_panel(&rig);
    assert_string_equal(iso_panel_fault(rig.panel)->text, "");
    assert_true(osdp_line_secure(&rig.line, key));
    close_rig(&rig);
}

static void test_cards(void **state)
{
    struct rig rig;
    struct panel_reply reply;
    struct iso_fault fault;
    struct iso_wiegand_card card = {.facility = 17, .number = 4711};
    open_rig(&rig, *state, false);
    assert_int_equal(iso_panel_send_card(rig.panel, &card, &fault), -ENOTCONN);
    assert_string_equal(fault.text, "panel: the card was not sent: the panel is not connected");
    set_key(&rig);
    assert_true(osdp_line_secure(&rig.line, key));
    assert_int_equal(iso_panel_send_card(rig.panel, &card, &fault), 0);
    assert_int_equal(osdp_line_ask(&rig.line, 0x60, NULL, 0, &reply), 0x50);
    /* 17 is 00010001, 4711 is 0001001001100111; the first bit makes the number of ones in the first
     * 13 bits even, the last one makes that of the last 13 odd. */
    assert_int_equal(reply.n, 8);
    assert_memory_equal(reply.data, "\0\1\x1A\0\x88\x89\x33\xC0", 8);
    card.facility = 256;
    assert_int_equal(iso_panel_send_card(rig.panel, &card, &fault), -ERANGE);
    assert_string_equal(fault.text, "panel: the card 256 4711 does not fit 26 bits");
    card.facility = 1;
    for (int i = 0; i < ISO_OSDP_EVENTS - 1; i++) {
        assert_int_equal(iso_panel_send_card(rig.panel, &card, &fault), 0);
    }
    assert_int_equal(iso_panel_send_card(rig.panel, &card, &fault), -ENOBUFS);
    close_rig(&rig);
}

static void test_news(void **state)
{
    struct rig rig;
    struct panel_reply reply;
    struct iso_panel_look look;
    open_rig(&rig, *state, false);
    set_key(&rig);
    expect(&rig, "online", false);
    expect(&rig, "key-set", true);
    expect(&rig, "default-key", true);
    assert_true(osdp_line_secure(&rig.line, key));
    expect(&rig, "closed", false);
    expect(&rig, "secure", false);
    assert_int_equal(
        osdp_line_ask(&rig.line, 0x6B, "\0\2\0\1\1\24Please present a car", 26, &reply), 0x40);
    const uint8_t green[14] = {0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 2, 0};
    assert_int_equal(osdp_line_ask(&rig.line, 0x69, green, 14, &reply), 0x40);
    iso_panel_look(rig.panel, &look);
    assert_string_equal(look.lamp, "green");
    assert_string_equal(look.shown.text[0], "Please present a");
    assert_string_equal(look.shown.text[1], " car");
    const struct iso_wiegand_card card = {1, 2};
    assert_int_equal(iso_panel_send_card(rig.panel, &card, NULL), 0);
    assert_int_equal(osdp_line_ask(&rig.line, 0x60, NULL, 0, &reply), 0x50);
    assert_true(osdp_line_secure(&rig.line, key)); /* a new start: nobody knows whether it has it */
    expect(&rig, "undelivered", true);
    (void)close(rig.line.master);
    expect(&rig, "line-gone", true);
    iso_panel_look(rig.panel, &look);
    assert_string_equal(look.state, "gone");
    assert_int_equal(look.fault.code, ISO_FAULT_PANEL_LINE);
    assert_non_null(strstr(look.fault.text, rig.line.path));
    iso_panel_close(rig.panel);
    iso_key_ring_close(rig.ring);
}

static void test_news_are_limited(void **state)
{
    struct rig rig;
    struct iso_panel_news news;
    const int64_t minute_ns = 60 * ISO_NS_PER_S;
    int n = 0;
    open_rig(&rig, *state, false);
    set_key(&rig);
    assert_int_equal(iso_panel_due_ns(rig.panel), ISO_NEVER_NS);
    for (int i = 0; i < 2 * ISO_PANEL_NEWS_MOST; i++) {
        rig.line.panel.secure = false;
        rig.line.panel.sequence = -1;
        struct panel_reply reply;
        assert_int_equal(osdp_line_ask(&rig.line, i % 2 ? 0x61 : 0x62, "", 1, &reply),
                         i % 2 ? 0x45 : 0x46);
        n += iso_panel_next(rig.panel, minute_ns + 1, &news);
        assert_true(osdp_line_secure(&rig.line, key));
        n += iso_panel_next(rig.panel, minute_ns + 2, &news);
    }
    assert_int_equal(n, ISO_PANEL_NEWS_MOST);
    assert_int_equal(iso_panel_due_ns(rig.panel), 2 * minute_ns + 1);
    rig.line.panel.sequence = -1;
    rig.line.panel.secure = false;
    struct panel_reply reply;
    assert_int_equal(osdp_line_ask(&rig.line, 0x61, "", 1, &reply), 0x45);
    /* The last state is told when the minute is over, unless it is the one that was told. */
    n = 0;
    while (iso_panel_next(rig.panel, 2 * minute_ns + 1, &news)) {
        n++;
    }
    assert_true(n <= 2);
    assert_int_equal(iso_panel_due_ns(rig.panel), ISO_NEVER_NS);
    close_rig(&rig);
}

static void test_line_may_come_later(void **state)
{
    struct rig rig;
    struct panel_reply reply;
    struct iso_panel_look look;
    char later[256];
    open_rig(&rig, *state, true);
    iso_panel_close(rig.panel);
    (void)snprintf(later, sizeof later, "%s", scratch_path(*state, "later"));
    rig.options.port = later;
    open_panel(&rig);
    assert_int_equal(iso_panel_fault(rig.panel)->code, ISO_FAULT_PANEL_LINE);
    assert_non_null(strstr(iso_panel_fault(rig.panel)->text, "No such file or directory"));
    iso_panel_look(rig.panel, &look);
    assert_string_equal(look.state, "gone");
    assert_int_equal(symlink(rig.line.path, later), 0);
    expect(&rig, "line-back", false);
    assert_int_equal(osdp_line_ask(&rig.line, 0x60, NULL, 0, &reply), 0x40);
    close_rig(&rig);
}

static void test_port_that_is_none_is_refused(void **state)
{
    struct rig rig;
    struct iso_panel *panel = NULL;
    struct iso_fault fault;
    open_rig(&rig, *state, true);
    struct iso_panel_options options = rig.options;
    options.port = "/dev/null";
    assert_int_equal(iso_panel_open(&options, &panel, &fault), -EINVAL);
    assert_null(panel);
    assert_string_equal(fault.text, "osdp: /dev/null is not a serial line");
    assert_int_equal(fault.code, ISO_FAULT_PANEL_LINE);
    close_rig(&rig);
}

static void test_stored_values_that_are_not_possible(void **state)
{
    (void)state;
    const struct iso_panel_file file = {
        .saved = {.address = 7, .baud = 57600, .has_key = true, .key = {1, 2, 3}},
        .configured_address = 1,
        .configured_baud = 9600,
    };
    uint8_t plain[ISO_PANEL_PLAIN_BYTES + 1];
    struct iso_panel_file out;
    iso_panel_file_put(&file, plain);
    assert_int_equal(iso_panel_file_get(plain, ISO_PANEL_PLAIN_BYTES, &out), 0);
    assert_int_equal(out.saved.address, 7);
    assert_int_equal(out.saved.baud, 57600);
    assert_int_equal(out.configured_address, 1);
    assert_int_equal(out.configured_baud, 9600);
    assert_true(out.saved.has_key);
    assert_memory_equal(out.saved.key, file.saved.key, 16);
    assert_int_equal(iso_panel_file_get(plain, ISO_PANEL_PLAIN_BYTES - 1, &out), -EBADMSG);
    static const struct {
        size_t at;
        uint8_t value;
    } wrong[] = {{0, 0x7F}, {1, 1}, {5, 0xFF}, {6, 1}, {10, 2}};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        iso_panel_file_put(&file, plain);
        plain[wrong[i].at] = wrong[i].value;
        assert_int_equal(iso_panel_file_get(plain, ISO_PANEL_PLAIN_BYTES, &out), -EBADMSG);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_key_survives_a_restart, scratch_setup,
                                        scratch_teardown),
        cmocka_unit_test_setup_teardown(test_key_that_cannot_be_stored_is_refused, scratch_setup,
                                        scratch_teardown),
        cmocka_unit_test_setup_teardown(test_address_survives_until_the_configuration_changes,
                                        scratch_setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(test_damaged_file_is_told, scratch_setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(test_cards, scratch_setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(test_news, scratch_setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(test_news_are_limited, scratch_setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(test_line_may_come_later, scratch_setup, scratch_teardown),
        cmocka_unit_test_setup_teardown(test_port_that_is_none_is_refused, scratch_setup,
                                        scratch_teardown),
        cmocka_unit_test(test_stored_values_that_are_not_possible),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
