#include "tests/enroll/web/rigs/https.h"

#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

enum { PATIENCE_S = 10 };

void https_pump(sd_event *event, int fd)
{
    if (!event) {
        struct pollfd alone = {.fd = fd, .events = POLLIN};
        (void)poll(&alone, 1, 20);
        return;
    }
    struct pollfd fds[2] = {{.fd = sd_event_get_fd(event), .events = POLLIN},
                            {.fd = fd, .events = POLLIN}};

    /* The loop must be prepared before its descriptor says whether it has something to do. */
    int r = sd_event_prepare(event);
    if (r == 0) {
        (void)poll(fds, fd < 0 ? 1 : 2, 20);
        r = sd_event_wait(event, 0);
    }
    if (r > 0) {
        r = sd_event_dispatch(event);
    }
    assert_true(r >= 0);
}

static time_t deadline(void)
{
    return time(NULL) + PATIENCE_S;
}

static int connect_to(int port, bool small_buffer)
{
    const struct sockaddr_in address = {.sin_family = AF_INET,
                                        .sin_port = htons((uint16_t)port),
                                        .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
    const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0), bytes = 4096;

    assert_true(fd >= 0);
    if (small_buffer) {
        assert_int_equal(setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &bytes, sizeof bytes), 0);
    }
    assert_int_equal(connect(fd, (const struct sockaddr *)&address, sizeof address), 0);
    assert_int_equal(fcntl(fd, F_SETFL, O_NONBLOCK), 0);
    return fd;
}

int https_open(struct https *client, sd_event *event, int port, const char *priorities,
               bool small_buffer)
{
    const time_t end = deadline();
    int r;

    *client = (struct https){.event = event, .fd = connect_to(port, small_buffer)};
    assert_int_equal(gnutls_certificate_allocate_credentials(&client->credentials), 0);
    assert_int_equal(gnutls_init(&client->tls, GNUTLS_CLIENT | GNUTLS_NONBLOCK | GNUTLS_NO_SIGNAL),
                     0);
    assert_int_equal(gnutls_priority_set_direct(client->tls, priorities, NULL), 0);
    assert_int_equal(
        gnutls_credentials_set(client->tls, GNUTLS_CRD_CERTIFICATE, client->credentials), 0);
    gnutls_transport_set_int(client->tls, client->fd);
    while ((r = gnutls_handshake(client->tls)) == GNUTLS_E_AGAIN) {
        assert_true(time(NULL) < end);
        https_pump(event, client->fd);
    }
    return r;
}

void https_close(struct https *client)
{
    (void)gnutls_bye(client->tls, GNUTLS_SHUT_WR);
    gnutls_deinit(client->tls);
    gnutls_certificate_free_credentials(client->credentials);
    assert_int_equal(close(client->fd), 0);
    free(client->bytes);
    *client = (struct https){.fd = -1};
}

void https_send(struct https *client, const char *text)
{
    const time_t end = deadline();
    size_t left = strlen(text);

    while (left > 0) {
        const ssize_t n = gnutls_record_send(client->tls, text, left);
        assert_true(time(NULL) < end);
        if (n == GNUTLS_E_AGAIN || n == GNUTLS_E_INTERRUPTED) {
            https_pump(client->event, -1);
            continue;
        }
        if (n < 0) {
            /* The server has answered and closed; what it said can still be read. */
            return;
        }
        text += n;
        left -= (size_t)n;
    }
}

void https_receive(struct https *client)
{
    char bytes[4096];
    ssize_t n;

    while (!client->ended) {
        n = gnutls_record_recv(client->tls, bytes, sizeof bytes);
        if (n == GNUTLS_E_AGAIN || n == GNUTLS_E_INTERRUPTED) {
            return;
        }
        if (n <= 0) {
            client->ended = true;
            return;
        }
        client->bytes = realloc(client->bytes, client->n + (size_t)n + 1);
        assert_non_null(client->bytes);
        memcpy(client->bytes + client->n, bytes, (size_t)n);
        client->n += (size_t)n;
        client->bytes[client->n] = '\0';
    }
}

/* Waits until the received bytes contain this text; returns the number of bytes up to its end; 0:
 * the connection has been closed before. */
static size_t wait_for_text(struct https *client, const char *text)
{
    const time_t end = deadline();
    const char *found;

    while (!(found = client->n ? memmem(client->bytes, client->n, text, strlen(text)) : NULL)) {
        assert_true(time(NULL) < end);
        https_receive(client);
        if (client->ended) {
            found = client->n ? memmem(client->bytes, client->n, text, strlen(text)) : NULL;
            break;
        }
        https_pump(client->event, client->fd);
    }
    return found ? (size_t)(found - client->bytes) + strlen(text) : 0;
}

static bool wait_for_bytes(struct https *client, size_t n)
{
    const time_t end = deadline();

    while (client->n < n && !client->ended) {
        assert_true(time(NULL) < end);
        https_receive(client);
        if (client->n < n) {
            https_pump(client->event, client->fd);
        }
    }
    return client->n >= n;
}

static void use(struct https *client, size_t n)
{
    client->n -= n;
    memmove(client->bytes, client->bytes + n, client->n);
}

void https_read_head(struct https *client, struct https_answer *answer)
{
    const size_t n = wait_for_text(client, "\r\n\r\n");

    assert_true(n > 0);
    assert_true(n < sizeof answer->head);
    *answer = (struct https_answer){0};
    memcpy(answer->head, client->bytes, n);
    use(client, n);
    assert_int_equal(sscanf(answer->head, "HTTP/1.1 %d ", &answer->status), 1);
}

void https_read(struct https *client, struct https_answer *answer)
{
    const char *length;

    https_read_head(client, answer);
    length = https_header(answer, "Content-Length");
    answer->size = length ? strtoul(length, NULL, 10) : 0;
    if (answer->status == 304 || answer->status == 204) {
        answer->size = 0;
    }
    assert_true(wait_for_bytes(client, answer->size));
    answer->body = calloc(1, answer->size + 1);
    assert_non_null(answer->body);
    if (answer->size > 0) {
        memcpy(answer->body, client->bytes, answer->size);
        use(client, answer->size);
    }
}

void https_answer_free(struct https_answer *answer)
{
    free(answer->body);
    answer->body = NULL;
}

void https_ask(struct https *client, const char *method, const char *path, const char *headers,
               const char *body, struct https_answer *answer)
{
    char *text = NULL;
    char length[64] = "";

    if (body) {
        (void)snprintf(length, sizeof length, "Content-Length: %zu\r\n", strlen(body));
    }
    assert_true(asprintf(&text, "%s %s HTTP/1.1\r\nHost: door.test\r\n%s%s\r\n%s", method, path,
                         headers, length, body ? body : "") > 0);
    https_send(client, text);
    free(text);
    https_read(client, answer);
}

const char *https_header(const struct https_answer *answer, const char *name)
{
    static char value[1024];
    const size_t n = strlen(name);

    for (const char *line = strchr(answer->head, '\n'); line; line = strchr(line, '\n')) {
        line++;
        if (strncasecmp(line, name, n) == 0 && line[n] == ':') {
            line += n + 1;
            line += strspn(line, " ");
            (void)snprintf(value, sizeof value, "%.*s", (int)strcspn(line, "\r\n"), line);
            return value;
        }
    }
    return NULL;
}

char *https_read_chunk(struct https *client, size_t *size)
{
    const size_t head = wait_for_text(client, "\r\n");
    const size_t n = head > 0 ? strtoul(client->bytes, NULL, 16) : 0;
    char *chunk;

    *size = 1;
    if (head == 0 || !wait_for_bytes(client, head + n + 2)) {
        return NULL;
    }
    *size = n;
    if (n == 0) {
        return NULL;
    }
    chunk = malloc(n + 1);
    assert_non_null(chunk);
    memcpy(chunk, client->bytes + head, n);
    chunk[n] = '\0';
    use(client, head + n + 2);
    return chunk;
}
