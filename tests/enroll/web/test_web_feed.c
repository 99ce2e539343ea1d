/* What the pages see of the daemon: events and the outline; and its connection. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "firmware/contract/contract.h"
#include "firmware/contract/stream_record.h"
#include "tests/enroll/web/rigs/handler_rig.h"

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

/* More calls wait than the daemon answers at once. Then comes what protects the door. */
static void urgent_calls_do_not_wait_for_the_others(void **state)
{
    enum { MANY = 50 };
    struct rig *rig = *state;
    struct reply replies[MANY], record = {.answered = false}, lockdown = {.answered = false},
                                login = {.answered = false};
    if (!rig) {
        skip();
    }
    struct web_daemon *daemon = rig->api.daemon;
    rig->service.trace[0] = '\0';
    for (int i = 0; i < MANY; i++) {
        sd_bus_message *call = web_daemon_message(daemon, ISO_CONTRACT_RENAME_PERSON);
        assert_true(sd_bus_message_append(call, "ss", "a", "b") >= 0);
        replies[i] = (struct reply){.answered = false};
        web_daemon_send(daemon, call, 0, on_reply, &replies[i]);
    }
    assert_true(web_daemon_waiting(daemon) > 10);
    web_daemon_record(daemon, "ada", "lockdown-on", "", on_reply, &record);
    sd_bus_message *call = web_daemon_message(daemon, ISO_CONTRACT_SET_LOCKDOWN);
    assert_true(sd_bus_message_append(call, "b", 1) >= 0);
    web_daemon_send(daemon, call, 0, on_reply, &lockdown);
    web_daemon_record(daemon, "ada", "login", "", on_reply, &login);
    rig_until(rig->event, &record.answered);
    rig_until(rig->event, &lockdown.answered);
    rig_until(rig->event, &login.answered);
    const char *at = strstr(rig->service.trace, "RecordAct ada lockdown-on ;SetLockdown 1;");
    assert_non_null(at);
    assert_non_null(strstr(at, "RenamePerson a b;RenamePerson a b;"));
    at = strstr(rig->service.trace, "RecordAct ada login ;");
    assert_non_null(at);
    assert_null(strstr(at, "RenamePerson"));
}

/* ---- events ---- */

static void send_visit(struct rig *rig, const char *verdict, const char *person, const char *door)
{
    rig_service_signal(&rig->service, false, ISO_CONTRACT_VISIT, "ssdduxsss", verdict, person, 2.5,
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

#define RIG_TEST(name) cmocka_unit_test_setup_teardown(name, rig_setup, rig_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        RIG_TEST(each_call_is_answered_when_the_daemon_goes_and_comes_back),
        RIG_TEST(each_call_is_answered_when_the_bus_goes_and_comes_back),
        RIG_TEST(calls_that_wait_are_answered_at_the_end),
        RIG_TEST(urgent_calls_do_not_wait_for_the_others),
        RIG_TEST(a_stream_of_events_begins_with_the_state_and_follows_it),
        RIG_TEST(signals_become_events_and_those_of_other_clients_do_not),
        RIG_TEST(one_stream_of_the_daemon_serves_all_who_watch_the_outline),
        RIG_TEST(the_outline_comes_back_with_the_daemon),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
