/* The table of the API: which function answers which request, and who may make it. */
#ifndef WEB_HTTP_ROUTE_H
#define WEB_HTTP_ROUTE_H

#include "enroll/web/account/role.h"
#include "enroll/web/http/exchange.h"

struct web_route {
    const char *method;  /* "GET", "POST", "PUT", "PATCH", "DELETE" */
    const char *path;    /* below /api/v1; one part of it may be "{name}" */
    enum web_role least; /* who may ask; WEB_ROLE_NONE: without a login, too */
    /* `context` is that of the server. */
    void (*handle)(void *context, struct web_exchange *exchange);
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
