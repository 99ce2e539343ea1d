/* Deadlines of connections. Internal to enroll/web/http.
 *
 * The timeout of libmicrohttpd begins anew with each byte, so a client that sends a byte of its
 * request a minute would hold its connection for ever. Therefore each phase of a connection has an
 * end that no byte moves:
 *
 *   first     from the connection: TLS handshake and the line of the first request
 *   request   from the line of a request: the rest of its header, and its body
 *   intake    from the header of a request whose body an intake takes: as long as its size needs
 *   handler   the request is complete, and nothing is expected of the client: no end
 *   answer    from the moment at which the answer is ready: it is sent
 *   idle      from the end of an answer: the line of the next request
 *   stream    no end: stream.h looks after clients that do not read
 *
 * A connection that is too late is shut down, and libmicrohttpd then closes it. One thread. */
#ifndef WEB_HTTP_DEADLINE_H
#define WEB_HTTP_DEADLINE_H

#include <microhttpd.h>

#include "enroll/web/http/server.h"

enum web_phase {
    WEB_PHASE_FIRST,
    WEB_PHASE_REQUEST,
    WEB_PHASE_HANDLER,
    WEB_PHASE_ANSWER,
    WEB_PHASE_IDLE,
    WEB_PHASE_STREAM,
};

/* The time that a phase may last, in nanoseconds. INT64_MAX: without an end. */
int64_t web__phase_ns(enum web_phase phase);

/* A connection that the server watches. */
struct web_link;

/* Callback of libmicrohttpd: a connection begins or ends. `server` is a struct web_server. */
void web__deadline_notify(void *server, struct MHD_Connection *connection, void **link,
                          enum MHD_ConnectionNotificationCode code);

/* A phase of the connection begins. */
void web__deadline_begin(const struct web_server *server, struct MHD_Connection *connection,
                         enum web_phase phase);

/* The phase "intake" of the connection begins: a body of this size. */
void web__deadline_intake(const struct web_server *server, struct MHD_Connection *connection,
                          uint64_t size);

/* Shuts down the connections that are too late. */
void web__deadline_sweep(struct web_server *server);

#endif
