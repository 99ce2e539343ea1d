#include "enroll/web/daemon/outline.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "core/base/bytes.h"
#include "firmware/contract/contract.h"
#include "firmware/contract/stream_record.h"

struct web_outline {
    sd_event *event;
    struct web_daemon *daemon;
    struct web_daemon_listener listener;
    sd_event_source *records; /* the stream of the daemon; NULL: none */
    bool is_opening;
    struct web_stream_set viewers;
};

struct web_chunk *web_record_chunk(const uint8_t *bytes, size_t size)
{
    struct web_chunk *chunk = web_chunk_new(4 + size);
    if (chunk) {
        memcpy(iso_put_u32(chunk->bytes, (uint32_t)size), bytes, size);
    }
    return chunk;
}

static void close_records(struct web_outline *outline)
{
    outline->records = sd_event_source_disable_unref(outline->records);
}

/* Sends all records that wait to everybody who watches. A record that is not valid is dropped. */
static int on_records(sd_event_source *source, int fd, uint32_t events, void *context)
{
    struct web_outline *outline = context;
    struct iso_outline_record record;
    uint8_t bytes[ISO_OUTLINE_BYTES + 1];
    (void)source;
    (void)events;
    for (;;) {
        const ssize_t size = recv(fd, bytes, sizeof bytes, MSG_DONTWAIT);
        if (size == 0 || (size < 0 && errno != EAGAIN && errno != EINTR)) {
            close_records(outline);
            return 0;
        }
        if (size < 0 && errno == EAGAIN) {
            return 0;
        }
        if (size > 0 && iso_outline_record_read(bytes, (size_t)size, &record) == 0) {
            struct web_chunk *chunk = web_record_chunk(bytes, (size_t)size);
            if (chunk) {
                web_stream_set_send(&outline->viewers, WEB_ROLE_OBSERVER, chunk);
                web_chunk_unref(chunk);
            }
        }
    }
}

static void on_opened(void *context, sd_bus_message *reply, const sd_bus_error *error)
{
    struct web_outline *outline = context;
    int fd = -1;
    outline->is_opening = false;
    if (error || outline->viewers.n == 0 || sd_bus_message_read(reply, "h", &fd) < 0) {
        return;
    }
    /* The descriptor of the reply is closed with the reply. */
    fd = fcntl(fd, F_DUPFD_CLOEXEC, 0);
    if (fd >= 0 &&
        sd_event_add_io(outline->event, &outline->records, fd, EPOLLIN, on_records, outline) < 0) {
        (void)close(fd);
    } else if (fd >= 0) {
        (void)sd_event_source_set_io_fd_own(outline->records, 1);
    }
}

/* Opens the stream of the daemon if it is needed and not open. */
static void open_records(struct web_outline *outline)
{
    if (outline->records || outline->is_opening || outline->viewers.n == 0 ||
        !web_daemon_is_there(outline->daemon)) {
        return;
    }
    sd_bus_message *call = web_daemon_message(outline->daemon, ISO_CONTRACT_WATCH);
    if (call && sd_bus_message_append(call, "s", ISO_CONTRACT_WATCH_OUTLINE) < 0) {
        call = sd_bus_message_unref(call);
    }
    outline->is_opening = true;
    web_daemon_send(outline->daemon, call, 0, on_opened, outline);
}

static void on_status(void *context, const json_t *status)
{
    struct web_outline *outline = context;
    if (!status) {
        close_records(outline);
    }
    open_records(outline);
}

static void on_viewer_gone(void *context, struct web_stream *stream)
{
    struct web_outline *outline = context;
    web_stream_set_remove(&outline->viewers, stream);
    if (outline->viewers.n == 0) {
        close_records(outline);
    }
}

void web_outline_open(struct web_outline *outline, struct web_exchange *exchange)
{
    if (web_stream_set_open(&outline->viewers, exchange, "application/octet-stream",
                            WEB_STREAM_FRAMES, on_viewer_gone, outline)) {
        open_records(outline);
    }
}

int web_outline_new(sd_event *event, struct web_daemon *daemon, struct web_outline **out)
{
    struct web_outline *outline = calloc(1, sizeof *outline);
    if (!outline) {
        return -ENOMEM;
    }
    outline->event = sd_event_ref(event);
    outline->daemon = daemon;
    outline->listener = (struct web_daemon_listener){.on_status = on_status, .context = outline};
    web_daemon_listen(daemon, &outline->listener);
    *out = outline;
    return 0;
}

void web_outline_free(struct web_outline *outline)
{
    if (outline) {
        web_daemon_unlisten(outline->daemon, &outline->listener);
        close_records(outline);
        sd_event_unref(outline->event);
        free(outline);
    }
}
