/* Syslog over UDP, and to the local socket. */
#include <errno.h>
#include <netdb.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "enroll/hub/outlet/carry/syslog.h"
#include "enroll/hub/outlet/carry/syslog_text.h"

/* Receivers need not take more (RFC 5426, 3.2), and the rest of a record is cut. */
enum { DATAGRAM_MOST = 8192, SEND_S = 5 };

static struct hub__delivery open_udp(struct hub__syslog *syslog)
{
    const struct addrinfo hints = {.ai_socktype = SOCK_DGRAM, .ai_flags = AI_ADDRCONFIG};
    struct addrinfo *list = NULL;
    char port[8];
    (void)snprintf(port, sizeof port, "%u", syslog->address.port);
    const int code = getaddrinfo(syslog->address.host, port, &hints, &list);
    if (code) {
        return hub__delivery_failed(HUB__LATER, "%s: %s", syslog->address.host, gai_strerror(code));
    }
    for (const struct addrinfo *a = list; a && syslog->fd < 0; a = a->ai_next) {
        syslog->fd = socket(a->ai_family, SOCK_DGRAM | SOCK_CLOEXEC, 0);
        if (syslog->fd >= 0 && connect(syslog->fd, a->ai_addr, a->ai_addrlen)) {
            (void)close(syslog->fd);
            syslog->fd = -1;
        }
    }
    freeaddrinfo(list);
    return syslog->fd < 0
               ? hub__delivery_failed(HUB__LATER, "%s: no way to it", syslog->address.host)
               : (struct hub__delivery){.outcome = HUB__TAKEN};
}

static struct hub__delivery open_local(struct hub__syslog *syslog)
{
    struct sockaddr_un name = {.sun_family = AF_UNIX};
    (void)snprintf(name.sun_path, sizeof name.sun_path, "%s", syslog->address.path);
    syslog->fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    if (syslog->fd >= 0 && connect(syslog->fd, (const struct sockaddr *)&name, sizeof name) == 0) {
        return (struct hub__delivery){.outcome = HUB__TAKEN};
    }
    return hub__delivery_failed(HUB__LATER, "%s: %s", syslog->address.path, strerror(errno));
}

static struct hub__delivery open_socket(struct hub__syslog *syslog)
{
    /* A receiver that hangs is given up after some time. */
    const struct timeval timeout = {.tv_sec = SEND_S};
    const struct hub__delivery delivery = syslog->address.scheme == HUB__UDP ? open_udp(syslog)
                                                                             : open_local(syslog);
    if (syslog->fd >= 0) {
        (void)setsockopt(syslog->fd, SOL_SOCKET, SO_SNDTIMEO, &timeout, sizeof timeout);
    }
    return delivery;
}

static struct hub__delivery send_one(const struct hub__syslog *syslog, int64_t now_s,
                                     const struct hub__batch_event *event)
{
    char *text = hub__syslog_text(
        event, syslog->address.scheme == HUB__LOCAL ? HUB__SYSLOG_LOCAL : HUB__SYSLOG_NETWORK,
        now_s);
    if (!text) {
        return hub__delivery_failed(HUB__LATER, "no memory");
    }
    const size_t length = strlen(text);
    const ssize_t sent = send(syslog->fd, text, length < DATAGRAM_MOST ? length : DATAGRAM_MOST,
                              MSG_NOSIGNAL);
    const int error = errno;
    free(text);
    return sent < 0 ? hub__delivery_failed(HUB__LATER, "%s", strerror(error))
                    : (struct hub__delivery){.outcome = HUB__TAKEN};
}

struct hub__delivery hub__syslog_datagrams(struct hub__syslog *syslog, int64_t now_s,
                                           const struct hub__batch *batch)
{
    struct hub__delivery delivery = {.outcome = HUB__TAKEN};
    if (syslog->fd < 0) {
        delivery = open_socket(syslog);
    }
    for (size_t i = 0; delivery.outcome == HUB__TAKEN && i < batch->n; i++) {
        const struct hub__batch_event event = hub__batch_event(batch, i);
        delivery = send_one(syslog, now_s, &event);
    }
    if (delivery.outcome != HUB__TAKEN && syslog->fd >= 0) {
        (void)close(syslog->fd);
        syslog->fd = -1;
    }
    return delivery;
}
