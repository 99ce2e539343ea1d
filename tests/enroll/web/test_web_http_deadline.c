/* Clients that are slow on purpose: the deadlines of their connections. The test moves the clock of
 * the deadlines; the clients are real, and send bytes all the time. */
#include <arpa/inet.h>
#include <netinet/in.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "enroll/web/http/now.h"
#include "tests/enroll/web/rigs/web_rig.h"
#include "tests/support/scratch.h"

enum { MANY = WEB_CONNECTIONS_OF_ADDRESS - 4, BIG_BYTES = 8 << 20 };

static struct web_rig rig;
static struct web_exchange *deferred;
static struct web_stream *stream;
static int64_t clock_ns;

static int64_t test_clock(void)
{
    return clock_ns;
}

static void pass(int seconds)
{
    clock_ns += seconds * INT64_C(1000000000);
}

static void now(void *context, struct web_exchange *exchange)
{
    (void)context;
    web_exchange_done(exchange);
}

static void later(void *context, struct web_exchange *exchange)
{
    (void)context;
    deferred = exchange;
}

static void big(void *context, struct web_exchange *exchange)
{
    char *text = malloc(BIG_BYTES);
    (void)context;
    assert_non_null(text);
    memset(text, 'x', BIG_BYTES);
    web_exchange_text(exchange, 200, text, BIG_BYTES);
}

static void on_closed(void *context, struct web_stream *closed)
{
    (void)context;
    (void)closed;
    stream = NULL;
}

static void events(void *context, struct web_exchange *exchange)
{
    (void)context;
    stream = web_exchange_stream(exchange, "text/event-stream", WEB_STREAM_EVENTS, on_closed, NULL);
}

static const struct web_route routes[] = {
    {"GET", "/now", WEB_ROLE_NONE, now},       {"POST", "/now", WEB_ROLE_NONE, now},
    {"GET", "/later", WEB_ROLE_NONE, later},   {"GET", "/big", WEB_ROLE_NONE, big},
    {"GET", "/events", WEB_ROLE_NONE, events}, {NULL, NULL, WEB_ROLE_NONE, NULL},
};

static int setup(void **state)
{
    assert_int_equal(scratch_setup(state), 0);
    clock_ns = web_now_ns();
    web_rig_clock = test_clock;
    web_rig_start(&rig, *state, routes, &rig);
    deferred = NULL;
    stream = NULL;
    return 0;
}

static int teardown(void **state)
{
    web_rig_stop(&rig);
    web_rig_clock = NULL;
    return scratch_teardown(state);
}

/* Sends a byte again and again until the server closes the connection. The rig fails the test if
 * that takes ten seconds: the timeout of libmicrohttpd, which each byte moves, takes longer. */
static void drip_until_closed(struct https *client, const char *byte)
{
    const int64_t end = web_now_ns() + INT64_C(10000000000);

    while (!client->ended) {
        assert_true(web_now_ns() < end);
        /* So slowly that neither the header becomes too long nor the body complete. */
        const struct timespec pause = {.tv_nsec = 2000000};
        (void)nanosleep(&pause, NULL);
        https_send(client, byte);
        https_pump(rig.event, client->fd);
        https_receive(client);
    }
}

/* Sends some bytes, which do not end the connection. */
static void drip(struct https *client, const char *byte)
{
    for (int i = 0; i < 20; i++) {
        https_send(client, byte);
        https_pump(rig.event, -1);
        https_receive(client);
        assert_false(client->ended);
    }
}

/* A client that is not slow is served. */
static void expect_service(void)
{
    struct https client;

    web_rig_connect(&rig, &client);
    web_rig_expect(&client, "GET", "/api/v1/now", "", NULL, 204, NULL);
    web_rig_expect(&client, "POST", "/api/v1/now", WEB_RIG_ORIGIN WEB_RIG_JSON, "{}", 204, NULL);
    https_close(&client);
}

static void slow_with(const char *begin, const char *byte)
{
    struct https client;

    web_rig_connect(&rig, &client);
    https_send(&client, begin);
    drip(&client, byte);
    pass(WEB_REQUEST_S - 1);
    drip(&client, byte);
    expect_service();
    pass(WEB_REQUEST_S); /* the server may have read the line of the request only now */
    drip_until_closed(&client, byte);
    assert_int_equal(client.n, 0);
    https_close(&client);
    expect_service();
}

static void the_line_of_a_request_has_a_deadline(void **state)
{
    (void)state;
    slow_with("GET /", "a");
}

static void the_header_of_a_request_has_a_deadline(void **state)
{
    (void)state;
    slow_with("GET /api/v1/now HTTP/1.1\r\nHost: door.test\r\nX-Slow: ", "a");
}

static void the_body_of_a_request_has_a_deadline(void **state)
{
    (void)state;
    slow_with("POST /api/v1/now HTTP/1.1\r\nHost: door.test\r\n" WEB_RIG_ORIGIN WEB_RIG_JSON
              "Content-Length: 60000\r\n\r\n{",
              " ");
}

static void the_next_request_of_a_connection_has_a_deadline(void **state)
{
    struct https client;
    (void)state;

    web_rig_connect(&rig, &client);
    pass(WEB_REQUEST_S - 1);
    web_rig_expect(&client, "GET", "/api/v1/now", "", NULL, 204, NULL);
    pass(WEB_IDLE_S - 1);
    web_rig_expect(&client, "GET", "/api/v1/now", "", NULL, 204, NULL);
    https_send(&client, "GET /");
    pass(WEB_IDLE_S - 1);
    drip(&client, "a");
    pass(1);
    drip_until_closed(&client, "a");
    https_close(&client);
}

static void an_answer_that_is_not_read_has_a_deadline(void **state)
{
    struct https client;
    const int64_t end = web_now_ns() + INT64_C(20000000000);
    (void)state;

    assert_int_equal(https_open(&client, rig.event, rig.port, "NORMAL", true), 0);
    https_send(&client, "GET /api/v1/big HTTP/1.1\r\nHost: door.test\r\n\r\n");
    while (client.n == 0) {
        https_pump(rig.event, client.fd);
        https_receive(&client);
    }
    pass(WEB_ANSWER_S);
    /* The sweep ends the connection while nothing is read. */
    for (int64_t until = web_now_ns() + INT64_C(2500000000); web_now_ns() < until;) {
        https_pump(rig.event, -1);
    }
    while (!client.ended) {
        assert_true(web_now_ns() < end);
        https_receive(&client);
        https_pump(NULL, client.fd); /* the server does not work: what the kernel has is the rest */
    }
    assert_true(client.n < BIG_BYTES);
    https_close(&client);
    expect_service();
}

/* What waits for the server is not too late. */
static void streams_and_waiting_requests_live_on(void **state)
{
    struct https events_client, later_client;
    struct https_answer answer;
    struct web_chunk *chunk = web_chunk_new(2);
    char *received;
    size_t n;
    (void)state;

    web_rig_connect(&rig, &events_client);
    https_send(&events_client, "GET /api/v1/events HTTP/1.1\r\nHost: door.test\r\n\r\n");
    https_read_head(&events_client, &answer);
    assert_int_equal(answer.status, 200);
    web_rig_connect(&rig, &later_client);
    https_send(&later_client, "GET /api/v1/later HTTP/1.1\r\nHost: door.test\r\n\r\n");
    while (!deferred) {
        https_pump(rig.event, -1);
    }
    pass(100 * WEB_ANSWER_S);
    for (int64_t until = web_now_ns() + INT64_C(2500000000); web_now_ns() < until;) {
        https_pump(rig.event, -1);
    }
    assert_non_null(stream);
    assert_non_null(chunk);
    memcpy(chunk->bytes, "on", 2);
    web_stream_send(stream, chunk);
    web_chunk_unref(chunk);
    received = https_read_chunk(&events_client, &n);
    assert_non_null(received);
    assert_string_equal(received, "on");
    free(received);
    web_exchange_done(deferred);
    https_read(&later_client, &answer);
    assert_int_equal(answer.status, 204);
    https_answer_free(&answer);
    https_close(&later_client);
    https_close(&events_client);
}

static int connect_raw(void)
{
    const struct sockaddr_in address = {.sin_family = AF_INET,
                                        .sin_port = htons((uint16_t)rig.port),
                                        .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);

    assert_true(fd >= 0);
    (void)connect(fd, (const struct sockaddr *)&address, sizeof address);
    for (int i = 0; i < 3; i++) {
        https_pump(rig.event, -1);
    }
    /* The head of a TLS record that promises 512 bytes. */
    assert_int_equal(send(fd, "\x16\x03\x01\x02\x00", 5, MSG_NOSIGNAL), 5);
    return fd;
}

static void handshakes_without_end_do_not_keep_others_out(void **state)
{
    static int fds[MANY];
    const int64_t end = web_now_ns() + INT64_C(20000000000);
    int n_open = MANY;
    (void)state;

    for (int i = 0; i < MANY; i++) {
        fds[i] = connect_raw();
    }
    expect_service();
    pass(WEB_REQUEST_S - 1);
    expect_service();
    for (int i = 0; i < MANY; i++) {
        assert_int_equal(send(fds[i], "\x01", 1, MSG_NOSIGNAL), 1);
    }
    pass(1);
    while (n_open > 0) {
        assert_true(web_now_ns() < end);
        https_pump(rig.event, -1);
        for (int i = 0; i < MANY; i++) {
            char byte;
            if (fds[i] >= 0 && recv(fds[i], &byte, 1, MSG_DONTWAIT) == 0) {
                assert_int_equal(close(fds[i]), 0);
                fds[i] = -1;
                n_open--;
            }
        }
    }
    expect_service();
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, setup, teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(the_line_of_a_request_has_a_deadline),
        TEST(the_header_of_a_request_has_a_deadline),
        TEST(the_body_of_a_request_has_a_deadline),
        TEST(the_next_request_of_a_connection_has_a_deadline),
        TEST(an_answer_that_is_not_read_has_a_deadline),
        TEST(streams_and_waiting_requests_live_on),
        TEST(handshakes_without_end_do_not_keep_others_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
