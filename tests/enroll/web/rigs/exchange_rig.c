#include "tests/enroll/web/rigs/exchange_rig.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { WAIT_MS = 20000, LOOK_MS = 20 };

/* ---- streams ---- */

static void receive(struct web_stream *stream, struct web_chunk *chunk)
{
    web_chunk_unref(stream->last);
    stream->last = web_chunk_ref(chunk);
    stream->n_received++;
    if (stream->kind == WEB_STREAM_EVENTS &&
        stream->text_size + chunk->size < sizeof stream->text) {
        memcpy(stream->text + stream->text_size, chunk->bytes, chunk->size);
        stream->text_size += chunk->size;
        stream->text[stream->text_size] = '\0';
    }
}

void web_stream_send(struct web_stream *stream, struct web_chunk *chunk)
{
    const int most = stream->kind == WEB_STREAM_EVENTS ? (int)WEB_STREAM_EVENTS_MOST
                                                       : (int)WEB_STREAM_FRAMES_MOST;
    if (stream->ended) {
        return;
    }
    if (!stream->slow) {
        receive(stream, chunk);
    } else if (stream->n_waiting < most) {
        stream->waiting[stream->n_waiting++] = web_chunk_ref(chunk);
    } else if (stream->kind == WEB_STREAM_EVENTS) {
        stream->ended = true;
    } else {
        web_chunk_unref(stream->waiting[0]);
        memmove(stream->waiting, stream->waiting + 1, sizeof *stream->waiting * (size_t)(most - 1));
        stream->waiting[most - 1] = web_chunk_ref(chunk);
        stream->dropped++;
    }
}

uint64_t web_stream_dropped(const struct web_stream *stream)
{
    return stream->dropped;
}

void web_stream_end(struct web_stream *stream)
{
    stream->ended = true;
}

void rig_close(struct web_exchange *exchange)
{
    struct web_stream *stream = exchange->stream;
    assert_non_null(stream);
    exchange->stream = NULL;
    stream->on_closed(stream->context, stream);
    for (int i = 0; i < stream->n_waiting; i++) {
        web_chunk_unref(stream->waiting[i]);
    }
    web_chunk_unref(stream->last);
    free(stream);
}

/* ---- exchanges ---- */

struct web_exchange rig_exchange(enum web_role role, uint64_t session, const char *body)
{
    struct web_exchange exchange = {.account = "ada", .role = role, .session = session};
    char text[1024] = "{}";
    if (body) {
        (void)snprintf(text, sizeof text, "%s", body);
    }
    for (char *p = text; *p; p++) {
        *p = *p == '\'' ? '"' : *p;
    }
    exchange.body = json_loads(text, 0, NULL);
    assert_non_null(exchange.body);
    return exchange;
}

void rig_exchange_done(struct web_exchange *exchange)
{
    assert_null(exchange->stream);
    json_decref(exchange->body);
    json_decref(exchange->json);
    *exchange = (struct web_exchange){.body = NULL};
}

const char *web_exchange_part(const struct web_exchange *exchange)
{
    return exchange->part;
}

const char *web_exchange_query(const struct web_exchange *exchange, const char *name)
{
    for (int i = 0; exchange->query[i]; i += 2) {
        if (strcmp(exchange->query[i], name) == 0) {
            return exchange->query[i + 1];
        }
    }
    return NULL;
}

json_t *web_exchange_body(const struct web_exchange *exchange)
{
    return exchange->body;
}

const char *web_exchange_account(const struct web_exchange *exchange)
{
    return exchange->account;
}

enum web_role web_exchange_role(const struct web_exchange *exchange)
{
    return exchange->role;
}

uint64_t web_exchange_session(const struct web_exchange *exchange)
{
    return exchange->session;
}

static void answer(struct web_exchange *exchange, unsigned status)
{
    assert_false(exchange->answered); /* an exchange is answered once */
    exchange->answered = true;
    exchange->status = status;
}

void web_exchange_json(struct web_exchange *exchange, unsigned status, json_t *json)
{
    answer(exchange, json ? status : 500);
    exchange->json = json;
}

void web_exchange_text(struct web_exchange *exchange, unsigned status, char *text, size_t size)
{
    answer(exchange, text ? status : 500);
    if (text) {
        exchange->json = json_loadb(text, size, 0, NULL);
        assert_non_null(exchange->json);
        free(text);
    }
}

void web_exchange_done(struct web_exchange *exchange)
{
    answer(exchange, 204);
}

void web_exchange_problem(struct web_exchange *exchange, unsigned status, const char *code,
                          const char *detail)
{
    answer(exchange, status);
    (void)snprintf(exchange->code, sizeof exchange->code, "%s", code);
    (void)snprintf(exchange->detail, sizeof exchange->detail, "%s", detail);
}

struct web_stream *web_exchange_stream(struct web_exchange *exchange, const char *content_type,
                                       enum web_stream_kind kind,
                                       void (*on_closed)(void *context, struct web_stream *stream),
                                       void *context)
{
    assert_string_equal(content_type, kind == WEB_STREAM_EVENTS ? "text/event-stream"
                                                                : "application/octet-stream");
    struct web_stream *stream = calloc(1, sizeof *stream);
    assert_non_null(stream);
    answer(exchange, 200);
    stream->kind = kind;
    stream->on_closed = on_closed;
    stream->context = context;
    exchange->stream = stream;
    return stream;
}

/* ---- the event loop ---- */

static int64_t now_ms(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000 + now.tv_nsec / 1000000;
}

void rig_wait(sd_event *event, bool (*holds)(void *context), void *context, const char *what)
{
    const int64_t end_ms = now_ms() + WAIT_MS;
    while (!holds(context)) {
        if (now_ms() > end_ms) {
            fail_msg("waited in vain for: %s", what);
        }
        assert_true(sd_event_run(event, LOOK_MS * 1000) >= 0);
    }
}

static bool is_set(void *context)
{
    return *(const bool *)context;
}

void rig_until(sd_event *event, const bool *flag)
{
    rig_wait(event, is_set, (void *)flag, "a flag");
}

void rig_run(sd_event *event, unsigned ms)
{
    const int64_t end_ms = now_ms() + ms;
    while (now_ms() < end_ms) {
        assert_true(sd_event_run(event, LOOK_MS * 1000) >= 0);
    }
}

void rig_expect(sd_event *event, struct web_exchange *exchange, unsigned status, const char *code)
{
    rig_until(event, &exchange->answered);
    if (exchange->status != status || (code && strcmp(exchange->code, code) != 0)) {
        fail_msg("answered %u %s: %s", exchange->status, exchange->code, exchange->detail);
    }
}

struct wanted {
    const struct web_stream *stream;
    const char *text;
};

static bool has_text(void *context)
{
    const struct wanted *wanted = context;
    return strstr(wanted->stream->text, wanted->text) != NULL;
}

void rig_expect_text(sd_event *event, struct web_stream *stream, const char *text)
{
    struct wanted wanted = {stream, text};
    rig_wait(event, has_text, &wanted, text);
}
