/* Who was let in last, by the log and by visits, and the history of the last day. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "enroll/web/daemon/history.h"
#include "enroll/web/daemon/seen_table.h"
#include "firmware/contract/contract.h"
#include "tests/enroll/web/rigs/handler_rig.h"

static void send_visit(struct rig *rig, const char *verdict, const char *person, const char *door)
{
    rig_service_signal(&rig->service, false, ISO_CONTRACT_VISIT, "ssdduxsss", verdict, person, 2.5,
                       1.5, UINT32_C(3), INT64_C(250000), "match", door, "");
}

/* ---- who was let in last ---- */

enum { PEOPLE = 10000, LOG = 12010 };

/* The log lets in each of 10,000 people, then a few more, and then changes some of them. */
static void write_record(int i, char *line, size_t size)
{
    static const char *const last[] = {
        "\"event\":\"visit\",\"person\":\"person "
        "00001\",\"verdict\":\"allow\",\"door\":\"not-unlocked\"",
        "\"event\":\"visit\",\"person\":\"person 00002\",\"verdict\":\"deny\"",
        "\"event\":\"rename\",\"person\":\"person 00003\",\"before\":\"person "
        "00003\",\"after\":\"Zo\\\"e\"",
        "\"event\":\"delete\",\"person\":\"person 00004\"",
        "\"event\":\"rename\",\"person\":\"person 00005\",\"before\":\"person "
        "00005\",\"after\":\"nobody\"",
        "\"event\":\"rename\",\"person\":\"person 00005\",\"before\":\"person "
        "00005\",\"after\":\"nobody\",\"reason\":\"failed\"",
        "\"event\":\"delete\",\"person\":\"person 00006\",\"reason\":\"not-deleted\"",
        "\"event\":\"grant\",\"person\":\"person 00007\",\"verdict\":\"allow\"",
        "\"event\":\"visit\",\"person\":\"person 00008\",\"verdict\":\"allow\",\"door\":\"open\"",
        "\"event\":\"door\"",
    };
    char rest[256];
    if (i > LOG - 10) {
        (void)snprintf(rest, sizeof rest, "%s", last[i - (LOG - 10) - 1]);
    } else {
        (void)snprintf(rest, sizeof rest,
                       "\"event\":\"visit\",\"person\":\"person "
                       "%05d\",\"verdict\":\"allow\",\"door\":\"unlocked\"",
                       i % PEOPLE);
    }
    (void)snprintf(line, size, "{\"sequence\":%d,\"time\":\"2026-11-21T%02d:%02d:%02d.042Z\",%s}",
                   i, i / 3600, i / 60 % 60, i % 60, rest);
}

static const int64_t day_s = 1795219200; /* 2026-11-21 */

static bool is_read(void *context)
{
    return web_last_seen_is_read(((struct rig *)context)->api.last_seen);
}

static int64_t seen(const struct rig *rig, const char *name)
{
    return web_last_seen_of(rig->api.last_seen, name);
}

static void the_log_says_who_was_let_in_last(void **state)
{
    struct rig *rig = *state;
    if (!rig) {
        skip();
    }
    rig->service.record = write_record;
    rig->service.last_record = LOG;
    rig_run(rig->event, 1500);
    assert_false(is_read(rig)); /* it takes its time */
    rig_wait(rig->event, is_read, rig, "the end of the log");
    assert_int_equal(rig->service.n_log_calls, 13);
    assert_int_equal(seen(rig, "person 09999"), day_s + 9999);
    assert_int_equal(seen(rig, "person 00000"), day_s + 10000);
    assert_int_equal(seen(rig, "person 00001"), day_s + 10001);
    assert_int_equal(seen(rig, "person 00002"), day_s + 10002);
    assert_int_equal(seen(rig, "person 00003"), 0);
    assert_int_equal(seen(rig, "Zo\"e"), day_s + 10003);
    assert_int_equal(seen(rig, "person 00004"), 0);
    assert_int_equal(seen(rig, "person 00005"), day_s + 10005);
    assert_int_equal(seen(rig, "nobody"), 0);
    assert_int_equal(seen(rig, "person 00006"), day_s + 10006);
    assert_int_equal(seen(rig, "person 00007"), day_s + 10007);
    assert_int_equal(seen(rig, "person 00008"), day_s + LOG - 1);

    const int64_t before_s = (int64_t)time(NULL);
    send_visit(rig, "allow", "new", "unlocked");
    send_visit(rig, "allow", "stuck", "not-unlocked");
    send_visit(rig, "deny", "", "");
    rig_run(rig->event, 100);
    assert_true(seen(rig, "new") >= before_s);
    assert_int_equal(seen(rig, "stuck"), 0);
}

/* An answer that is refused, and a daemon that is gone, delay the reading, which goes on where it
 * was. */
static void the_log_is_read_on_where_reading_stopped(void **state)
{
    struct rig *rig = *state;
    if (!rig) {
        skip();
    }
    rig->service.record = write_record;
    rig->service.last_record = LOG;
    rig->service.fail_method = ISO_CONTRACT_READ_LOG;
    rig->service.fail_error = ISO_CONTRACT_ERROR_TOO_MANY_CALLS;
    rig->service.fail_times = 1;
    while (rig->service.n_log_calls < 3) {
        rig_run(rig->event, 20);
    }
    rig_service_stop(&rig->service);
    rig_wait_daemon(rig, false);
    rig_service_start(&rig->service, rig->event, rig->bus.address);
    rig_wait(rig->event, is_read, rig, "the end of the log");
    assert_in_range(rig->service.n_log_calls, 13, 14);
    assert_int_equal(seen(rig, "person 09999"), day_s + 9999);
    rig->service.last_record = 5; /* a shorter log is another one */
    rig_run(rig->event, 2500);
    assert_int_equal(seen(rig, "person 09999"), 0);
    assert_int_equal(seen(rig, "person 00005"), day_s + 5);
}

static void the_table_keeps_apart_who_had_a_name_when(void **state)
{
    struct web_seen_table table;
    char name[32];
    (void)state;
    web_seen_table_init(&table);
    web_seen_table_note(&table, "ada", 100);
    web_seen_table_note(&table, "ada", 50); /* an earlier time changes nothing */
    assert_int_equal(web_seen_table_find(&table, "ada"), 100);
    web_seen_table_remove(&table, "ada", 99); /* another ada, before */
    assert_int_equal(web_seen_table_find(&table, "ada"), 100);
    web_seen_table_rename(&table, "ada", "eve", 99);
    assert_int_equal(web_seen_table_find(&table, "ada"), 100);
    web_seen_table_rename(&table, "ada", "eve", 101);
    assert_int_equal(web_seen_table_find(&table, "ada"), 0);
    assert_int_equal(web_seen_table_find(&table, "eve"), 100);
    for (int i = 0; i < WEB_SEEN_MOST + 100; i++) {
        (void)snprintf(name, sizeof name, "%d", i);
        web_seen_table_note(&table, name, i + 1);
    }
    assert_int_equal(table.n, WEB_SEEN_MOST);
    assert_int_equal(web_seen_table_find(&table, "60000"), 60001);
    assert_int_equal(web_seen_table_find(&table, "65600"), 0);
    web_seen_table_done(&table);
}

/* ---- the history ---- */

static void take(struct web_history *history, int64_t second, int frames, int allowed,
                 const char *sensor)
{
    json_t *status = json_pack("{s:i, s:i, s:i, s:s}", "frames", frames, "visits-allowed", allowed,
                               "visits-denied", 2 * allowed, "sensor-state", sensor);
    web_history_take(history, status, (second + 1) * 1000000000, 5000 + second);
    json_decref(status);
}

static void the_history_has_a_sample_of_each_minute_of_a_day(void **state)
{
    static struct web_history history;
    char *text = NULL;
    size_t size = 0;
    (void)state;
    for (int i = 0; i < 60; i++) {
        take(&history, i, 1000 + 15 * i, 7, "started");
    }
    take(&history, 60, 1000 + 15 * 60, 9, "started");
    take(&history, 61, 30, 1, "lost"); /* the daemon began anew */
    web_history_take(&history, NULL, INT64_C(121) * 1000000000, 5120);
    assert_int_equal(history.n, 2);
    FILE *out = open_memstream(&text, &size);
    assert_non_null(out);
    web_history_write(&history, out);
    assert_int_equal(fclose(out), 0);
    assert_string_equal(text, "[{\"time_s\":5060,\"frames_per_s\":15.00,\"allowed\":2,\"denied\":4,"
                              "\"attack_frames\":0,\"sensor_works\":true},"
                              "{\"time_s\":5120,\"frames_per_s\":0.50,\"allowed\":1,\"denied\":2,"
                              "\"attack_frames\":0,\"sensor_works\":false}]");
    free(text);
    for (int i = 3; i < 2000; i++) {
        web_history_take(&history, NULL, ((int64_t)i * 60 + 1) * 1000000000, 5000 + i * 60);
    }
    assert_int_equal(history.n, WEB_HISTORY_SAMPLES);
    assert_int_equal(history.samples[history.next].time_s,
                     5000 + (1999 - WEB_HISTORY_SAMPLES + 1) * 60);
}

#define RIG_TEST(name) cmocka_unit_test_setup_teardown(name, rig_setup, rig_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        RIG_TEST(the_log_says_who_was_let_in_last),
        RIG_TEST(the_log_is_read_on_where_reading_stopped),
        cmocka_unit_test(the_table_keeps_apart_who_had_a_name_when),
        cmocka_unit_test(the_history_has_a_sample_of_each_minute_of_a_day),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
