#include "firmware/fleet/link/link_http.h"

#include <curl/curl.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

enum {
    CONNECT_S = 15,
    SILENT_S = 30, /* a transfer below SLOW_BYTES a second for so long is given up */
    SLOW_BYTES = 64,
    CONNECTIONS_MAX = 64, /* at a time; further requests wait */
};

struct link_http {
    sd_event *event;
    CURLM *multi;
    sd_event_source *timer;
};

struct link_http_request {
    struct link_http *http;
    CURL *easy;
    struct curl_slist *headers;
    link_http_done *done;
    void *context;
    int fd;
    uint64_t size, most_bytes;
    int error; /* of storing the reply */
    char why[CURL_ERROR_SIZE];
};

/* ---- the end of a request ---- */

static int error_of(CURLcode code)
{
    switch (code) {
    case CURLE_OK:
        return 0;
    case CURLE_OPERATION_TIMEDOUT:
        return -ETIMEDOUT;
    case CURLE_COULDNT_CONNECT:
        return -ECONNREFUSED;
    case CURLE_COULDNT_RESOLVE_HOST:
        return -EHOSTUNREACH;
    case CURLE_FILESIZE_EXCEEDED:
        return -EFBIG;
    case CURLE_OUT_OF_MEMORY:
        return -ENOMEM;
    case CURLE_SSL_CACERT_BADFILE:
    case CURLE_PEER_FAILED_VERIFICATION:
        return -EKEYREJECTED;
    default:
        return -EIO;
    }
}

static void request_free(struct link_http_request *request)
{
    if (request->easy) {
        (void)curl_multi_remove_handle(request->http->multi, request->easy);
        curl_easy_cleanup(request->easy);
    }
    curl_slist_free_all(request->headers);
    if (request->fd >= 0) {
        (void)close(request->fd);
    }
    free(request);
}

static void finish(struct link_http_request *request, CURLcode code)
{
    struct link_http_reply reply = {.error = request->error ? request->error : error_of(code),
                                    .why = ""};
    long status = 0;
    curl_off_t retry_after = 0;

    (void)curl_easy_getinfo(request->easy, CURLINFO_RESPONSE_CODE, &status);
    (void)curl_easy_getinfo(request->easy, CURLINFO_RETRY_AFTER, &retry_after);
    reply.status = (int)status;
    reply.retry_after_s = retry_after > 0 && retry_after < UINT32_MAX ? (uint32_t)retry_after : 0;
    reply.fd = -1;
    if (reply.error == -EFBIG) {
        reply.why = "the reply is too long";
    } else if (request->error) {
        reply.why = strerror(-request->error);
    } else if (reply.error) {
        reply.why = request->why[0] ? request->why : curl_easy_strerror(code);
    } else if (lseek(request->fd, 0, SEEK_SET) == 0) {
        reply.fd = request->fd;
        reply.size = request->size;
        request->fd = -1;
    } else {
        reply.error = -errno;
        reply.why = strerror(errno);
    }
    request->done(request->context, &reply);
    request_free(request);
}

static void finish_all(struct link_http *http)
{
    CURLMsg *message;
    int left = 0;

    while ((message = curl_multi_info_read(http->multi, &left))) {
        if (message->msg == CURLMSG_DONE) {
            struct link_http_request *request = NULL;
            const CURLcode code = message->data.result;
            (void)curl_easy_getinfo(message->easy_handle, CURLINFO_PRIVATE, (char **)&request);
            finish(request, code);
        }
    }
}

/* ---- the event loop ---- */

static int on_time(sd_event_source *source, uint64_t at_us, void *context)
{
    struct link_http *http = context;
    int running = 0;

    (void)source;
    (void)at_us;
    (void)curl_multi_socket_action(http->multi, CURL_SOCKET_TIMEOUT, 0, &running);
    finish_all(http);
    return 0;
}

static int on_socket(sd_event_source *source, int fd, uint32_t revents, void *context)
{
    struct link_http *http = context;
    int running = 0;
    const int what = (revents & (EPOLLIN | EPOLLHUP | EPOLLERR) ? CURL_CSELECT_IN : 0) |
                     (revents & (EPOLLOUT | EPOLLHUP | EPOLLERR) ? CURL_CSELECT_OUT : 0);

    (void)source;
    (void)curl_multi_socket_action(http->multi, fd, what, &running);
    finish_all(http);
    return 0;
}

/* The library wants to know when a socket is ready. `kept` is what this function has assigned to
 * the socket: its source. */
static int watch_socket(CURL *easy, curl_socket_t fd, int what, void *context, void *kept)
{
    struct link_http *http = context;
    sd_event_source *source = kept;
    const uint32_t events = (what & CURL_POLL_IN ? EPOLLIN : 0U) |
                            (what & CURL_POLL_OUT ? EPOLLOUT : 0U);

    (void)easy;
    if (what == CURL_POLL_REMOVE) {
        (void)sd_event_source_disable_unref(source);
        (void)curl_multi_assign(http->multi, fd, NULL);
        return 0;
    }
    if (source) {
        return sd_event_source_set_io_events(source, events) < 0 ? -1 : 0;
    }
    if (sd_event_add_io(http->event, &source, fd, events, on_socket, http) < 0) {
        return -1;
    }
    (void)curl_multi_assign(http->multi, fd, source);
    return 0;
}

static int watch_time(CURLM *multi, long timeout_ms, void *context)
{
    struct link_http *http = context;
    uint64_t now = 0;

    (void)multi;
    if (timeout_ms < 0) {
        return sd_event_source_set_enabled(http->timer, SD_EVENT_OFF) < 0 ? -1 : 0;
    }
    (void)sd_event_now(http->event, CLOCK_MONOTONIC, &now);
    (void)sd_event_source_set_time(http->timer, now + (uint64_t)timeout_ms * 1000);
    return sd_event_source_set_enabled(http->timer, SD_EVENT_ONESHOT) < 0 ? -1 : 0;
}

int link_http_new(sd_event *event, struct link_http **out, struct iso_fault *fault)
{
    struct link_http *http = calloc(1, sizeof *http);

    if (!http || curl_global_init(CURL_GLOBAL_DEFAULT)) {
        free(http);
        return iso_fault_set(fault, -ENOMEM, "HTTPS: out of memory");
    }
    http->event = sd_event_ref(event);
    http->multi = curl_multi_init();
    const int r = sd_event_add_time(event, &http->timer, CLOCK_MONOTONIC, 0, 0, on_time, http);
    if (!http->multi || r < 0) {
        link_http_free(http);
        return iso_fault_set(fault, r < 0 ? r : -ENOMEM, "HTTPS: %s",
                             strerror(r < 0 ? -r : ENOMEM));
    }
    (void)sd_event_source_set_enabled(http->timer, SD_EVENT_OFF);
    (void)curl_multi_setopt(http->multi, CURLMOPT_SOCKETFUNCTION, watch_socket);
    (void)curl_multi_setopt(http->multi, CURLMOPT_SOCKETDATA, http);
    (void)curl_multi_setopt(http->multi, CURLMOPT_TIMERFUNCTION, watch_time);
    (void)curl_multi_setopt(http->multi, CURLMOPT_TIMERDATA, http);
    (void)curl_multi_setopt(http->multi, CURLMOPT_MAX_TOTAL_CONNECTIONS, (long)CONNECTIONS_MAX);
    *out = http;
    return 0;
}

void link_http_free(struct link_http *http)
{
    if (!http) {
        return;
    }
    if (http->multi) {
        (void)curl_multi_cleanup(http->multi);
    }
    (void)sd_event_source_disable_unref(http->timer);
    (void)sd_event_unref(http->event);
    free(http);
    curl_global_cleanup();
}

/* ---- a request ---- */

static size_t on_bytes(char *bytes, size_t one, size_t n, void *context)
{
    struct link_http_request *request = context;
    size_t done = 0;

    (void)one;
    if (n > request->most_bytes - request->size) {
        request->error = -EFBIG;
        return 0;
    }
    while (done < n) {
        const ssize_t r = write(request->fd, bytes + done, n - done);
        if (r < 0 && errno != EINTR) {
            request->error = -errno;
            return 0;
        }
        done += r > 0 ? (size_t)r : 0;
    }
    request->size += n;
    return n;
}

/* A file that has no name and ends with its last descriptor. */
static int make_file(const char *folder)
{
    const int fd = folder ? open(folder, O_TMPFILE | O_RDWR | O_CLOEXEC, 0600)
                          : memfd_create("isotherm-reply", MFD_CLOEXEC);

    return fd < 0 ? -errno : fd;
}

static CURLcode secure(CURL *easy, const char *ca_file)
{
    CURLcode r = curl_easy_setopt(easy, CURLOPT_PROTOCOLS_STR, ca_file ? "https" : "http");

    if (r || !ca_file) {
        return r;
    }
    r = curl_easy_setopt(easy, CURLOPT_CAINFO, ca_file);
    /* The trusted authorities of the system are not asked. */
    r = r ? r : curl_easy_setopt(easy, CURLOPT_CAPATH, NULL);
    r = r ? r : curl_easy_setopt(easy, CURLOPT_SSLVERSION, (long)CURL_SSLVERSION_TLSv1_2);
    r = r ? r : curl_easy_setopt(easy, CURLOPT_SSL_VERIFYPEER, 1L);
    return r ? r : curl_easy_setopt(easy, CURLOPT_SSL_VERIFYHOST, 2L);
}

static CURLcode limit(CURL *easy, const struct link_http_setup *setup)
{
    CURLcode r = curl_easy_setopt(easy, CURLOPT_TIMEOUT, (long)setup->time_s);

    r = r ? r : curl_easy_setopt(easy, CURLOPT_CONNECTTIMEOUT, (long)CONNECT_S);
    r = r ? r : curl_easy_setopt(easy, CURLOPT_LOW_SPEED_LIMIT, (long)SLOW_BYTES);
    r = r ? r : curl_easy_setopt(easy, CURLOPT_LOW_SPEED_TIME, (long)SILENT_S);
    r = r ? r : curl_easy_setopt(easy, CURLOPT_MAXFILESIZE_LARGE, (curl_off_t)setup->most_bytes);
    r = r ? r : curl_easy_setopt(easy, CURLOPT_FOLLOWLOCATION, 0L);
    r = r ? r : curl_easy_setopt(easy, CURLOPT_NOPROXY, "*");
    return r ? r : curl_easy_setopt(easy, CURLOPT_NOSIGNAL, 1L);
}

static CURLcode describe(struct link_http_request *request, const struct link_http_setup *setup)
{
    CURL *easy = request->easy;
    CURLcode r = curl_easy_setopt(easy, CURLOPT_URL, setup->url);

    r = r ? r : curl_easy_setopt(easy, CURLOPT_POSTFIELDSIZE_LARGE, (curl_off_t)setup->size);
    r = r ? r : curl_easy_setopt(easy, CURLOPT_COPYPOSTFIELDS, setup->body);
    r = r ? r : curl_easy_setopt(easy, CURLOPT_HTTPHEADER, request->headers);
    r = r ? r : curl_easy_setopt(easy, CURLOPT_WRITEFUNCTION, on_bytes);
    r = r ? r : curl_easy_setopt(easy, CURLOPT_WRITEDATA, request);
    r = r ? r : curl_easy_setopt(easy, CURLOPT_PRIVATE, request);
    r = r ? r : curl_easy_setopt(easy, CURLOPT_ERRORBUFFER, request->why);
    r = r ? r : limit(easy, setup);
    return r ? r : secure(easy, setup->ca_file);
}

static struct curl_slist *headers_of(const char *type)
{
    char line[128];

    (void)snprintf(line, sizeof line, "Content-Type: %s", type);
    struct curl_slist *type_line = curl_slist_append(NULL, line);
    /* Without this the library waits for a server's permission before it sends a long body. */
    struct curl_slist *both = type_line ? curl_slist_append(type_line, "Expect:") : NULL;
    if (!both) {
        curl_slist_free_all(type_line);
    }
    return both;
}

int link_http_post(struct link_http *http, const struct link_http_setup *setup,
                   link_http_done *done, void *context, struct link_http_request **out,
                   struct iso_fault *fault)
{
    struct link_http_request *request = calloc(1, sizeof *request);

    if (!request) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", setup->url);
    }
    request->http = http;
    request->done = done;
    request->context = context;
    request->most_bytes = setup->most_bytes;
    request->fd = make_file(setup->folder);
    if (request->fd < 0) {
        const int error = request->fd;
        free(request);
        return iso_fault_set(fault, error, "%s: %s",
                             setup->folder ? setup->folder : "a file in memory", strerror(-error));
    }
    request->headers = headers_of(setup->type);
    request->easy = curl_easy_init();
    if (!request->headers || !request->easy) {
        request_free(request);
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", setup->url);
    }
    const CURLcode r = describe(request, setup);
    if (r || curl_multi_add_handle(http->multi, request->easy)) {
        request_free(request);
        return iso_fault_set(fault, -EINVAL, "%s: %s", setup->url, curl_easy_strerror(r));
    }
    *out = request;
    return 0;
}

void link_http_cancel(struct link_http_request *request)
{
    if (request) {
        request_free(request);
    }
}
