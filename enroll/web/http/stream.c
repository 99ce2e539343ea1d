#include "enroll/web/http/stream.h"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/socket.h>

#include "enroll/web/http/answer.h"
#include "enroll/web/http/inner.h"
#include "enroll/web/http/now.h"

/* What the kernel keeps for a client that does not read. More would only make frames old. */
static const int UNSENT_MOST_BYTES = 32 << 10;
static const int SEND_BUFFER_BYTES = 64 << 10;

enum { BLOCK_BYTES = 16 << 10 };

static void drop_all(struct web_stream *stream)
{
    for (int i = 0; i < stream->n; i++) {
        web_chunk_unref(stream->queue[i]);
    }
    stream->n = 0;
    stream->sent = 0;
}

static void drop_at(struct web_stream *stream, int index)
{
    web_chunk_unref(stream->queue[index]);
    stream->n--;
    memmove(&stream->queue[index], &stream->queue[index + 1],
            (size_t)(stream->n - index) * sizeof *stream->queue);
}

void web__stream_wake(struct web_stream *stream)
{
    if (stream->suspended) {
        stream->suspended = false;
        web__server_resume(stream->server, stream->connection);
    }
}

void web__stream_abort(struct web_stream *stream)
{
    stream->gone = true;
    drop_all(stream);
    (void)sd_event_source_set_enabled(stream->hangup, SD_EVENT_OFF);
    (void)shutdown(stream->fd, SHUT_RDWR);
    web__stream_wake(stream);
}

/* libmicrohttpd does not look at a connection while it is suspended. */
static int on_hangup(sd_event_source *source, int fd, uint32_t events, void *context)
{
    (void)source;
    (void)fd;
    (void)events;
    web__stream_abort(context);
    return 0;
}

/* Hands bytes to libmicrohttpd. */
static ssize_t read_queue(void *context, uint64_t position, char *to, size_t most)
{
    struct web_stream *stream = context;
    size_t n = 0;

    (void)position;
    if (stream->gone) {
        return MHD_CONTENT_READER_END_WITH_ERROR;
    }
    while (stream->n > 0 && n < most) {
        const struct web_chunk *chunk = stream->queue[0];
        const size_t left = chunk->size - stream->sent;
        const size_t part = left < most - n ? left : most - n;
        memcpy(to + n, chunk->bytes + stream->sent, part);
        n += part;
        stream->sent += part;
        if (stream->sent == chunk->size) {
            drop_at(stream, 0);
            stream->sent = 0;
        }
    }
    if (n > 0) {
        return (ssize_t)n;
    }
    if (stream->ending) {
        return MHD_CONTENT_READER_END_OF_STREAM;
    }
    stream->suspended = true;
    MHD_suspend_connection(stream->connection);
    return 0;
}

static struct MHD_Response *make_response(struct web_stream *stream, const char *content_type)
{
    struct MHD_Response *response = MHD_create_response_from_callback(MHD_SIZE_UNKNOWN, BLOCK_BYTES,
                                                                      read_queue, stream, NULL);

    if (response && (!web__answer_add_headers(response, content_type, "no-store") ||
                     MHD_add_response_header(response, "Connection", "close") != MHD_YES)) {
        MHD_destroy_response(response);
        return NULL;
    }
    return response;
}

static void limit_buffers(int fd)
{
    (void)setsockopt(fd, SOL_SOCKET, SO_SNDBUF, &SEND_BUFFER_BYTES, sizeof SEND_BUFFER_BYTES);
    (void)setsockopt(fd, IPPROTO_TCP, TCP_NOTSENT_LOWAT, &UNSENT_MOST_BYTES,
                     sizeof UNSENT_MOST_BYTES);
}

static void list(struct web_stream *stream)
{
    struct web_server *server = stream->server;

    stream->next = server->streams;
    if (stream->next) {
        stream->next->previous = stream;
    }
    server->streams = stream;
    if (server->n_streams++ == 0) {
        (void)sd_event_source_set_time_relative(server->sweep, WEB_SWEEP_S * UINT64_C(1000000));
        (void)sd_event_source_set_enabled(server->sweep, SD_EVENT_ON);
    }
}

static void unlist(struct web_stream *stream)
{
    if (stream->previous) {
        stream->previous->next = stream->next;
    } else {
        stream->server->streams = stream->next;
    }
    if (stream->next) {
        stream->next->previous = stream->previous;
    }
    stream->server->n_streams--;
}

struct web_stream *web__stream_new(struct web_exchange *exchange, const char *content_type,
                                   struct MHD_Response **response)
{
    const union MHD_ConnectionInfo *info = MHD_get_connection_info(
        exchange->connection, MHD_CONNECTION_INFO_CONNECTION_FD);
    struct web_stream *stream = info ? calloc(1, sizeof *stream) : NULL;

    if (!stream) {
        return NULL;
    }
    stream->server = exchange->server;
    stream->connection = exchange->connection;
    stream->session = exchange->session;
    stream->fd = info->connect_fd;
    *response = make_response(stream, content_type);
    if (!*response || sd_event_add_io(stream->server->setup.event, &stream->hangup, stream->fd,
                                      EPOLLRDHUP, on_hangup, stream) < 0) {
        if (*response) {
            MHD_destroy_response(*response);
        }
        free(stream);
        return NULL;
    }
    limit_buffers(stream->fd);
    /* A stream without data is not idle. */
    (void)MHD_set_connection_option(stream->connection, MHD_CONNECTION_OPTION_TIMEOUT, 0U);
    list(stream);
    return stream;
}

void web__stream_closed(struct web_stream *stream)
{
    unlist(stream);
    sd_event_source_disable_unref(stream->hangup);
    stream->hangup = NULL;
    stream->gone = true;
    drop_all(stream);
    stream->on_closed(stream->context, stream);
    drop_all(stream);
    free(stream);
}

void web_stream_send(struct web_stream *stream, struct web_chunk *chunk)
{
    if (stream->ending || stream->gone || chunk->size == 0) {
        return;
    }
    if (stream->kind == WEB_STREAM_EVENTS && stream->n == WEB_STREAM_EVENTS_MOST) {
        web__stream_abort(stream);
        return;
    }
    if (stream->kind == WEB_STREAM_FRAMES && stream->n == WEB_STREAM_FRAMES_MOST) {
        drop_at(stream, stream->sent > 0 ? 1 : 0);
        stream->dropped++;
    }
    stream->queue[stream->n++] = web_chunk_ref(chunk);
    web__stream_wake(stream);
}

uint64_t web_stream_dropped(const struct web_stream *stream)
{
    return stream->dropped;
}

void web_stream_end(struct web_stream *stream)
{
    stream->ending = true;
    web__stream_wake(stream);
}

void web_server_end_stale_streams(struct web_server *server)
{
    const int64_t now = web_now_ns();

    for (struct web_stream *stream = server->streams; stream; stream = stream->next) {
        if (stream->session == 0 ||
            web_session_goes_on(server->setup.sessions, stream->session, now)) {
            continue;
        }
        if (stream->stale) {
            /* Its client has not taken the end. */
            web__stream_abort(stream);
        } else {
            stream->stale = true;
            drop_all(stream);
            web_stream_end(stream);
        }
    }
}
