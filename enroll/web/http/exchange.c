#include "enroll/web/http/exchange.h"

#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/web/http/answer.h"
#include "enroll/web/http/gzip.h"
#include "enroll/web/http/inner.h"

struct web_exchange *web__exchange_new(struct web_server *server, const char *uri)
{
    struct web_exchange *exchange = calloc(1, sizeof *exchange);

    if (!exchange) {
        return NULL;
    }
    exchange->uri = strdup(uri);
    if (!exchange->uri) {
        free(exchange);
        return NULL;
    }
    exchange->server = server;
    exchange->next = server->exchanges;
    if (exchange->next) {
        exchange->next->previous = exchange;
    }
    server->exchanges = exchange;
    return exchange;
}

/* Passwords are members of the body, so its texts are wiped. */
static void free_json(json_t *json)
{
    const char *name;
    json_t *value;

    json_object_foreach(json, name, value)
    {
        if (json_is_string(value)) {
            sodium_memzero((char *)(uintptr_t)json_string_value(value), json_string_length(value));
        }
    }
    json_decref(json);
}

static void free_exchange(struct web_exchange *exchange)
{
    if (exchange->response) {
        MHD_destroy_response(exchange->response);
    }
    if (exchange->body) {
        sodium_memzero(exchange->body, exchange->body_size);
        free(exchange->body);
    }
    free_json(exchange->json);
    free(exchange->uri);
    sodium_memzero(exchange, sizeof *exchange);
    free(exchange);
}

void web__exchange_completed(struct web_exchange *exchange)
{
    struct web_server *server = exchange->server;

    if (exchange->previous) {
        exchange->previous->next = exchange->next;
    } else {
        server->exchanges = exchange->next;
    }
    if (exchange->next) {
        exchange->next->previous = exchange->previous;
    }
    if (exchange->taking) {
        exchange->taking = false;
        exchange->intake->drop(server->setup.context, exchange);
    }
    exchange->server = NULL;
    exchange->connection = NULL;
    if (exchange->stream) {
        web__stream_closed(exchange->stream);
        exchange->stream = NULL;
    }
    if (exchange->answered || !exchange->handled) {
        free_exchange(exchange);
    }
}

void web__exchange_answer(struct web_exchange *exchange, unsigned status,
                          struct MHD_Response *response)
{
    if (!exchange->server) {
        if (response) {
            MHD_destroy_response(response);
        }
        free_exchange(exchange);
        return;
    }
    for (size_t i = 0; response && i < exchange->n_headers; i++) {
        if (MHD_add_response_header(response, exchange->headers[i].name,
                                    exchange->headers[i].value) != MHD_YES) {
            MHD_destroy_response(response);
            response = NULL;
        }
    }
    exchange->answered = true;
    exchange->status = status;
    exchange->response = response;
    if (exchange->suspended) {
        exchange->suspended = false;
        web__server_resume(exchange->server, exchange->connection);
    }
}

void web_exchange_refuse(struct web_exchange *exchange, unsigned status, const char *code,
                         const char *detail)
{
    exchange->refusal = (struct web_refusal){.status = status, .code = code, .detail = detail};
}

void web__exchange_refuse(struct web_exchange *exchange)
{
    const struct web_refusal *refusal = &exchange->refusal;

    if (*refusal->allow) {
        web_exchange_header(exchange, "Allow", refusal->allow);
    }
    web_exchange_problem(exchange, refusal->status, refusal->code, refusal->detail);
}

const char *web_exchange_method(const struct web_exchange *exchange)
{
    return exchange->method;
}

const char *web_exchange_request_header(const struct web_exchange *exchange, const char *name)
{
    return exchange->connection
               ? MHD_lookup_connection_value(exchange->connection, MHD_HEADER_KIND, name)
               : NULL;
}

const char *web_exchange_part(const struct web_exchange *exchange)
{
    return exchange->part;
}

const char *web_exchange_query(const struct web_exchange *exchange, const char *name)
{
    return web_query_find(&exchange->query, name);
}

json_t *web_exchange_body(const struct web_exchange *exchange)
{
    return exchange->json;
}

const void *web_exchange_bytes(const struct web_exchange *exchange, size_t *size)
{
    *size = exchange->body_size;
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

const struct sockaddr *web_exchange_address(const struct web_exchange *exchange)
{
    return (const struct sockaddr *)&exchange->address;
}

/* Answers with this response, or with 500 without one. */
static void answer_or_fail(struct web_exchange *exchange, unsigned status,
                           struct MHD_Response *response)
{
    if (!response) {
        status = 500;
        response = web__answer_json(
            500, web_problem_json(500, "internal", "there is no memory for the answer"));
    }
    web__exchange_answer(exchange, status, response);
}

void web_exchange_json(struct web_exchange *exchange, unsigned status, json_t *json)
{
    answer_or_fail(exchange, status, web__answer_json(status, json));
}

void web_exchange_text(struct web_exchange *exchange, unsigned status, char *text, size_t size)
{
    if (text && size >= WEB_GZIP_LEAST_BYTES && exchange->connection &&
        web__accepts_gzip(MHD_lookup_connection_value(exchange->connection, MHD_HEADER_KIND,
                                                      "Accept-Encoding")) &&
        web__gzip(&text, &size)) {
        web_exchange_header(exchange, "Content-Encoding", "gzip");
    }
    answer_or_fail(exchange, status, web__answer_text(status, text, size));
}

void web_exchange_typed(struct web_exchange *exchange, unsigned status, const char *content_type,
                        char *text, size_t size)
{
    answer_or_fail(exchange, status,
                   text ? web__answer_typed(content_type, text, size) : web__answer_empty());
}

void web_exchange_source(struct web_exchange *exchange, const char *content_type,
                         const struct web_source *source)
{
    answer_or_fail(exchange, 200, web__answer_source(content_type, source));
}

void web_exchange_done(struct web_exchange *exchange)
{
    web__exchange_answer(exchange, 204, web__answer_empty());
}

void web_exchange_problem(struct web_exchange *exchange, unsigned status, const char *code,
                          const char *detail)
{
    web_exchange_json(exchange, status, web_problem_json(status, code, detail));
}

void web_exchange_header(struct web_exchange *exchange, const char *name, const char *value)
{
    if (exchange->n_headers < WEB_HEADERS_MOST) {
        struct web_header *header = &exchange->headers[exchange->n_headers++];
        (void)snprintf(header->name, sizeof header->name, "%s", name);
        (void)snprintf(header->value, sizeof header->value, "%s", value);
    }
}

struct web_stream *web_exchange_stream(struct web_exchange *exchange, const char *content_type,
                                       enum web_stream_kind kind,
                                       void (*on_closed)(void *context, struct web_stream *stream),
                                       void *context)
{
    struct MHD_Response *response = NULL;
    struct web_stream *stream = NULL;

    if (exchange->server) {
        stream = web__stream_new(exchange, content_type, &response);
    }
    if (!stream) {
        web_exchange_problem(exchange, 500, "internal", "there is no memory for a stream");
        return NULL;
    }
    stream->kind = kind;
    stream->on_closed = on_closed;
    stream->context = context;
    exchange->stream = stream;
    web__exchange_answer(exchange, 200, response);
    return stream;
}
