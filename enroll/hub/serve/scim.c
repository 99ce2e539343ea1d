/* SCIM over HTTPS: who may ask, and the way to the threads that have the database. */
#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <systemd/sd-daemon.h>

#include "enroll/hub/directory/hub_directory.h"
#include "enroll/hub/serve/service.h"
#include "enroll/web/http/now.h"

enum { MEND_S = 10, HEADER_SIZE = 64 };

/* A request that waits for the database. */
struct asking {
    struct hub_service *service;
    struct web_exchange *exchange;
    struct hub_scim_request request;
    struct hub_scim_reply reply;
    char base[HUB_API_HOST_SIZE + 48], if_match[HEADER_SIZE], if_none_match[HEADER_SIZE];
};

/* ---- tokens ---- */

static bool is_known(const struct hub_scim_gate *gate, const uint8_t *digest)
{
    for (int i = 0; i < HUB_SCIM_KNOWN; i++) {
        if (sodium_memcmp(gate->known[i], digest, HUB_SCIM_DIGEST_BYTES) == 0) {
            return true;
        }
    }
    return false;
}

static void remember(struct hub_scim_gate *gate, const uint8_t *digest)
{
    if (!is_known(gate, digest)) {
        memmove(gate->known[1], gate->known[0],
                (HUB_SCIM_KNOWN - 1) * (size_t)HUB_SCIM_DIGEST_BYTES);
        memcpy(gate->known[0], digest, HUB_SCIM_DIGEST_BYTES);
    }
}

static void forget(struct hub_scim_gate *gate, const uint8_t *digest)
{
    for (int i = 0; i < HUB_SCIM_KNOWN; i++) {
        if (memcmp(gate->known[i], digest, HUB_SCIM_DIGEST_BYTES) == 0) {
            memset(gate->known[i], 0, HUB_SCIM_DIGEST_BYTES);
        }
    }
}

/* Reads "Authorization: Bearer TOKEN". */
static bool read_token(const struct web_exchange *exchange, uint8_t digest[HUB_SCIM_DIGEST_BYTES])
{
    static const char bearer[] = "Bearer ";
    const char *header = web_exchange_request_header(exchange, "Authorization");

    if (!header || strncasecmp(header, bearer, sizeof bearer - 1) != 0) {
        return false;
    }
    header += sizeof bearer - 1;
    header += strspn(header, " ");
    const size_t n = strcspn(header, " ");
    hub_scim_token_digest(header, n, digest);
    return n > 0 && header[n] == '\0';
}

/* ---- answers ---- */

static void refuse(struct web_exchange *exchange, unsigned status, const char *detail)
{
    char number[8];

    (void)snprintf(number, sizeof number, "%u", status);
    json_t *json = json_pack("{s:[s], s:s, s:s}", "schemas",
                             "urn:ietf:params:scim:api:messages:2.0:Error", "status", number,
                             "detail", detail);
    char *text = json ? json_dumps(json, JSON_COMPACT) : NULL;
    json_decref(json);
    if (status == 401) {
        web_exchange_header(exchange, "WWW-Authenticate", "Bearer");
    } else if (status == 429 || status == 503) {
        web_exchange_header(exchange, "Retry-After", "5");
    }
    web_exchange_typed(exchange, status, HUB_SCIM_TYPE, text, text ? strlen(text) : 0);
}

static void count(const struct asking *asking)
{
    struct hub_service *service = asking->service;
    const struct sockaddr *address = web_exchange_address(asking->exchange);

    service->totals.scim++;
    service->totals.scim_refused += asking->reply.status >= 400;
    if (asking->reply.is_stranger) {
        service->totals.scim_strangers++;
        forget(&service->scim, asking->request.token);
        web_guess_failed(&service->scim.guess, "", address, web_now_ns());
        web_guess_passed(&service->scim.guess, ""); /* only addresses count */
    } else if (asking->reply.status != 503) {
        remember(&service->scim, asking->request.token);
    }
    if (*asking->reply.trouble.text) {
        fprintf(stderr, SD_WARNING "isotherm-hub: SCIM: %s\n", asking->reply.trouble.text);
    }
}

static void send_reply(struct asking *asking)
{
    struct hub_scim_reply *reply = &asking->reply;
    struct web_exchange *exchange = asking->exchange;
    char seconds[16];

    if (reply->is_stranger) {
        web_exchange_header(exchange, "WWW-Authenticate", "Bearer error=\"invalid_token\"");
    }
    if (*reply->etag) {
        web_exchange_header(exchange, "ETag", reply->etag);
    }
    if (reply->status == 201) {
        web_exchange_header(exchange, "Location", reply->location);
    }
    if (reply->retry_s > 0) {
        (void)snprintf(seconds, sizeof seconds, "%u", reply->retry_s);
        web_exchange_header(exchange, "Retry-After", seconds);
    }
    web_exchange_typed(exchange, reply->status, HUB_SCIM_TYPE, reply->text,
                       reply->text ? strlen(reply->text) : 0);
}

/* ---- the work ---- */

static void work(void *context, struct hub_store *store)
{
    struct asking *asking = context;

    hub_scim_answer(store, &asking->request, &asking->reply);
}

static void done(void *context, bool is_done)
{
    struct asking *asking = context;

    if (is_done) {
        count(asking);
        send_reply(asking);
    } else {
        refuse(asking->exchange, 503, "the hub ends");
    }
    sodium_memzero(asking, sizeof *asking);
    free(asking);
}

static const char *query(const void *exchange, const char *name)
{
    return web_exchange_query(exchange, name);
}

/* A header that the threads need; NULL: there is none. */
static const char *keep(const struct web_exchange *exchange, const char *name,
                        char text[HEADER_SIZE])
{
    const char *header = web_exchange_request_header(exchange, name);

    (void)snprintf(text, HEADER_SIZE, "%s", header ? header : "");
    return header ? text : NULL;
}

static void fill(struct asking *asking, struct hub_service *service, struct web_exchange *exchange)
{
    const struct hub_api *api = &service->api;
    const bool is_ipv6 = strchr(api->host, ':') != NULL;
    struct hub_scim_request *request = &asking->request;

    asking->service = service;
    asking->exchange = exchange;
    (void)snprintf(asking->base, sizeof asking->base, "https://%s%s%s:%u/scim/v2",
                   is_ipv6 ? "[" : "", api->host, is_ipv6 ? "]" : "", api->port);
    request->method = web_exchange_method(exchange);
    request->path = web_exchange_part(exchange);
    request->base = asking->base;
    request->query = query;
    request->context = exchange;
    request->body = web_exchange_bytes(exchange, &request->size);
    request->if_match = keep(exchange, "If-Match", asking->if_match);
    request->if_none_match = keep(exchange, "If-None-Match", asking->if_none_match);
}

/* Whether the body is JSON, by its type. Providers send application/json, too. */
static bool is_json(const struct web_exchange *exchange)
{
    static const char *const types[] = {HUB_SCIM_TYPE, "application/json"};
    const char *type = web_exchange_request_header(exchange, "Content-Type");
    size_t size;

    (void)web_exchange_bytes(exchange, &size);
    for (size_t i = 0; type && i < sizeof types / sizeof *types; i++) {
        const size_t n = strlen(types[i]);
        if (strncasecmp(type, types[i], n) == 0 && strchr("; \t", type[n])) {
            return true;
        }
    }
    return size == 0;
}

/* Whether a request may go to the database; false after an answer. */
static bool may_ask(struct hub_service *service, struct web_exchange *exchange, uint8_t *digest)
{
    struct hub_scim_gate *gate = &service->scim;

    if (!read_token(exchange, digest)) {
        service->totals.scim_strangers++;
        refuse(exchange, 401, "the request has no header Authorization: Bearer TOKEN");
        return false;
    }
    if (!is_known(gate, digest) &&
        web_guess_wait_ns(&gate->guess, "", web_exchange_address(exchange), web_now_ns()) > 0) {
        refuse(exchange, 429, "there were too many wrong tokens from this address");
        return false;
    }
    if (!is_json(exchange)) {
        refuse(exchange, 415, "the body has to be of the type " HUB_SCIM_TYPE);
        return false;
    }
    return true;
}

void hub__scim(void *context, struct web_exchange *exchange)
{
    struct hub_service *service = context;
    uint8_t digest[HUB_SCIM_DIGEST_BYTES];

    if (!may_ask(service, exchange, digest)) {
        return;
    }
    struct asking *asking = calloc(1, sizeof *asking);
    const struct hub_task task = {.work = work, .done = done, .context = asking};
    if (!asking) {
        refuse(exchange, 503, "the hub has no memory for the request");
        return;
    }
    fill(asking, service, exchange);
    memcpy(asking->request.token, digest, sizeof digest);
    if (hub_worker_do(service->api.worker,
                      hub_scim_changes(asking->request.method) ? HUB_LANE_CHANGES : HUB_LANE_LOOKS,
                      &task)) {
        free(asking);
        refuse(exchange, 503, "the hub has too much to do");
    }
}

/* ---- the leader ---- */

static void mend(void *context, struct hub_store *store)
{
    struct iso_fault fault = {.text = ""};
    size_t n = 0;

    (void)context;
    (void)snprintf(store->actor, sizeof store->actor, "hub");
    if (hub_directory_mend(store, HUB_SCIM_SOURCE, &n, &fault)) {
        fprintf(stderr, SD_WARNING "isotherm-hub: people of identity providers: %s\n", fault.text);
    } else if (n > 0) {
        fprintf(stderr, SD_INFO "isotherm-hub: people of identity providers: %zu mended\n", n);
    }
}

static void mended(void *context, bool is_done)
{
    (void)context;
    (void)is_done;
}

void hub__scim_mend(struct hub_service *service)
{
    const int64_t now_s = (int64_t)hub__clock_s();
    const struct hub_task task = {.work = mend, .done = mended};

    if (service->is_leader && now_s - service->mended_s >= MEND_S &&
        hub_worker_do(service->api.worker, HUB_LANE_CHANGES, &task) == 0) {
        service->mended_s = now_s;
    }
}
