/* Streams of the web server: slow clients, clients that go away, and what ends a stream. */
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/enroll/web/rigs/web_rig.h"
#include "tests/support/scratch.h"

enum { STREAMS_MOST = 16, FRAME_BYTES = 20000, RESIDENT_MOST_KB = 12 << 10 };

/* Sanitizers need memory of their own. */
extern void __asan_init(void) __attribute__((weak));
extern void __tsan_init(void) __attribute__((weak));

static struct web_rig rig;
static struct web_stream *streams[STREAMS_MOST]; /* in the order in which they were opened */
static int n_opened, n_closed;

static void on_closed(void *context, struct web_stream *stream)
{
    int found = 0;
    (void)context;

    for (int i = 0; i < n_opened; i++) {
        if (streams[i] == stream) {
            streams[i] = NULL;
            found++;
        }
    }
    assert_int_equal(found, 1);
    n_closed++;
}

static void open_stream(struct web_exchange *exchange, enum web_stream_kind kind)
{
    struct web_stream *stream = web_exchange_stream(exchange, "application/octet-stream", kind,
                                                    on_closed, NULL);

    assert_non_null(stream);
    assert_true(n_opened < STREAMS_MOST);
    streams[n_opened++] = stream;
}

static void frames(void *context, struct web_exchange *exchange)
{
    (void)context;
    open_stream(exchange, WEB_STREAM_FRAMES);
}

static void events(void *context, struct web_exchange *exchange)
{
    (void)context;
    open_stream(exchange, WEB_STREAM_EVENTS);
}

static const struct web_route routes[] = {
    {"GET", "/frames", WEB_ROLE_OBSERVER, frames},
    {"GET", "/events", WEB_ROLE_OBSERVER, events},
    {"GET", "/open", WEB_ROLE_NONE, events},
    {NULL, NULL, WEB_ROLE_NONE, NULL},
};

static int setup(void **state)
{
    assert_int_equal(scratch_setup(state), 0);
    n_opened = n_closed = 0;
    web_rig_start(&rig, *state, routes, &rig);
    return 0;
}

static int teardown(void **state)
{
    web_rig_stop(&rig);
    return scratch_teardown(state);
}

/* Opens a stream and reads the head of the answer. */
static void begin(struct https *client, const char *path, const char *headers, bool small_buffer)
{
    struct https_answer answer;
    char *request = NULL;

    assert_int_equal(https_open(client, rig.event, rig.port, "NORMAL", small_buffer), 0);
    assert_true(asprintf(&request, "GET /api/v1%s HTTP/1.1\r\nHost: door.test\r\n%s\r\n", path,
                         headers) > 0);
    https_send(client, request);
    free(request);
    https_read_head(client, &answer);
    assert_int_equal(answer.status, 200);
    assert_string_equal(https_header(&answer, "Cache-Control"), "no-store");
    assert_string_equal(https_header(&answer, "X-Content-Type-Options"), "nosniff");
    assert_non_null(https_header(&answer, "Content-Security-Policy"));
}

/* A chunk of which each byte is `value`. */
static void send_bytes(struct web_stream *stream, uint8_t value, size_t size)
{
    struct web_chunk *chunk = web_chunk_new(size);

    assert_non_null(chunk);
    memset(chunk->bytes, value, size);
    web_stream_send(stream, chunk);
    web_chunk_unref(chunk);
}

static void wait_until_closed(int n)
{
    const time_t end = time(NULL) + 10;

    while (n_closed < n) {
        assert_true(time(NULL) < end);
        https_pump(rig.event, -1);
    }
    assert_int_equal(n_closed, n);
}

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

    begin(&client, "/frames", web_rig_login(&rig, "eve", WEB_ROLE_OBSERVER, NULL), false);
    assert_int_equal(web_server_streams(rig.server), 1);
    for (uint8_t i = 1; i <= 20; i++) {
        send_bytes(streams[0], i, i * 100u);
        read_bytes(&client, i, i * 100u);
    }
    send_bytes(streams[0], 7, 50000);
    send_bytes(streams[0], 7, 10);
    web_stream_end(streams[0]);
    send_bytes(streams[0], 8, 10);
    read_bytes(&client, 7, 50010);
    assert_null(https_read_chunk(&client, &n));
    assert_int_equal(n, 0);
    wait_until_closed(1);
    assert_int_equal(web_server_streams(rig.server), 0);
    https_close(&client);
}

static void a_slow_client_loses_frames_and_holds_back_nobody(void **state)
{
    const char *headers = web_rig_login(&rig, "eve", WEB_ROLE_OBSERVER, NULL);
    struct https slow, quick;
    int last = 0, n_frames = 0;
    size_t n, left = 0;
    (void)state;

    begin(&slow, "/frames", headers, true);
    begin(&quick, "/frames", headers, false);
    for (int i = 1; i <= 200; i++) {
        send_bytes(streams[0], (uint8_t)i, FRAME_BYTES);
        send_bytes(streams[1], (uint8_t)i, FRAME_BYTES);
        read_bytes(&quick, (uint8_t)i, FRAME_BYTES);
    }
    assert_int_equal(web_stream_dropped(streams[1]), 0);
    const uint64_t dropped = web_stream_dropped(streams[0]);
    assert_true(dropped > 100);
    web_stream_end(streams[0]);
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
    wait_until_closed(2);
}

static void a_client_that_misses_events_is_closed(void **state)
{
    const char *headers = web_rig_login(&rig, "eve", WEB_ROLE_OBSERVER, NULL);
    struct https slow, quick;
    int sent = 0;
    size_t n;
    (void)state;

    begin(&slow, "/events", headers, true);
    begin(&quick, "/events", headers, false);
    while (streams[0]) {
        assert_true(++sent < 1000);
        send_bytes(streams[0], 1, 4096);
        send_bytes(streams[1], 2, 4096);
        read_bytes(&quick, 2, 4096);
    }
    assert_true(sent > WEB_STREAM_EVENTS_MOST);
    assert_int_equal(n_closed, 1);
    assert_non_null(streams[1]);
    /* The body has no end, so the client knows that something is missing. */
    for (char *chunk; (chunk = https_read_chunk(&slow, &n));) {
        free(chunk);
    }
    assert_int_equal(n, 1);
    https_close(&slow);
    https_close(&quick);
    wait_until_closed(2);
}

static void a_client_that_is_gone_is_noticed(void **state)
{
    const char *headers = web_rig_login(&rig, "eve", WEB_ROLE_OBSERVER, NULL);
    const struct linger reset = {.l_onoff = 1};
    struct https polite, rude, stays;
    (void)state;

    begin(&stays, "/events", headers, false);
    begin(&polite, "/events", headers, false);
    begin(&rude, "/frames", headers, false);
    /* None of them has anything to send, so the server has nothing to do. */
    for (int i = 0; sd_event_run(rig.event, 0) > 0; i++) {
        assert_true(i < 100);
    }
    assert_int_equal(sd_event_run(rig.event, 100000), 0);
    https_close(&polite);
    wait_until_closed(1);
    assert_null(streams[1]);
    assert_int_equal(setsockopt(rude.fd, SOL_SOCKET, SO_LINGER, &reset, sizeof reset), 0);
    https_close(&rude);
    wait_until_closed(2);
    assert_null(streams[2]);
    send_bytes(streams[0], 5, 3);
    read_bytes(&stays, 5, 3);
    https_close(&stays);
    wait_until_closed(3);
}

static void a_stream_ends_with_its_session(void **state)
{
    struct https old, stuck, other, public;
    uint64_t id;
    char headers[512];
    size_t n;
    (void)state;

    (void)snprintf(headers, sizeof headers, "%s",
                   web_rig_login(&rig, "eve", WEB_ROLE_OBSERVER, &id));
    begin(&old, "/events", headers, false);
    begin(&stuck, "/events", headers, true);
    begin(&other, "/events", web_rig_login(&rig, "bob", WEB_ROLE_OBSERVER, NULL), false);
    begin(&public, "/open", "", false);
    for (int i = 0; i < 40; i++) {
        send_bytes(streams[1], 9, 16000);
        https_pump(rig.event, -1);
    }
    web_server_end_stale_streams(rig.server);
    assert_int_equal(web_server_streams(rig.server), 4);
    web_session_end(&rig.sessions, id);
    web_server_end_stale_streams(rig.server);
    assert_null(https_read_chunk(&old, &n));
    assert_int_equal(n, 0);
    wait_until_closed(1);
    assert_null(streams[0]);
    /* The one whose client reads nothing is closed by the next search, which comes by itself. */
    wait_until_closed(2);
    assert_null(streams[1]);
    send_bytes(streams[2], 5, 3);
    read_bytes(&other, 5, 3);
    send_bytes(streams[3], 5, 3);
    read_bytes(&public, 5, 3);
    https_close(&old);
    https_close(&stuck);
    https_close(&other);
    https_close(&public);
    wait_until_closed(4);
}

static void the_server_ends_with_open_streams(void **state)
{
    const char *headers = web_rig_login(&rig, "eve", WEB_ROLE_OBSERVER, NULL);
    struct https idle, busy, fresh;
    size_t n;
    (void)state;

    begin(&idle, "/events", headers, false);
    begin(&busy, "/frames", headers, true);
    begin(&fresh, "/frames", headers, false);
    for (int i = 0; i < 40; i++) {
        send_bytes(streams[1], 9, FRAME_BYTES);
        https_pump(rig.event, -1);
    }
    send_bytes(streams[2], 9, FRAME_BYTES);
    web_server_free(rig.server);
    rig.server = NULL;
    assert_int_equal(n_closed, 3);
    assert_null(https_read_chunk(&idle, &n));
    assert_true(idle.ended);
    https_close(&idle);
    https_close(&busy);
    https_close(&fresh);
}

/* Reads 16 streams until it is killed. */
static void read_streams(const char *headers)
{
    static struct https clients[STREAMS_MOST];

    (void)prctl(PR_SET_PDEATHSIG, SIGKILL);
    rig.event = NULL;
    for (int i = 0; i < STREAMS_MOST; i++) {
        begin(&clients[i], "/frames", headers, false);
    }
    for (;;) {
        for (int i = 0; i < STREAMS_MOST; i++) {
            https_receive(&clients[i]);
            clients[i].n = 0;
        }
        https_pump(NULL, clients[0].fd);
    }
}

static void sixteen_streams_need_little_memory(void **state)
{
    const char *headers = web_rig_login(&rig, "eve", WEB_ROLE_OBSERVER, NULL);
    uint8_t value = 0;
    long kb;
    (void)state;

    const pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        read_streams(headers);
    }
    for (const time_t end = time(NULL) + 10; n_opened < STREAMS_MOST;) {
        assert_true(time(NULL) < end);
        https_pump(rig.event, -1);
    }
    for (int frame = 0; frame < 100; frame++, value++) {
        for (int i = 0; i < STREAMS_MOST; i++) {
            send_bytes(streams[i], value, 4000);
        }
        https_pump(rig.event, -1);
    }
    kb = web_rig_resident_kb();
    assert_int_equal(n_closed, 0);
    assert_int_equal(kill(child, SIGKILL), 0);
    assert_int_equal(waitpid(child, NULL, 0), child);
    wait_until_closed(STREAMS_MOST);
    print_message("resident with %d streams: %ld kB\n", STREAMS_MOST, kb);
    if (!__asan_init && !__tsan_init && !getenv("VALGRIND_LAUNCHER")) {
        assert_true(kb < RESIDENT_MOST_KB);
    }
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, setup, teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(sixteen_streams_need_little_memory),
        TEST(a_stream_sends_at_once_and_ends_in_order),
        TEST(a_slow_client_loses_frames_and_holds_back_nobody),
        TEST(a_client_that_misses_events_is_closed),
        TEST(a_client_that_is_gone_is_noticed),
        TEST(a_stream_ends_with_its_session),
        TEST(the_server_ends_with_open_streams),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
