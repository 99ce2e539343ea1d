/* Syslog over TLS and TCP. libcurl makes the connection and nothing else. */
#include <errno.h>
#include <linux/sockios.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <time.h>

#include "enroll/hub/outlet/carry/syslog.h"
#include "enroll/hub/outlet/carry/syslog_text.h"

enum { ACKNOWLEDGED_MS = 5 }; /* between two looks whether everything is acknowledged */

static int64_t clock_ms(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000 + now.tv_nsec / 1000000;
}

static struct hub__delivery connect_now(struct hub__syslog *syslog, struct hub__transfer *transfer)
{
    char url[320];
    const struct hub__address *a = &syslog->address;
    const bool v6 = strchr(a->host, ':');
    (void)snprintf(url, sizeof url, "%s://%s%s%s:%u/", a->scheme == HUB__TLS ? "https" : "http",
                   v6 ? "[" : "", a->host, v6 ? "]" : "", a->port);
    hub__transfer_prepare(transfer, url);
    (void)curl_easy_setopt(transfer->easy, CURLOPT_CONNECT_ONLY, 1L);
    (void)curl_easy_setopt(transfer->easy, CURLOPT_FRESH_CONNECT, 1L);
    (void)curl_easy_setopt(transfer->easy, CURLOPT_PROXY, "");
    (void)curl_easy_setopt(transfer->easy, CURLOPT_SSL_ENABLE_ALPN, 0L);
    const struct hub__delivery delivery = hub__transfer_run(transfer);
    syslog->connected = delivery.outcome == HUB__TAKEN;
    return delivery;
}

/* Whether the receiver has closed the connection. What it says is ignored. */
static bool is_closed(struct hub__transfer *transfer)
{
    char bytes[512];
    size_t n = 0;
    CURLcode code;
    do {
        code = curl_easy_recv(transfer->easy, bytes, sizeof bytes, &n);
    } while (code == CURLE_OK && n > 0);
    return code != CURLE_AGAIN;
}

/* Waits for an event of the connection, the end, or the time. False: it has to end. */
static bool wait_for(const struct hub__transfer *transfer, curl_socket_t fd, short events, int ms)
{
    struct pollfd fds[] = {{.fd = transfer->stop_fd, .events = POLLIN},
                           {.fd = fd, .events = events}};
    (void)poll(fds, 2, ms);
    return !fds[0].revents;
}

static curl_socket_t socket_of(const struct hub__transfer *transfer)
{
    curl_socket_t fd = CURL_SOCKET_BAD;
    (void)curl_easy_getinfo(transfer->easy, CURLINFO_ACTIVESOCKET, &fd);
    return fd;
}

static struct hub__delivery send_all(struct hub__transfer *transfer, const char *bytes, size_t size,
                                     int64_t until_ms)
{
    const curl_socket_t fd = socket_of(transfer);
    for (size_t done = 0; done < size;) {
        size_t n = 0;
        const CURLcode code = curl_easy_send(transfer->easy, bytes + done, size - done, &n);
        const int64_t left_ms = until_ms - clock_ms();
        done += n;
        if (code && code != CURLE_AGAIN) {
            return hub__delivery_failed(HUB__LATER, "%s", curl_easy_strerror(code));
        }
        if (left_ms <= 0) {
            return hub__delivery_failed(HUB__LATER, "the receiver takes no more bytes");
        }
        if (code == CURLE_AGAIN && !wait_for(transfer, fd, POLLOUT, (int)left_ms)) {
            return hub__delivery_failed(HUB__ENDED, "it was given up");
        }
    }
    return (struct hub__delivery){.outcome = HUB__TAKEN};
}

/* Waits until the receiver's system has acknowledged everything. */
static struct hub__delivery wait_acknowledged(struct hub__transfer *transfer, int64_t until_ms)
{
    const curl_socket_t fd = socket_of(transfer);
    int waiting = 0;
    bool closed = is_closed(transfer);
    while (!closed && ioctl(fd, SIOCOUTQ, &waiting) == 0 && waiting > 0) {
        if (clock_ms() >= until_ms) {
            return hub__delivery_failed(HUB__LATER, "the receiver does not acknowledge");
        }
        if (!wait_for(transfer, -1, 0, ACKNOWLEDGED_MS)) {
            return hub__delivery_failed(HUB__ENDED, "it was given up");
        }
        closed = is_closed(transfer);
    }
    /* A connection that was reset has nothing left to acknowledge, so it is asked last. */
    return closed || is_closed(transfer)
               ? hub__delivery_failed(HUB__LATER, "the receiver has closed the connection")
               : (struct hub__delivery){.outcome = HUB__TAKEN};
}

/* All messages of a batch, each behind its length. NULL: no memory. */
static char *make_frames(const struct hub__batch *batch, int64_t now_s, size_t *size)
{
    char *frames = NULL;
    FILE *out = open_memstream(&frames, size);
    bool whole = out;
    for (size_t i = 0; whole && i < batch->n; i++) {
        const struct hub__batch_event event = hub__batch_event(batch, i);
        char *text = hub__syslog_text(&event, HUB__SYSLOG_NETWORK, now_s);
        whole = text && fprintf(out, "%zu %s", strlen(text), text) > 0;
        free(text);
    }
    if (out && fclose(out)) {
        whole = false;
    }
    if (!whole) {
        free(frames);
        return NULL;
    }
    return frames;
}

struct hub__delivery hub__syslog_stream(struct hub__syslog *syslog, struct hub__transfer *transfer,
                                        int64_t now_s, const struct hub__batch *batch)
{
    struct hub__delivery delivery = {.outcome = HUB__TAKEN};
    size_t size = 0;
    char *frames = make_frames(batch, now_s, &size);
    if (!frames) {
        return hub__delivery_failed(HUB__LATER, "no memory");
    }
    if (!syslog->connected || is_closed(transfer)) {
        delivery = connect_now(syslog, transfer);
    }
    const int64_t until_ms = clock_ms() + HUB__ANSWER_MS;
    if (delivery.outcome == HUB__TAKEN) {
        delivery = send_all(transfer, frames, size, until_ms);
    }
    if (delivery.outcome == HUB__TAKEN) {
        delivery = wait_acknowledged(transfer, until_ms);
    }
    /* After a failure nobody knows where in a message the receiver is. */
    syslog->connected = syslog->connected && delivery.outcome == HUB__TAKEN;
    free(frames);
    return delivery;
}
