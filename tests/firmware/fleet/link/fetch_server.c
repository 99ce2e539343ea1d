#include "tests/firmware/fleet/link/fetch_server.h"

#include <microhttpd.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <time.h>

#include "tests/firmware/rigs/cmocka_headers.h"

struct exchange {
    uint8_t *body;
    size_t size;
    bool is_answered;
    struct fetch_answer answer;
};

static enum MHD_Result send_answer(struct MHD_Connection *connection, struct exchange *exchange)
{
    struct MHD_Response *response = MHD_create_response_from_buffer(
        exchange->answer.size, exchange->answer.bytes, MHD_RESPMEM_MUST_COPY);
    const enum MHD_Result r = MHD_queue_response(connection, exchange->answer.status, response);

    MHD_destroy_response(response);
    return r;
}

static enum MHD_Result step(void *context, struct MHD_Connection *connection, const char *path,
                            const char *method, const char *version, const char *upload,
                            size_t *upload_size, void **state)
{
    struct fetch_server *server = context;
    struct exchange *exchange = *state;

    (void)version;
    if (!exchange) {
        *state = calloc(1, sizeof *exchange);
        return *state ? MHD_YES : MHD_NO;
    }
    if (*upload_size) {
        exchange->body = realloc(exchange->body, exchange->size + *upload_size);
        memcpy(exchange->body + exchange->size, upload, *upload_size);
        exchange->size += *upload_size;
        *upload_size = 0;
        return MHD_YES;
    }
    if (!exchange->is_answered) {
        exchange->is_answered = true;
        server->requests++;
        exchange->answer.status = MHD_HTTP_NOT_FOUND;
        if (strcmp(method, "POST") == 0) {
            server->answer(server->context, path, exchange->body, exchange->size,
                           &exchange->answer);
        }
        if (server->holds) {
            server->holds = false;
            server->held = connection;
            MHD_suspend_connection(connection);
            return MHD_YES;
        }
    }
    return send_answer(connection, exchange);
}

static void completed(void *context, struct MHD_Connection *connection, void **state,
                      enum MHD_RequestTerminationCode code)
{
    struct exchange *exchange = *state;

    (void)context;
    (void)connection;
    (void)code;
    if (exchange) {
        free(exchange->body);
        free(exchange->answer.bytes);
        free(exchange);
    }
    *state = NULL;
}

static int on_io(sd_event_source *source, int fd, uint32_t events, void *context)
{
    struct fetch_server *server = context;

    (void)source;
    (void)fd;
    (void)events;
    (void)MHD_run(server->mhd);
    return 0;
}

/* A resumed connection, and one with data that TLS has read already, cause no event. */
static int on_time(sd_event_source *source, uint64_t at_us, void *context)
{
    struct fetch_server *server = context;

    (void)at_us;
    (void)MHD_run(server->mhd);
    (void)sd_event_source_set_time_relative(source, 10000);
    return sd_event_source_set_enabled(source, SD_EVENT_ONESHOT);
}

void fetch_server_start(struct fetch_server *server, sd_event *event, const char *key,
                        const char *chain)
{
    const unsigned flags = MHD_USE_EPOLL | MHD_ALLOW_SUSPEND_RESUME | (key ? MHD_USE_TLS : 0);

    server->event = event;
    server->mhd = key ? MHD_start_daemon(flags, 0, NULL, NULL, step, server,
                                         MHD_OPTION_NOTIFY_COMPLETED, completed, server,
                                         MHD_OPTION_HTTPS_MEM_KEY, key, MHD_OPTION_HTTPS_MEM_CERT,
                                         chain, MHD_OPTION_END)
                      : MHD_start_daemon(flags, 0, NULL, NULL, step, server,
                                         MHD_OPTION_NOTIFY_COMPLETED, completed, server,
                                         MHD_OPTION_END);
    assert_non_null(server->mhd);
    const union MHD_DaemonInfo *info = MHD_get_daemon_info(server->mhd, MHD_DAEMON_INFO_BIND_PORT);
    server->port = info->port;
    (void)snprintf(server->url, sizeof server->url, "%s://127.0.0.1:%u", key ? "https" : "http",
                   server->port);
    info = MHD_get_daemon_info(server->mhd, MHD_DAEMON_INFO_EPOLL_FD);
    assert_true(sd_event_add_io(event, &server->io, info->epoll_fd, EPOLLIN, on_io, server) >= 0);
    assert_true(sd_event_add_time_relative(event, &server->timer, CLOCK_MONOTONIC, 10000, 1000,
                                           on_time, server) >= 0);
}

void fetch_server_release(struct fetch_server *server)
{
    assert_non_null(server->held);
    MHD_resume_connection(server->held);
    server->held = NULL;
    (void)MHD_run(server->mhd);
}

void fetch_server_stop(struct fetch_server *server)
{
    if (server->held) {
        fetch_server_release(server);
    }
    (void)sd_event_source_disable_unref(server->io);
    (void)sd_event_source_disable_unref(server->timer);
    MHD_stop_daemon(server->mhd);
    server->mhd = NULL;
}
