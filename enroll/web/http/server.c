#include "enroll/web/http/server.h"

#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "enroll/web/http/inner.h"
#include "enroll/web/http/now.h"

/* TLS 1.2 and later, forward secrecy, authenticated ciphers. */
static const char priorities[] = "SECURE128:-VERS-ALL:+VERS-TLS1.3:+VERS-TLS1.2:-KX-ALL:"
                                 "+ECDHE-ECDSA:+ECDHE-RSA:-MAC-ALL:+AEAD:%SERVER_PRECEDENCE";

/* Of a connection: a request with its headers, and what is sent. */
static const size_t CONNECTION_MEMORY_BYTES = 32 << 10;

/* ---- the event loop ---- */

/* Lets libmicrohttpd work, and asks it when it wants to work next without an event. */
static void work(struct web_server *server)
{
    MHD_UNSIGNED_LONG_LONG wait_ms = 0;

    (void)MHD_run(server->mhd);
    if (MHD_get_timeout(server->mhd, &wait_ms) != MHD_YES) {
        (void)sd_event_source_set_enabled(server->timeout, SD_EVENT_OFF);
        return;
    }
    (void)sd_event_source_set_time_relative(server->timeout, wait_ms * 1000);
    (void)sd_event_source_set_enabled(server->timeout, SD_EVENT_ONESHOT);
}

/* MHD_resume_connection() does not wake the event loop of the program, so this does. */
void web__server_resume(struct web_server *server, struct MHD_Connection *connection)
{
    MHD_resume_connection(connection);
    (void)sd_event_source_set_enabled(server->wake, SD_EVENT_ONESHOT);
}

static int on_wake(sd_event_source *source, void *context)
{
    (void)source;
    work(context);
    return 0;
}

static int on_io(sd_event_source *source, int fd, uint32_t events, void *context)
{
    (void)source;
    (void)fd;
    (void)events;
    work(context);
    return 0;
}

static int on_timeout(sd_event_source *source, uint64_t usec, void *context)
{
    (void)source;
    (void)usec;
    work(context);
    return 0;
}

static int on_sweep(sd_event_source *source, uint64_t usec, void *context)
{
    struct web_server *server = context;

    (void)usec;
    web_server_end_stale_streams(server);
    if (server->n_streams == 0) {
        return sd_event_source_set_enabled(source, SD_EVENT_OFF);
    }
    return sd_event_source_set_time_relative(source, WEB_SWEEP_S * UINT64_C(1000000));
}

static int on_deadline(sd_event_source *source, uint64_t usec, void *context)
{
    struct web_server *server = context;

    (void)usec;
    web__deadline_sweep(server);
    if (!server->links) {
        return sd_event_source_set_enabled(source, SD_EVENT_OFF);
    }
    return sd_event_source_set_time_relative(source, WEB_DEADLINE_SWEEP_US);
}

static int add_sources(struct web_server *server)
{
    const union MHD_DaemonInfo *info = MHD_get_daemon_info(server->mhd, MHD_DAEMON_INFO_EPOLL_FD);
    sd_event *event = server->setup.event;
    int r = info ? 0 : -ENOTSUP;

    r = r < 0 ? r : sd_event_add_io(event, &server->io, info->epoll_fd, EPOLLIN, on_io, server);
    r = r < 0 ? r
              : sd_event_add_time_relative(event, &server->timeout, CLOCK_MONOTONIC, 0, 1000,
                                           on_timeout, server);
    r = r < 0 ? r : sd_event_add_defer(event, &server->wake, on_wake, server);
    r = r < 0 ? r
              : sd_event_add_time_relative(event, &server->sweep, CLOCK_MONOTONIC, 0, 100000,
                                           on_sweep, server);
    r = r < 0 ? r
              : sd_event_add_time_relative(event, &server->deadline, CLOCK_MONOTONIC, 0, 100000,
                                           on_deadline, server);
    r = r < 0 ? r : sd_event_source_set_enabled(server->deadline, SD_EVENT_OFF);
    return r < 0 ? r : sd_event_source_set_enabled(server->sweep, SD_EVENT_OFF);
}

/* ---- begin and end ---- */

/* check.c decodes; libmicrohttpd would decode "%00" and cut the path. */
static size_t decode_nothing(void *context, struct MHD_Connection *connection, char *text)
{
    (void)context;
    (void)connection;
    return strlen(text);
}

/* Accepted connections inherit these: a client that has lost its power or network is noticed. */
static void set_keepalive(int fd)
{
    static const struct {
        int level, name, value;
    } options[] = {
        {SOL_SOCKET, SO_KEEPALIVE, 1},          {IPPROTO_TCP, TCP_KEEPIDLE, 10},
        {IPPROTO_TCP, TCP_KEEPINTVL, 5},        {IPPROTO_TCP, TCP_KEEPCNT, 3},
        {IPPROTO_TCP, TCP_USER_TIMEOUT, 30000},
    };

    for (size_t i = 0; i < sizeof options / sizeof *options; i++) {
        (void)setsockopt(fd, options[i].level, options[i].name, &options[i].value,
                         sizeof options[i].value);
    }
}

static struct MHD_Daemon *start(struct web_server *server)
{
    const struct web_server_setup *setup = &server->setup;

    return MHD_start_daemon(
        MHD_USE_EPOLL | MHD_USE_TLS | MHD_ALLOW_SUSPEND_RESUME, 0, NULL, NULL, web__request_step,
        server, MHD_OPTION_LISTEN_SOCKET, setup->listen_fd, MHD_OPTION_HTTPS_MEM_KEY,
        setup->certificate->key, MHD_OPTION_HTTPS_MEM_CERT, setup->certificate->chain,
        MHD_OPTION_HTTPS_PRIORITIES, priorities, MHD_OPTION_STRICT_FOR_CLIENT, 1,
        MHD_OPTION_SIGPIPE_HANDLED_BY_APP, 1, MHD_OPTION_CONNECTION_MEMORY_LIMIT,
        CONNECTION_MEMORY_BYTES, MHD_OPTION_CONNECTION_LIMIT, (unsigned)WEB_CONNECTIONS_MOST,
        MHD_OPTION_PER_IP_CONNECTION_LIMIT, (unsigned)WEB_CONNECTIONS_OF_ADDRESS,
        MHD_OPTION_CONNECTION_TIMEOUT, (unsigned)WEB_IDLE_S, MHD_OPTION_URI_LOG_CALLBACK,
        web__request_begin, server, MHD_OPTION_UNESCAPE_CALLBACK, decode_nothing, NULL,
        MHD_OPTION_NOTIFY_COMPLETED, web__request_completed, server, MHD_OPTION_NOTIFY_CONNECTION,
        web__deadline_notify, server, MHD_OPTION_END);
}

/* Whether libmicrohttpd closes the socket when it fails depends on where it fails. */
static void close_listener(int fd)
{
    if (fcntl(fd, F_GETFD) >= 0) {
        (void)close(fd);
    }
}

int web_server_new(const struct web_server_setup *setup, struct web_server **out,
                   struct iso_fault *fault)
{
    struct web_server *server = calloc(1, sizeof *server);
    int r = server ? 0 : iso_fault_set(fault, -ENOMEM, "out of memory for the web server");

    if (r == 0) {
        server->setup = *setup;
        server->setup.now_ns = setup->now_ns ? setup->now_ns : web_now_ns;
        r = setup->pages ? web__files_read(&server->files, setup->pages, fault) : 0;
    }
    if (r == 0) {
        set_keepalive(setup->listen_fd);
        server->mhd = start(server);
        if (!server->mhd) {
            r = iso_fault_set(fault, -EIO, "the web server does not start with this certificate");
        }
    }
    if (r < 0) {
        close_listener(setup->listen_fd);
        web_server_free(server);
        return r;
    }
    r = add_sources(server);
    if (r < 0) {
        web_server_free(server);
        return iso_fault_set(fault, r, "the event loop of the web server: %s", strerror(-r));
    }
    *out = server;
    return 0;
}

int web_server_streams(const struct web_server *server)
{
    return server->n_streams;
}

void web_server_free(struct web_server *server)
{
    if (!server) {
        return;
    }
    /* MHD_stop_daemon() closes the descriptor that the loop watches. */
    sd_event_source_disable_unref(server->io);
    sd_event_source_disable_unref(server->timeout);
    /* MHD_stop_daemon() ends the program if a connection is still suspended. */
    for (struct web_stream *stream = server->streams; stream; stream = stream->next) {
        web__stream_wake(stream);
    }
    for (struct web_exchange *exchange = server->exchanges; exchange; exchange = exchange->next) {
        if (exchange->suspended) {
            exchange->suspended = false;
            MHD_resume_connection(exchange->connection);
        }
    }
    if (server->mhd) {
        MHD_stop_daemon(server->mhd);
    }
    web__files_free(&server->files);
    sd_event_source_disable_unref(server->wake);
    sd_event_source_disable_unref(server->sweep);
    sd_event_source_disable_unref(server->deadline);
    free(server);
}
