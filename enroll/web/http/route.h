/* The table of the API: which function answers which request, and who may make it. */
#ifndef WEB_HTTP_ROUTE_H
#define WEB_HTTP_ROUTE_H

#include <stdbool.h>
#include <stdint.h>

#include "enroll/web/account/role.h"
#include "enroll/web/http/exchange.h"

struct web_route {
    const char *method;  /* "GET", "POST", "PUT", "PATCH", "DELETE" */
    const char *path;    /* below /api/v1; one part of it may be "{name}" */
    enum web_role least; /* who may ask; WEB_ROLE_NONE: without a login, too */
    /* `context` is that of the server. */
    void (*handle)(void *context, struct web_exchange *exchange);
};

/* A body that is too large for the memory: the POST of a route whose body is bytes in place of
 * JSON. They are handed over as they come. Once all have come, the handler of the route is called,
 * with an empty object as its body. All functions get the context of the server. */
struct web_intake {
    const char *path; /* of the route */
    const char *type; /* of the body: "application/octet-stream" */
    uint64_t most;    /* bytes; a larger body is refused with 413 "too-large" */
    /* A request that has passed all checks wants to send `size` bytes, at least one. Returns false
     * after web_exchange_refuse(); then nothing of the body is read. */
    bool (*begin)(void *context, struct web_exchange *exchange, uint64_t size);
    /* The next bytes. Returns false after web_exchange_refuse(). */
    bool (*take)(void *context, struct web_exchange *exchange, const void *bytes, size_t size);
    /* The body ends before it is complete: the client has gone away, or take() has refused it. */
    void (*drop)(void *context, struct web_exchange *exchange);
};

/* What other programs ask, beside the API, without a session. The handler finds out itself who
 * asks. */
struct web_plain_route {
    const char *path; /* whole: "/fleet/v1/join"; with "/" at its end it stands for all paths below,
                       * and web_exchange_part() is the rest */
    const char *type; /* of the body: "application/octet-stream"; NULL: the handler checks it */
    void (*handle)(void *context, struct web_exchange *exchange);
    const char *methods; /* "GET, PUT"; NULL: POST alone */
    size_t body_most;    /* bytes; 0: WEB_BODY_MOST_BYTES */
};

#endif
