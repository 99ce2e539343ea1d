/* The server, its exchanges and its streams. Internal to enroll/web/http.
 *
 *   exchange: checked -> handled -> answered -> queued -> completed
 *
 * libmicrohttpd may complete a request at any point, except while its connection is suspended. An
 * exchange whose request was completed before its handler has answered lives on until the answer,
 * which then goes nowhere. */
#ifndef WEB_HTTP_INNER_H
#define WEB_HTTP_INNER_H

#include <microhttpd.h>

#include "enroll/web/http/deadline.h"
#include "enroll/web/http/exchange.h"
#include "enroll/web/http/files.h"
#include "enroll/web/http/percent.h"
#include "enroll/web/http/server.h"

enum {
    WEB_HEADERS_MOST = 4, /* that a handler adds */
    WEB_URI_MOST_BYTES = 2048,
    WEB_BODY_DRAIN_BYTES = 1 << 20,  /* of a body that is too large, so many bytes are read */
    WEB_SWEEP_S = 3,                 /* between two searches for stale streams */
    WEB_DEADLINE_SWEEP_US = 1000000, /* between two searches for connections that are too late */
};

struct web_header {
    char name[32], value[192];
};

/* Why a request is refused before its handler is called. */
struct web_refusal {
    unsigned status; /* 0: it is not refused */
    const char *code, *detail;
    char allow[40]; /* the header Allow; "": none */
};

struct web_exchange {
    struct web_server *server;         /* NULL once the request has been completed */
    struct MHD_Connection *connection; /* the same */
    struct web_exchange *previous, *next;

    char method[16];
    char *uri; /* as the client sent it; later its parts, decoded */
    const char *part;
    struct web_query query;
    const struct web_route *route;       /* NULL: none */
    const struct web_plain_route *plain; /* NULL: none */
    const struct web_intake *intake;     /* that takes the body; NULL: none */
    const struct web_file *file;         /* NULL: none */
    struct web_refusal refusal;

    char account[WEB_ACCOUNT_NAME_SIZE];
    enum web_role role;
    uint64_t session;
    struct sockaddr_storage address;

    char *body;
    size_t body_size, body_room, body_received;
    json_t *json;

    struct web_header headers[WEB_HEADERS_MOST];
    size_t n_headers;

    struct MHD_Response *response; /* NULL: none yet, or it has been queued */
    unsigned status;
    struct web_stream *stream;

    bool checked, taking, handled, answered, suspended; /* taking: the intake has begun */
};

struct web_stream {
    struct web_server *server;
    struct MHD_Connection *connection;
    struct web_stream *previous, *next;
    enum web_stream_kind kind;
    void (*on_closed)(void *context, struct web_stream *stream);
    void *context;
    uint64_t session; /* 0: it needs none */
    int fd;           /* of the connection */
    sd_event_source *hangup;

    struct web_chunk *queue[WEB_STREAM_EVENTS_MOST];
    int n;
    size_t sent; /* of queue[0], so many bytes have been handed to libmicrohttpd */
    uint64_t dropped;
    bool suspended, ending, stale, gone;
};

struct web_server {
    struct web_server_setup setup;
    struct MHD_Daemon *mhd;
    sd_event_source *io, *timeout, *wake, *sweep, *deadline;
    struct web_files files;
    struct web_link *links; /* all connections */
    struct web_exchange *exchanges;
    struct web_stream *streams;
    int n_streams;
};

/* Goes on with a connection that was suspended. */
void web__server_resume(struct web_server *server, struct MHD_Connection *connection);

/* ---- exchange.c ---- */

/* A new exchange of the server for a request with this target; NULL: there is no memory. */
struct web_exchange *web__exchange_new(struct web_server *server, const char *uri);

/* The request has been completed: closes the stream, and frees the exchange, or leaves this to the
 * answer that is still to come. */
void web__exchange_completed(struct web_exchange *exchange);

/* Answers with the refusal. */
void web__exchange_refuse(struct web_exchange *exchange);

/* Answers with a response, which is taken over; NULL: there is no memory for one. */
void web__exchange_answer(struct web_exchange *exchange, unsigned status,
                          struct MHD_Response *response);

/* ---- request.c: callbacks of libmicrohttpd ---- */
void *web__request_begin(void *server, const char *uri, struct MHD_Connection *connection);
enum MHD_Result web__request_step(void *server, struct MHD_Connection *connection, const char *url,
                                  const char *method, const char *version, const char *data,
                                  size_t *size, void **exchange);
void web__request_completed(void *server, struct MHD_Connection *connection, void **exchange,
                            enum MHD_RequestTerminationCode code);

/* ---- check.c ---- */

/* Finds the route or the file of a request and checks all that does not need its body. */
void web__request_check(struct web_exchange *exchange, const char *method);

/* ---- stream.c ---- */

/* A stream on the connection of an exchange, and its response; NULL: there is no memory. */
struct web_stream *web__stream_new(struct web_exchange *exchange, const char *content_type,
                                   struct MHD_Response **response);

/* Lets libmicrohttpd go on with the connection. */
void web__stream_wake(struct web_stream *stream);

/* Ends the stream without sending what waits, and closes its connection. */
void web__stream_abort(struct web_stream *stream);

/* Calls on_closed and frees the stream. */
void web__stream_closed(struct web_stream *stream);

#endif
