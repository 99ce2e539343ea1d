/* The web server: TLS by GnuTLS and HTTP by libmicrohttpd, on the event loop of the program, in one
 * thread. It answers
 *
 *   /api/v1/...   by the table of routes. The server has checked before a handler is called: the
 *                 session and its role (401 "login-required", 403 "not-allowed"), that the account
 *                 does not ask too much at one time (503 "busy"), the origin of the
 *                 request (403 "other-origin"), the type and size of the body (415, 413), and that
 *                 it is a JSON object (400 "invalid-json"). 404 "no-such-path" and 405
 *                 "no-such-method" otherwise. A body that an intake takes has to say its size
 *                 before (411 "no-length") and to be of the type of the intake (415 "other-type")
 *   plain paths   by the table of plain routes: POST, or the methods of the route. The server has
 *                 checked the type (415) and the size (413) of the body. The handler gets the body
 *                 as bytes
 *   other paths   files of the folder of pages: GET and HEAD, with an ETag. It lists the folder
 *                 when it starts and serves nothing else; "/" is index.html
 *
 * Every answer has the headers Content-Security-Policy (nothing from elsewhere, nothing inline),
 * X-Content-Type-Options, Referrer-Policy, Cross-Origin-Opener-Policy,
 * Cross-Origin-Resource-Policy and Strict-Transport-Security; answers of the API are not cached.
 * Only what is no HTTP request, or has headers of more than some kB, is answered by libmicrohttpd
 * itself, without these headers.
 *
 * A client that is too slow with its request, or takes too long to receive an answer, is
 * disconnected; streams live on. A client that is gone is noticed at once if it closes its
 * connection, and after half a minute if it has lost its power or its network. */
#ifndef WEB_HTTP_SERVER_H
#define WEB_HTTP_SERVER_H

#include <systemd/sd-event.h>

#include "core/base/fault.h"
#include "enroll/web/http/route.h"
#include "enroll/web/session/session.h"
#include "enroll/web/tls/certificate.h"

enum {
    WEB_BODY_MOST_BYTES = 64 << 10,
    WEB_CONNECTIONS_MOST = 128,
    /* A browser opens six, and several people may share an address. */
    WEB_CONNECTIONS_OF_ADDRESS = 64,
    /* Of one account at the same time, streams not counted: two browsers with six connections. All
     * accounts share the calls that the daemon answers (enroll/web/daemon/daemon.h), and one that
     * asks without end would keep the others waiting. */
    WEB_REQUESTS_OF_ACCOUNT = 12,
    WEB_IDLE_S = 60, /* a connection without a request is closed; streams are not */
    /* The phases of a connection have an end, however slowly bytes come (deadline.h): the handshake
     * with the line of the first request, and the rest of a request; and an answer that is sent. */
    WEB_REQUEST_S = 20,
    WEB_ANSWER_S = 180,
    WEB_INTAKE_BYTES_S = 64 << 10, /* a body that an intake takes may come as slowly as this */
};

struct web_server;

struct web_server_setup {
    sd_event *event;
    int listen_fd; /* a listening TCP socket, which the server takes over */
    const struct web_certificate *certificate;
    const char *pages; /* the folder; NULL: there are none */
    struct web_sessions *sessions;
    const struct web_route *routes;      /* ends with a method of NULL */
    const struct web_plain_route *plain; /* ends with a path of NULL; NULL: there are none */
    const struct web_intake *intakes;    /* the same */
    void *context;                       /* of the handlers */
    int64_t (*now_ns)(void);             /* the clock of the deadlines; NULL: web_now_ns of now.h */
};

/* Starts to answer. All that `setup` points to has to live longer than the server. A negative errno
 * with a fault. */
int web_server_new(const struct web_server_setup *setup, struct web_server **out,
                   struct iso_fault *fault) __attribute__((warn_unused_result));

/* The number of streams that are open. */
int web_server_streams(const struct web_server *server);

/* Closes all streams that belong to a session which does not go on. Called after a logout, and by
 * the server every few seconds. */
void web_server_end_stale_streams(struct web_server *server);

/* Closes all connections and streams; each stream's on_closed is called. An exchange that has not
 * been answered stays valid; its answer goes nowhere. Not called by a handler. NULL is accepted. */
void web_server_free(struct web_server *server);

#endif
