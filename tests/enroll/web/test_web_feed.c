/* What the pages see of the daemon: events, the outline, who was let in last, the history. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include "enroll/web/daemon/history.h"
#include "enroll/web/daemon/seen_table.h"
#include "firmware/contract/contract.h"
#include "firmware/contract/stream_record.h"
#include "tests/enroll/web/rig_api.h"

#define VISIT_TYPES "ssdduxsss"

/* ---- the connection ---- */

struct reply {
    bool answered;
    char error[128];
};

static void on_reply(void *context, sd_bus_message *message, const sd_bus_error *error)
{
    struct reply *reply = context;
    (void)message;
    assert_false(reply->answered);
    reply->answered = true;
    (void)snprintf(reply->error, sizeof reply->error, "%s", error ? error->name : "");
}

static void ask(struct rig *rig, struct reply *reply)
{
    *reply = (struct reply){.answered = false};
    web_daemon_send(rig->api.daemon, web_daemon_message(rig->api.daemon, ISO_CONTRACT_CLAIM), 0,
                    on_reply, reply);
    assert_false(reply->answered);
}

static void each_call_is_answered_when_the_daemon_goes_and_comes_back(void **state)
{
    struct rig *rig = *state;
    struct reply replies[3];
    if (!rig) {
        skip();
    }
    rig->service.silent_method = ISO_CONTRACT_CLAIM;
    ask(rig, &replies[0]);
    ask(rig, &replies[1]);
    rig_run(rig->event, 50);
    assert_false(replies[0].answered);
    rig_service_stop(&rig->service);
    rig_until(rig->event, &replies[0].answered);
    rig_until(rig->event, &replies[1].answered);
    assert_string_equal(replies[0].error, "org.freedesktop.DBus.Error.NoReply");
    rig_wait_daemon(rig, false);
    ask(rig, &replies[2]);
    rig_until(rig->event, &replies[2].answered);
    assert_string_equal(replies[2].error, "org.freedesktop.DBus.Error.ServiceUnknown");

    rig->service.silent_method = NULL;
    rig_service_start(&rig->service, rig->event, rig->bus.address);
    rig_wait_daemon(rig, true);
    ask(rig, &replies[0]);
    rig_until(rig->event, &replies[0].answered);
    assert_string_equal(replies[0].error, "");
}

static void each_call_is_answered_when_the_bus_goes_and_comes_back(void **state)
{
    struct rig *rig = *state;
    struct reply replies[2];
    if (!rig) {
        skip();
    }
    rig->service.silent_method = ISO_CONTRACT_CLAIM;
    ask(rig, &replies[0]);
    rig_run(rig->event, 50);
    private_bus_kill(&rig->bus);
    rig_until(rig->event, &replies[0].answered);
    assert_string_not_equal(replies[0].error, "");
    rig_wait_daemon(rig, false);
    rig_run(rig->event, 1100);
    ask(rig, &replies[1]);
    rig_until(rig->event, &replies[1].answered);
    assert_string_equal(replies[1].error, "org.freedesktop.DBus.Error.Disconnected");

    rig_service_stop(&rig->service);
    rig->service.silent_method = NULL;
    assert_true(private_bus_revive(&rig->bus));
    rig_service_start(&rig->service, rig->event, rig->bus.address);
    rig_wait_daemon(rig, true);
    ask(rig, &replies[0]);
    rig_until(rig->event, &replies[0].answered);
    assert_string_equal(replies[0].error, "");
}

static void calls_that_wait_are_answered_at_the_end(void **state)
{
    struct rig *rig = *state;
    struct reply reply;
    if (!rig) {
        skip();
    }
    rig->service.silent_method = ISO_CONTRACT_CLAIM;
    ask(rig, &reply);
    web_daemon_close(rig->api.daemon);
    assert_true(reply.answered);
    assert_string_equal(reply.error, "org.freedesktop.DBus.Error.Disconnected");
}

/* ---- events ---- */

static void send_visit(struct rig *rig, const char *verdict, const char *person, const char *door)
{
    rig_service_signal(&rig->service, false, ISO_CONTRACT_VISIT, VISIT_TYPES, verdict, person, 2.5,
                       1.5, UINT32_C(3), INT64_C(250000), "match", door, "");
}

static void a_stream_of_events_begins_with_the_state_and_follows_it(void **state)
{
    struct rig *rig = *state;
    if (!rig) {
        skip();
    }
    struct web_exchange exchange = rig_exchange(WEB_ROLE_OBSERVER, 1, NULL);
    web_api_get_events(&rig->api, &exchange);
    struct web_stream *stream = exchange.stream;
    assert_non_null(stream);
    assert_int_equal(strncmp(stream->text, "event: status\ndata: {", 21), 0);
    assert_non_null(strstr(stream->text, "\"daemon\":true"));
    assert_string_equal(stream->text + stream->text_size - 2, "\n\n");

    rig->service.uptime_ms += 5000; /* changes all the time, so it is no change */
    rig_run(rig->event, 2500);
    assert_int_equal(stream->n_received, 1);
    rig->service.lockdown = true;
    rig_expect_text(rig->event, stream, "\"lockdown\":true");
    rig_service_stop(&rig->service);
    rig_expect_text(rig->event, stream, "\"daemon\":false,\"status\":{}");
    rig_service_start(&rig->service, rig->event, rig->bus.address);
    rig_wait_daemon(rig, true);
    const int n = stream->n_received;
    rig_run(rig->event, 10500); /* without a change, it is repeated after ten seconds */
    assert_in_range(stream->n_received, n + 1, n + 2);
    rig_close(&exchange);
    rig_exchange_done(&exchange);
}

static void signals_become_events_and_those_of_other_clients_do_not(void **state)
{
    struct rig *rig = *state;
    if (!rig) {
        skip();
    }
    struct web_exchange exchange = rig_exchange(WEB_ROLE_OBSERVER, 1, NULL);
    web_api_get_events(&rig->api, &exchange);
    rig_strange_signal(rig->bus.address, NULL, ISO_CONTRACT_HINT, "s", "forged");
    rig_strange_signal(rig->bus.address, ":1.1", ISO_CONTRACT_HINT, "s", "forged");
    rig_strange_signal(rig->bus.address, ":1.2", ISO_CONTRACT_HINT, "s", "forged");
    send_visit(rig, "allow", "Bo \"B\" Ek", "unlocked");
    rig_service_signal(&rig->service, false, ISO_CONTRACT_HINT, "s", "too-far");
    rig_service_signal(&rig->service, false, ISO_CONTRACT_DOOR_CHANGED, "ss", "opened", "contact");
    rig_expect_text(rig->event, exchange.stream,
                    "event: door\ndata: {\"state\":\"opened\",\"cause\":\"contact\"}\n\n");
    rig_expect_text(rig->event, exchange.stream, "event: hint\ndata: {\"word\":\"too-far\"}\n\n");
    rig_expect_text(rig->event, exchange.stream,
                    "\"verdict\":\"allow\",\"person\":\"Bo \\\"B\\\" Ek\",\"score\":2.5,");
    assert_null(strstr(exchange.stream->text, "forged"));
    rig_close(&exchange);
    rig_exchange_done(&exchange);
}

/* ---- the outline ---- */

static void send_outline(struct rig *rig, uint32_t sequence)
{
    const struct iso_outline_record record = {.head = {.sequence = sequence}, .mode = "watch"};
    uint8_t bytes[ISO_OUTLINE_BYTES];
    const size_t size = iso_outline_record_write(&record, bytes);
    assert_int_equal(send(rig->service.outline_fd, bytes, size, 0), size);
}

static bool has_outline(void *context)
{
    return ((struct rig *)context)->service.outline_fd >= 0;
}

static bool is_reopened(void *context)
{
    return ((struct rig *)context)->service.n_watches == 2;
}

static bool has_received(void *context)
{
    const struct web_stream *stream = context;
    return stream->last && stream->last->bytes[4 + 4] == 9; /* its sequence */
}

static void one_stream_of_the_daemon_serves_all_who_watch_the_outline(void **state)
{
    struct rig *rig = *state;
    if (!rig) {
        skip();
    }
    struct web_exchange fast = rig_exchange(WEB_ROLE_OBSERVER, 1, NULL);
    struct web_exchange slow = rig_exchange(WEB_ROLE_OBSERVER, 2, NULL);
    rig_run(rig->event, 1200);
    assert_int_equal(rig->service.n_watches, 0); /* nobody watches */
    web_api_get_outline(&rig->api, &fast);
    web_api_get_outline(&rig->api, &slow);
    slow.stream->slow = true;
    rig_wait(rig->event, has_outline, rig, "Watch");
    assert_int_equal(send(rig->service.outline_fd, "damaged", 7, 0), 7);
    for (uint32_t i = 1; i <= 9; i++) {
        send_outline(rig, i);
        rig_run(rig->event, 10);
    }
    rig_wait(rig->event, has_received, fast.stream, "the last record");
    assert_int_equal(fast.stream->n_received, 9); /* the damaged one is dropped */
    assert_int_equal(fast.stream->last->size, 4 + ISO_OUTLINE_BYTES);
    assert_int_equal(fast.stream->last->bytes[0] | fast.stream->last->bytes[1] << 8,
                     ISO_OUTLINE_BYTES);
    assert_int_equal(web_stream_dropped(slow.stream), 7);
    assert_int_equal(rig->service.n_watches, 1);

    rig_close(&fast);
    assert_true(send(rig->service.outline_fd, "x", 1, MSG_NOSIGNAL) == 1); /* still one viewer */
    rig_close(&slow);
    assert_true(send(rig->service.outline_fd, "x", 1, MSG_NOSIGNAL) < 0);
    rig_exchange_done(&fast);
    rig_exchange_done(&slow);
}

static void the_outline_comes_back_with_the_daemon(void **state)
{
    struct rig *rig = *state;
    if (!rig) {
        skip();
    }
    struct web_exchange exchange = rig_exchange(WEB_ROLE_OBSERVER, 1, NULL);
    web_api_get_outline(&rig->api, &exchange);
    rig_wait(rig->event, has_outline, rig, "Watch");
    rig_service_stop(&rig->service);
    rig_wait_daemon(rig, false);
    struct web_exchange refused = rig_exchange(WEB_ROLE_OBSERVER, 2, NULL);
    web_api_get_outline(&rig->api, &refused);
    rig_expect(rig->event, &refused, 503, "no-daemon");
    rig_service_start(&rig->service, rig->event, rig->bus.address);
    rig_wait(rig->event, is_reopened, rig, "the second Watch");
    rig_run(rig->event, 50);
    send_outline(rig, 9);
    rig_wait(rig->event, has_received, exchange.stream, "a record");
    rig_close(&exchange);
    rig_exchange_done(&exchange);
    rig_exchange_done(&refused);
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
        RIG_TEST(each_call_is_answered_when_the_daemon_goes_and_comes_back),
        RIG_TEST(each_call_is_answered_when_the_bus_goes_and_comes_back),
        RIG_TEST(calls_that_wait_are_answered_at_the_end),
        RIG_TEST(a_stream_of_events_begins_with_the_state_and_follows_it),
        RIG_TEST(signals_become_events_and_those_of_other_clients_do_not),
        RIG_TEST(one_stream_of_the_daemon_serves_all_who_watch_the_outline),
        RIG_TEST(the_outline_comes_back_with_the_daemon),
        RIG_TEST(the_log_says_who_was_let_in_last),
        RIG_TEST(the_log_is_read_on_where_reading_stopped),
        cmocka_unit_test(the_table_keeps_apart_who_had_a_name_when),
        cmocka_unit_test(the_history_has_a_sample_of_each_minute_of_a_day),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
