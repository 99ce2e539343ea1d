/* Streams of the web server: slow clients, clients that go away, and what ends a stream. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/enroll/web/rigs/stream_rig.h"

enum { FRAME_BYTES = 20000 };

/* Reads this many bytes, each of which has the value. */
static void read_bytes(struct https *client, uint8_t value, size_t size)
{
    while (size > 0) {
        size_t n = 0;
        char *chunk = https_read_chunk(client, &n);
        assert_non_null(chunk);
        assert_true(n <= size);
        for (size_t i = 0; i < n; i++) {
            assert_int_equal((uint8_t)chunk[i], value);
        }
        size -= n;
        free(chunk);
    }
}

static void a_stream_sends_at_once_and_ends_in_order(void **state)
{
    struct https client;
    size_t n;
    (void)state;

    stream_rig_begin(&client, "/frames", web_rig_login(&stream_rig, "eve", WEB_ROLE_OBSERVER, NULL),
                     false);
    assert_int_equal(web_server_streams(stream_rig.server), 1);
    for (uint8_t i = 1; i <= 20; i++) {
        stream_rig_send(stream_rig_streams[0], i, i * 100u);
        read_bytes(&client, i, i * 100u);
    }
    stream_rig_send(stream_rig_streams[0], 7, 50000);
    stream_rig_send(stream_rig_streams[0], 7, 10);
    web_stream_end(stream_rig_streams[0]);
    stream_rig_send(stream_rig_streams[0], 8, 10);
    read_bytes(&client, 7, 50010);
    assert_null(https_read_chunk(&client, &n));
    assert_int_equal(n, 0);
    stream_rig_wait_until_closed(1);
    assert_int_equal(web_server_streams(stream_rig.server), 0);
    https_close(&client);
}

static void a_slow_client_loses_frames_and_holds_back_nobody(void **state)
{
    const char *headers = web_rig_login(&stream_rig, "eve", WEB_ROLE_OBSERVER, NULL);
    struct https slow, quick;
    int last = 0, n_frames = 0;
    size_t n, left = 0;
    (void)state;

    stream_rig_begin(&slow, "/frames", headers, true);
    stream_rig_begin(&quick, "/frames", headers, false);
    for (int i = 1; i <= 200; i++) {
        stream_rig_send(stream_rig_streams[0], (uint8_t)i, FRAME_BYTES);
        stream_rig_send(stream_rig_streams[1], (uint8_t)i, FRAME_BYTES);
        read_bytes(&quick, (uint8_t)i, FRAME_BYTES);
    }
    assert_int_equal(web_stream_dropped(stream_rig_streams[1]), 0);
    const uint64_t dropped = web_stream_dropped(stream_rig_streams[0]);
    assert_true(dropped > 100);
    web_stream_end(stream_rig_streams[0]);
    /* What the slow client reads later are whole frames in their order, and the newest ones. */
    for (char *chunk; (chunk = https_read_chunk(&slow, &n)); free(chunk)) {
        for (size_t i = 0; i < n; i++, left--) {
            if (left == 0) {
                left = FRAME_BYTES;
                assert_true((uint8_t)chunk[i] > last);
                last = (uint8_t)chunk[i];
                n_frames++;
            }
            assert_int_equal((uint8_t)chunk[i], last);
        }
    }
    assert_int_equal(left, 0);
    assert_int_equal(last, 200);
    assert_int_equal((uint64_t)n_frames + dropped, 200);
    https_close(&slow);
    https_close(&quick);
    stream_rig_wait_until_closed(2);
}

static void a_client_that_misses_events_is_closed(void **state)
{
    const char *headers = web_rig_login(&stream_rig, "eve", WEB_ROLE_OBSERVER, NULL);
    struct https slow, quick;
    int sent = 0;
    size_t n;
    (void)state;

    stream_rig_begin(&slow, "/events", headers, true);
    stream_rig_begin(&quick, "/events", headers, false);
    while (stream_rig_streams[0]) {
        assert_true(++sent < 1000);
        stream_rig_send(stream_rig_streams[0], 1, 4096);
        stream_rig_send(stream_rig_streams[1], 2, 4096);
        read_bytes(&quick, 2, 4096);
    }
    assert_true(sent > WEB_STREAM_EVENTS_MOST);
    assert_int_equal(stream_rig_closed, 1);
    assert_non_null(stream_rig_streams[1]);
    /* The body has no end, so the client knows that something is missing. */
    for (char *chunk; (chunk = https_read_chunk(&slow, &n));) {
        free(chunk);
    }
    assert_int_equal(n, 1);
    https_close(&slow);
    https_close(&quick);
    stream_rig_wait_until_closed(2);
}

static void a_client_that_is_gone_is_noticed(void **state)
{
    const char *headers = web_rig_login(&stream_rig, "eve", WEB_ROLE_OBSERVER, NULL);
    const struct linger reset = {.l_onoff = 1};
    struct https polite, rude, stays;
    (void)state;

    stream_rig_begin(&stays, "/events", headers, false);
    stream_rig_begin(&polite, "/events", headers, false);
    stream_rig_begin(&rude, "/frames", headers, false);
    /* None of them has anything to send, so the server has nothing to do. */
    for (int i = 0; sd_event_run(stream_rig.event, 0) > 0; i++) {
        assert_true(i < 100);
    }
    assert_int_equal(sd_event_run(stream_rig.event, 100000), 0);
    https_close(&polite);
    stream_rig_wait_until_closed(1);
    assert_null(stream_rig_streams[1]);
    assert_int_equal(setsockopt(rude.fd, SOL_SOCKET, SO_LINGER, &reset, sizeof reset), 0);
    https_close(&rude);
    stream_rig_wait_until_closed(2);
    assert_null(stream_rig_streams[2]);
    stream_rig_send(stream_rig_streams[0], 5, 3);
    read_bytes(&stays, 5, 3);
    https_close(&stays);
    stream_rig_wait_until_closed(3);
}

static void a_stream_ends_with_its_session(void **state)
{
    struct https old, stuck, other, public;
    uint64_t id;
    char headers[512];
    size_t n;
    (void)state;

    (void)snprintf(headers, sizeof headers, "%s",
                   web_rig_login(&stream_rig, "eve", WEB_ROLE_OBSERVER, &id));
    stream_rig_begin(&old, "/events", headers, false);
    stream_rig_begin(&stuck, "/events", headers, true);
    stream_rig_begin(&other, "/events", web_rig_login(&stream_rig, "bob", WEB_ROLE_OBSERVER, NULL),
                     false);
    stream_rig_begin(&public, "/open", "", false);
    for (int i = 0; i < 40; i++) {
        stream_rig_send(stream_rig_streams[1], 9, 16000);
        https_pump(stream_rig.event, -1);
    }
    web_server_end_stale_streams(stream_rig.server);
    assert_int_equal(web_server_streams(stream_rig.server), 4);
    web_session_end(&stream_rig.sessions, id);
    web_server_end_stale_streams(stream_rig.server);
    assert_null(https_read_chunk(&old, &n));
    assert_int_equal(n, 0);
    stream_rig_wait_until_closed(1);
    assert_null(stream_rig_streams[0]);
    /* The one whose client reads nothing is closed by the next search, which comes by itself. */
    stream_rig_wait_until_closed(2);
    assert_null(stream_rig_streams[1]);
    stream_rig_send(stream_rig_streams[2], 5, 3);
    read_bytes(&other, 5, 3);
    stream_rig_send(stream_rig_streams[3], 5, 3);
    read_bytes(&public, 5, 3);
    https_close(&old);
    https_close(&stuck);
    https_close(&other);
    https_close(&public);
    stream_rig_wait_until_closed(4);
}

static void the_server_ends_with_open_streams(void **state)
{
    const char *headers = web_rig_login(&stream_rig, "eve", WEB_ROLE_OBSERVER, NULL);
    struct https idle, busy, fresh;
    size_t n;
    (void)state;

    stream_rig_begin(&idle, "/events", headers, false);
    stream_rig_begin(&busy, "/frames", headers, true);
    stream_rig_begin(&fresh, "/frames", headers, false);
    for (int i = 0; i < 40; i++) {
        stream_rig_send(stream_rig_streams[1], 9, FRAME_BYTES);
        https_pump(stream_rig.event, -1);
    }
    stream_rig_send(stream_rig_streams[2], 9, FRAME_BYTES);
    web_server_free(stream_rig.server);
    stream_rig.server = NULL;
    assert_int_equal(stream_rig_closed, 3);
    assert_null(https_read_chunk(&idle, &n));
    assert_true(idle.ended);
    https_close(&idle);
    https_close(&busy);
    https_close(&fresh);
}

/* The daemon has to answer before a stream can begin. */
static void a_stream_may_begin_later(void **state)
{
    const char *headers = web_rig_login(&stream_rig, "eve", WEB_ROLE_OBSERVER, NULL);
    struct https stays, goes;
    struct https_answer answer;
    (void)state;

    stream_rig_ask(&stays, "/later", headers, false);
    stream_rig_wait_for_deferred();
    stream_rig_open(stream_rig_deferred, WEB_STREAM_FRAMES);
    https_read_head(&stays, &answer);
    assert_int_equal(answer.status, 200);
    stream_rig_send(stream_rig_streams[0], 3, 30);
    read_bytes(&stays, 3, 30);

    stream_rig_ask(&goes, "/later", headers, false);
    stream_rig_wait_for_deferred();
    https_close(&goes);
    for (int i = 0; i < 3; i++) {
        https_pump(stream_rig.event, -1);
    }
    stream_rig_open(stream_rig_deferred, WEB_STREAM_FRAMES);
    stream_rig_send(stream_rig_streams[1], 4, 30);
    stream_rig_wait_until_closed(1);
    assert_null(stream_rig_streams[1]);
    https_close(&stays);
    stream_rig_wait_until_closed(2);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, stream_rig_setup, stream_rig_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(a_stream_sends_at_once_and_ends_in_order),
        TEST(a_slow_client_loses_frames_and_holds_back_nobody),
        TEST(a_client_that_misses_events_is_closed),
        TEST(a_stream_may_begin_later),
        TEST(a_client_that_is_gone_is_noticed),
        TEST(a_stream_ends_with_its_session),
        TEST(the_server_ends_with_open_streams),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
