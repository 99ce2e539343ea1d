#include "tests/enroll/web/rigs/stream_rig.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "tests/firmware/rigs/cmocka_headers.h"
#include "tests/support/scratch.h"

struct web_rig stream_rig;
struct web_stream *stream_rig_streams[STREAM_RIG_MOST];
int stream_rig_opened, stream_rig_closed;
struct web_exchange *stream_rig_deferred;

static void on_closed(void *context, struct web_stream *stream)
{
    int found = 0;
    (void)context;

    for (int i = 0; i < stream_rig_opened; i++) {
        if (stream_rig_streams[i] == stream) {
            stream_rig_streams[i] = NULL;
            found++;
        }
    }
    assert_int_equal(found, 1);
    stream_rig_closed++;
}

void stream_rig_open(struct web_exchange *exchange, enum web_stream_kind kind)
{
    struct web_stream *stream = web_exchange_stream(exchange, "application/octet-stream", kind,
                                                    on_closed, NULL);

    assert_non_null(stream);
    assert_true(stream_rig_opened < STREAM_RIG_MOST);
    stream_rig_streams[stream_rig_opened++] = stream;
}

static void later(void *context, struct web_exchange *exchange)
{
    (void)context;
    stream_rig_deferred = exchange;
}

static void frames(void *context, struct web_exchange *exchange)
{
    (void)context;
    stream_rig_open(exchange, WEB_STREAM_FRAMES);
}

static void events(void *context, struct web_exchange *exchange)
{
    (void)context;
    stream_rig_open(exchange, WEB_STREAM_EVENTS);
}

static const struct web_route routes[] = {
    {"GET", "/frames", WEB_ROLE_OBSERVER, frames},
    {"GET", "/events", WEB_ROLE_OBSERVER, events},
    {"GET", "/later", WEB_ROLE_OBSERVER, later},
    {"GET", "/open", WEB_ROLE_NONE, events},
    {NULL, NULL, WEB_ROLE_NONE, NULL},
};

int stream_rig_setup(void **state)
{
    assert_int_equal(scratch_setup(state), 0);
    stream_rig_opened = stream_rig_closed = 0;
    web_rig_start(&stream_rig, *state, routes, &stream_rig);
    return 0;
}

int stream_rig_teardown(void **state)
{
    web_rig_stop(&stream_rig);
    return scratch_teardown(state);
}

void stream_rig_ask(struct https *client, const char *path, const char *headers, bool small_buffer)
{
    char *request = NULL;

    assert_int_equal(https_open(client, stream_rig.event, stream_rig.port, "NORMAL", small_buffer),
                     0);
    assert_true(asprintf(&request, "GET /api/v1%s HTTP/1.1\r\nHost: door.test\r\n%s\r\n", path,
                         headers) > 0);
    https_send(client, request);
    free(request);
}

void stream_rig_wait_for_deferred(void)
{
    const time_t end = time(NULL) + 10;

    stream_rig_deferred = NULL;
    while (!stream_rig_deferred) {
        assert_true(time(NULL) < end);
        https_pump(stream_rig.event, -1);
    }
}

void stream_rig_begin(struct https *client, const char *path, const char *headers,
                      bool small_buffer)
{
    struct https_answer answer;

    stream_rig_ask(client, path, headers, small_buffer);
    https_read_head(client, &answer);
    assert_int_equal(answer.status, 200);
    assert_string_equal(https_header(&answer, "Cache-Control"), "no-store");
    assert_string_equal(https_header(&answer, "X-Content-Type-Options"), "nosniff");
    assert_non_null(https_header(&answer, "Content-Security-Policy"));
}

void stream_rig_send(struct web_stream *stream, uint8_t value, size_t size)
{
    struct web_chunk *chunk = web_chunk_new(size);

    assert_non_null(chunk);
    memset(chunk->bytes, value, size);
    web_stream_send(stream, chunk);
    web_chunk_unref(chunk);
}

void stream_rig_wait_until_closed(int n)
{
    const time_t end = time(NULL) + 10;

    while (stream_rig_closed < n) {
        assert_true(time(NULL) < end);
        https_pump(stream_rig.event, -1);
    }
    assert_int_equal(stream_rig_closed, n);
}
