/* The way of a request through libmicrohttpd. */
#include <netinet/in.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/web/http/inner.h"

static void refuse_as_too_large(struct web_exchange *exchange)
{
    web_exchange_refuse(exchange, 413, "too-large", "the body of the request is too large");
}

void *web__request_begin(void *server, const char *uri, struct MHD_Connection *connection)
{
    web__deadline_begin(server, connection, WEB_PHASE_REQUEST);
    return web__exchange_new(server, uri);
}

void web__request_completed(void *server, struct MHD_Connection *connection, void **exchange,
                            enum MHD_RequestTerminationCode code)
{
    (void)code;
    web__deadline_begin(server, connection, WEB_PHASE_IDLE);
    if (*exchange) {
        web__exchange_completed(*exchange);
        *exchange = NULL;
    }
}

static enum MHD_Result queue(struct web_exchange *exchange)
{
    enum MHD_Result result;

    web__deadline_begin(exchange->server, exchange->connection,
                        exchange->stream ? WEB_PHASE_STREAM : WEB_PHASE_ANSWER);
    if (exchange->file && !exchange->refusal.status) {
        const char *known = MHD_lookup_connection_value(exchange->connection, MHD_HEADER_KIND,
                                                        "If-None-Match");
        const bool is_unchanged = web__file_is_unchanged(exchange->file, known);
        return MHD_queue_response(exchange->connection, is_unchanged ? 304 : 200,
                                  is_unchanged ? exchange->file->unchanged : exchange->file->whole);
    }
    if (!exchange->response) {
        return MHD_NO;
    }
    result = MHD_queue_response(exchange->connection, exchange->status, exchange->response);
    MHD_destroy_response(exchange->response);
    exchange->response = NULL;
    return result;
}

static void remember_address(struct web_exchange *exchange)
{
    const union MHD_ConnectionInfo *info = MHD_get_connection_info(
        exchange->connection, MHD_CONNECTION_INFO_CLIENT_ADDRESS);
    const struct sockaddr *address = info ? info->client_addr : NULL;

    if (address && address->sa_family == AF_INET) {
        memcpy(&exchange->address, address, sizeof(struct sockaddr_in));
    } else if (address && address->sa_family == AF_INET6) {
        memcpy(&exchange->address, address, sizeof(struct sockaddr_in6));
    }
}

static uint64_t body_most(const struct web_exchange *exchange)
{
    if (exchange->intake) {
        return exchange->intake->most;
    }
    return exchange->plain && exchange->plain->body_most ? exchange->plain->body_most
                                                         : WEB_BODY_MOST_BYTES;
}

/* Returns false after a refusal. */
static bool begin_intake(struct web_exchange *exchange, uint64_t size)
{
    if (!exchange->intake || exchange->refusal.status) {
        return true;
    }
    exchange->taking = exchange->intake->begin(exchange->server->setup.context, exchange, size);
    if (exchange->taking) {
        web__deadline_intake(exchange->server, exchange->connection, size);
    }
    return exchange->taking;
}

/* The first call for a request: its headers are known. */
static enum MHD_Result check(struct web_exchange *exchange, struct MHD_Connection *connection,
                             const char *method)
{
    const char *length;
    uint64_t size;

    exchange->checked = true;
    exchange->connection = connection;
    (void)snprintf(exchange->method, sizeof exchange->method, "%s", method);
    remember_address(exchange);
    web__request_check(exchange, method);
    length = MHD_lookup_connection_value(connection, MHD_HEADER_KIND, "Content-Length");
    size = length ? strtoull(length, NULL, 10) : 0;
    if (size > body_most(exchange) || !begin_intake(exchange, size)) {
        if (!exchange->refusal.status) {
            refuse_as_too_large(exchange);
        }
        /* The body is not read; libmicrohttpd closes the connection after the answer. */
        exchange->handled = true;
        web__exchange_refuse(exchange);
        return queue(exchange);
    }
    return MHD_YES;
}

/* Makes room for the body so far, and for as much again: a client may send it byte by byte, and
 * each move costs as much as the body is long. realloc() would leave a password behind. */
static bool grow(struct web_exchange *exchange)
{
    const size_t room = 2 * exchange->body_received;
    char *larger = malloc(room);

    if (!larger) {
        return false;
    }
    if (exchange->body) {
        memcpy(larger, exchange->body, exchange->body_size);
        sodium_memzero(exchange->body, exchange->body_size);
        free(exchange->body);
    }
    exchange->body = larger;
    exchange->body_room = room;
    return true;
}

/* A piece of the body. What nobody will use is read and thrown away, so that the client sees the
 * answer: a connection that is closed with bytes unread would be reset. */
static enum MHD_Result take(struct web_exchange *exchange, const char *data, size_t size)
{
    exchange->body_received += size;
    if (exchange->body_received > body_most(exchange) && !exchange->refusal.status) {
        refuse_as_too_large(exchange);
    }
    if (exchange->taking) {
        exchange->taking = exchange->intake->take(exchange->server->setup.context, exchange, data,
                                                  size);
        if (!exchange->taking) {
            exchange->intake->drop(exchange->server->setup.context, exchange);
        }
        return MHD_YES;
    }
    if (exchange->refusal.status || (!exchange->route && !exchange->plain)) {
        return exchange->body_received <= WEB_BODY_DRAIN_BYTES ? MHD_YES : MHD_NO;
    }
    if (exchange->body_received > exchange->body_room && !grow(exchange)) {
        return MHD_NO;
    }
    memcpy(exchange->body + exchange->body_size, data, size);
    exchange->body_size = exchange->body_received;
    return MHD_YES;
}

/* A body that is missing counts as an object without members. */
static void read_json(struct web_exchange *exchange)
{
    if (!exchange->body) {
        exchange->json = json_object();
        return;
    }
    exchange->json = json_loadb(exchange->body, exchange->body_size, JSON_REJECT_DUPLICATES, NULL);
    sodium_memzero(exchange->body, exchange->body_size);
    free(exchange->body);
    exchange->body = NULL;
}

/* The request is complete. */
static void handle(struct web_exchange *exchange)
{
    exchange->handled = true;
    exchange->taking = false;
    web__deadline_begin(exchange->server, exchange->connection, WEB_PHASE_HANDLER);
    if (!exchange->refusal.status && exchange->route) {
        read_json(exchange);
        if (!json_is_object(exchange->json)) {
            web_exchange_refuse(exchange, 400, "invalid-json", "the body is no JSON object");
        }
    }
    if (exchange->refusal.status) {
        web__exchange_refuse(exchange);
    } else if (exchange->route) {
        exchange->route->handle(exchange->server->setup.context, exchange);
    } else if (exchange->plain) {
        exchange->plain->handle(exchange->server->setup.context, exchange);
    } else {
        exchange->answered = true;
    }
}

enum MHD_Result web__request_step(void *server, struct MHD_Connection *connection, const char *url,
                                  const char *method, const char *version, const char *data,
                                  size_t *size, void **context)
{
    struct web_exchange *exchange = *context;

    (void)server;
    (void)url;
    (void)version;
    if (!exchange) {
        return MHD_NO;
    }
    if (!exchange->checked) {
        return check(exchange, connection, method);
    }
    if (*size > 0) {
        const enum MHD_Result result = take(exchange, data, *size);
        *size = 0;
        return result;
    }
    if (!exchange->handled) {
        handle(exchange);
    }
    if (exchange->answered) {
        return queue(exchange);
    }
    exchange->suspended = true;
    MHD_suspend_connection(connection);
    return MHD_YES;
}
