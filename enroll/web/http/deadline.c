#include "enroll/web/http/deadline.h"

#include <stdlib.h>
#include <sys/socket.h>

#include "enroll/web/http/inner.h"

struct web_link {
    struct web_link *previous, *next;
    int fd;
    int64_t due_ns;
    bool is_shut;
};

int64_t web__phase_ns(enum web_phase phase)
{
    switch (phase) {
    case WEB_PHASE_FIRST:
    case WEB_PHASE_REQUEST:
        return WEB_REQUEST_S * INT64_C(1000000000);
    case WEB_PHASE_ANSWER:
        return WEB_ANSWER_S * INT64_C(1000000000);
    case WEB_PHASE_IDLE:
        return WEB_IDLE_S * INT64_C(1000000000);
    case WEB_PHASE_HANDLER:
    case WEB_PHASE_STREAM:
        break;
    }
    return INT64_MAX;
}

static void set_due(const struct web_server *server, struct web_link *link, int64_t lasts_ns)
{
    link->due_ns = lasts_ns == INT64_MAX ? INT64_MAX : server->setup.now_ns() + lasts_ns;
}

static void begin(struct web_server *server, struct MHD_Connection *connection, void **context)
{
    const union MHD_ConnectionInfo *info = MHD_get_connection_info(
        connection, MHD_CONNECTION_INFO_CONNECTION_FD);
    struct web_link *link = info ? calloc(1, sizeof *link) : NULL;

    *context = link;
    if (!link) {
        /* A connection that nobody watches could stay for ever. */
        if (info) {
            (void)shutdown(info->connect_fd, SHUT_RDWR);
        }
        return;
    }
    link->fd = info->connect_fd;
    set_due(server, link, web__phase_ns(WEB_PHASE_FIRST));
    link->next = server->links;
    if (link->next) {
        link->next->previous = link;
    } else {
        (void)sd_event_source_set_time_relative(server->deadline, WEB_DEADLINE_SWEEP_US);
        (void)sd_event_source_set_enabled(server->deadline, SD_EVENT_ON);
    }
    server->links = link;
}

static void end(struct web_server *server, struct web_link *link)
{
    if (link->previous) {
        link->previous->next = link->next;
    } else {
        server->links = link->next;
    }
    if (link->next) {
        link->next->previous = link->previous;
    }
    free(link);
}

void web__deadline_notify(void *context, struct MHD_Connection *connection, void **link,
                          enum MHD_ConnectionNotificationCode code)
{
    if (code == MHD_CONNECTION_NOTIFY_STARTED) {
        begin(context, connection, link);
    } else if (*link) {
        end(context, *link);
        *link = NULL;
    }
}

static void begin_phase(const struct web_server *server, struct MHD_Connection *connection,
                        int64_t lasts_ns)
{
    const union MHD_ConnectionInfo *info = MHD_get_connection_info(
        connection, MHD_CONNECTION_INFO_SOCKET_CONTEXT);

    if (info && info->socket_context) {
        set_due(server, info->socket_context, lasts_ns);
    }
}

void web__deadline_begin(const struct web_server *server, struct MHD_Connection *connection,
                         enum web_phase phase)
{
    begin_phase(server, connection, web__phase_ns(phase));
}

void web__deadline_intake(const struct web_server *server, struct MHD_Connection *connection,
                          uint64_t size)
{
    begin_phase(server, connection,
                web__phase_ns(WEB_PHASE_REQUEST) +
                    (int64_t)(size / WEB_INTAKE_BYTES_S) * INT64_C(1000000000));
}

void web__deadline_sweep(struct web_server *server)
{
    const int64_t now = server->setup.now_ns();

    for (struct web_link *link = server->links; link; link = link->next) {
        if (now >= link->due_ns && !link->is_shut) {
            link->is_shut = true;
            (void)shutdown(link->fd, SHUT_RDWR);
        }
    }
}
