/* A small HTTPS client for tests. It runs in the thread of the server: while it waits it lets the
 * event loop of the server work. Everything that fails or takes over ten seconds fails the test. */
#ifndef TESTS_ENROLL_WEB_RIGS_HTTPS_H
#define TESTS_ENROLL_WEB_RIGS_HTTPS_H

#include <gnutls/gnutls.h>
#include <stdbool.h>
#include <stddef.h>
#include <systemd/sd-event.h>

struct https {
    sd_event *event;
    int fd;
    gnutls_certificate_credentials_t credentials;
    gnutls_session_t tls;
    char *bytes; /* received and not yet used */
    size_t n;
    bool ended; /* the server has closed the connection */
};

struct https_answer {
    int status;
    char head[4096]; /* the header lines */
    char *body;      /* with a NUL after it */
    size_t size;
};

/* Lets the event loop work once: until it or the descriptor (-1: none) has something to do, at most
 * 20 ms. Without an event loop (NULL) it only waits. */
void https_pump(sd_event *event, int fd);

/* Connects to 127.0.0.1. `event` is that of the server, or NULL if this is another process. Returns
 * the error of the handshake; 0: none. With small_buffer the client accepts few bytes that it has
 * not read. */
int https_open(struct https *client, sd_event *event, int port, const char *priorities,
               bool small_buffer);

/* Closes the connection in an orderly way. */
void https_close(struct https *client);

void https_send(struct https *client, const char *text);

/* Reads an answer whose body has a length. The answer is freed with https_answer_free. */
void https_read(struct https *client, struct https_answer *answer);
/* Reads the status and the header lines alone. */
void https_read_head(struct https *client, struct https_answer *answer);
void https_answer_free(struct https_answer *answer);

/* Sends a request with lines of headers ("A: b\r\n" each) and a body (NULL: none), and reads the
 * answer. */
void https_ask(struct https *client, const char *method, const char *path, const char *headers,
               const char *body, struct https_answer *answer);

/* The value of a header of an answer in a static buffer; NULL: it has none. */
const char *https_header(const struct https_answer *answer, const char *name);

/* The next chunk of a body without a length, which the caller frees. NULL: there is none, because
 * the body has ended (*size is 0), or because the connection was closed before that (*size is 1).
 */
char *https_read_chunk(struct https *client, size_t *size);

/* Receives what has come, without waiting for more. */
void https_receive(struct https *client);

#endif
