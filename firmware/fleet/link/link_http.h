/* Requests over HTTPS, many at a time and without a thread, which an event loop of systemd drives.
 * A door uses them for what is too large for the broker: missing deltas, and snapshots. One object
 * serves all doors of an event loop.
 *
 * Only the authority of the request's file is trusted, and the name of the server is compared.
 * Redirections and proxies are not followed. */
#ifndef ISO_FIRMWARE_FLEET_LINK_LINK_HTTP_H
#define ISO_FIRMWARE_FLEET_LINK_LINK_HTTP_H

#include <stdint.h>
#include <systemd/sd-event.h>

#include "core/base/fault.h"

struct link_http;
struct link_http_request;

/* A POST. What it points to is copied. */
struct link_http_setup {
    const char *url;
    const char *ca_file; /* PEM; NULL: the request goes over plain HTTP, for tests */
    const char *type;    /* Content-Type of the body */
    const void *body;
    size_t size;
    uint64_t most_bytes; /* a longer reply is an error */
    uint32_t time_s;     /* the whole request; a server that says nothing is given up after 30 s */
    const char *folder;  /* where the reply is, as a file without a name; NULL: in memory */
};

struct link_http_reply {
    int error;              /* 0, or: -ETIMEDOUT, -EFBIG, -ECONNREFUSED, -EKEYREJECTED (the server's
                             * certificate), -EIO and others */
    const char *why;        /* one line for people; "" without an error */
    int status;             /* of HTTP; 0: there was none */
    uint32_t retry_after_s; /* what the server asks for; 0: nothing */
    int fd;                 /* the reply, from its beginning; whoever is called owns it. -1: none */
    uint64_t size;
};

typedef void link_http_done(void *context, const struct link_http_reply *reply);

/* The caller frees *out, after all requests have ended or are cancelled. -ENOMEM. */
int link_http_new(sd_event *event, struct link_http **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));
void link_http_free(struct link_http *http);

/* Starts a request. `done` is called once from the event loop, and then the request is freed.
 * -ENOMEM, -EINVAL, errors of making the file. */
int link_http_post(struct link_http *http, const struct link_http_setup *setup,
                   link_http_done *done, void *context, struct link_http_request **out,
                   struct iso_fault *fault) __attribute__((warn_unused_result));

/* Ends a request without calling `done`. May be NULL. */
void link_http_cancel(struct link_http_request *request);

#endif
