/* The JSON API of the hub for administrators, below /api/v1 of its HTTPS server, and the pages that
 * use it. enroll/hub/api/openapi.json describes each route; a test compares the document with the
 * table of routes. Logins, sessions and accounts are those of enroll/web/login.
 *
 * No handler waits for the database: it gives its work to a thread (worker.h), and the exchange is
 * answered when that is done. Each change is one transaction with its row in the hub's table of
 * acts, in the name of the account that asked. */
#ifndef HUB_API_HUB_API_H
#define HUB_API_HUB_API_H

#include "enroll/hub/api/worker.h"
#include "enroll/web/login/login.h"

/* The context of all handlers. */
struct hub_api {
    struct web_login login; /* the first, because its handlers have it as their context */
    struct hub_worker *worker;
    /* How a door reaches the hub, for its join address. */
    const char *host; /* a name, or an address without brackets */
    uint16_t port;
    const uint8_t *ca_digest; /* 32 bytes */
};

/* All routes; ends with a method of NULL. */
extern const struct web_route hub_api_routes[];

/* Lets the worker put on record what the accounts do. */
void hub_api_record_by_worker(struct hub_api *api);

/* The text of openapi.json: UTF-8 with a NUL at its end. */
extern const unsigned char hub_api_document[];

#endif
