/* One request of the API on its way to the database and back. Internal to enroll/hub/api.
 *
 * The work of a call runs in a thread. Until it is done nothing answers the exchange, so the thread
 * may read the request: web_exchange_part, _query, _body, _account and _role. Everything else of
 * the exchange belongs to the event loop. */
#ifndef HUB_API_CALL_H
#define HUB_API_CALL_H

#include "enroll/hub/api/hub_api.h"

struct hub_call;

/* The work of a route. 0 with call->json (NULL: 204); or a negative errno with a fault, which is
 * answered as a problem (call.c has the table), or what hub__call_refuse returned. */
typedef int (*hub_call_work)(struct hub_call *call, struct hub_store *store,
                             struct iso_fault *fault);

struct hub_call {
    struct hub_api *api;
    const struct web_exchange *request;
    unsigned status;    /* of the answer; 200 unless the work says another one */
    json_t *json;       /* the answer */
    const char *absent; /* the code of -ENOENT: "no-such-zone" */

    /* of call.c */
    struct web_exchange *exchange;
    hub_call_work work;
    struct web_problem refusal; /* its detail is that of the fault */
    int error;
    struct iso_fault fault;
    char *text;
};

/* Does the work of a request in a lane, and answers it. */
void hub__call(void *api, struct web_exchange *exchange, enum hub_lane lane, hub_call_work work);

/* Refuses a request with a code of its own. Returns the error that the work returns. */
int hub__call_refuse(struct hub_call *call, struct iso_fault *fault, unsigned status,
                     const char *code, const char *detail);

/* ---- what the work reads from a request ---- */

/* A text of 1 to `most` bytes; NULL after a refusal, which *error has then. */
const char *hub__call_text(struct hub_call *call, const char *member, size_t most, int *error,
                           struct iso_fault *fault);

/* Members that may be missing: *has says whether they are there. 0 or a refusal. */
int hub__call_flag(struct hub_call *call, const char *member, bool *has, bool *out,
                   struct iso_fault *fault) __attribute__((warn_unused_result));
int hub__call_number(struct hub_call *call, const char *member, int64_t most, bool *has,
                     int64_t *out, struct iso_fault *fault) __attribute__((warn_unused_result));

/* A parameter of the query that is a number from 1 to `most`, or `otherwise`. */
int hub__call_count(struct hub_call *call, const char *name, uint32_t most, uint32_t otherwise,
                    uint32_t *out, struct iso_fault *fault) __attribute__((warn_unused_result));

/* Whether a parameter of the query is there and is not "0". */
bool hub__call_asks(const struct hub_call *call, const char *name);

#endif
