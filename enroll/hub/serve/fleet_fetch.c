/* POST /fleet/v1/fetch: missing deltas, a snapshot, or a part of an update. The body is a FETCH,
 * which the door has signed; so the request needs nothing more. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <systemd/sd-daemon.h>
#include <unistd.h>

#include "enroll/hub/serve/service.h"

/* A fetch that is under way. */
struct fetching {
    struct hub_service *service;
    struct web_exchange *exchange;
};

/* The file of an answer, which is sent. */
struct sending {
    int fd;
    uint64_t offset; /* where the answer begins */
};

static ssize_t read_file(void *context, uint64_t at, void *out, size_t most)
{
    const struct sending *sending = context;
    const ssize_t n = pread(sending->fd, out, most, (off_t)(sending->offset + at));

    return n < 0 ? -errno : n;
}

static void close_file(void *context)
{
    struct sending *sending = context;

    (void)close(sending->fd);
    free(sending);
}

static void busy(struct web_exchange *exchange, const char *why)
{
    web_exchange_header(exchange, "Retry-After", "3");
    web_exchange_problem(exchange, 503, "busy", why);
}

static void refuse(struct web_exchange *exchange, const struct hub_fetch_result *result)
{
    switch (result->error) {
    case -EACCES:
    case -EKEYREJECTED:
        web_exchange_problem(exchange, 403, "not-allowed", result->fault.text);
        return;
    case -EBADMSG:
    case -EPROTONOSUPPORT:
    case -ENOENT:
        web_exchange_problem(exchange, 400, "invalid-request", result->fault.text);
        return;
    case -ENOTCONN:
    case -EAGAIN:
    case -ECANCELED:
        busy(exchange, "the hub cannot answer now");
        return;
    default:
        fprintf(stderr, SD_ERR "isotherm-hub: a fetch: %s\n", result->fault.text);
        web_exchange_problem(exchange, 500, "internal",
                             "the hub could not do it; its log says why");
    }
}

static void on_answer(void *context, const struct hub_fetch_result *result)
{
    const struct fetching fetching = *(struct fetching *)context;
    struct hub_totals *totals = &fetching.service->totals;

    free(context);
    if (result->seconds > totals->longest_fetch_s) {
        totals->longest_fetch_s = result->seconds;
    }
    if (result->error) {
        totals->fetches_refused++;
        refuse(fetching.exchange, result);
        return;
    }
    struct sending *sending = malloc(sizeof *sending);
    if (!sending) {
        (void)close(result->fd);
        busy(fetching.exchange, "the hub has no memory for the answer");
        return;
    }
    totals->fetches++;
    *sending = (struct sending){result->fd, result->offset};
    const struct web_source source = {result->size, read_file, close_file, sending};
    web_exchange_source(fetching.exchange, "application/octet-stream", &source);
}

void hub__post_fetch(void *context, struct web_exchange *exchange)
{
    struct hub_service *service = context;
    struct fetching *fetching = malloc(sizeof *fetching);
    size_t size;
    const void *bytes = web_exchange_bytes(exchange, &size);

    if (!fetching) {
        busy(exchange, "the hub has no memory for the request");
        return;
    }
    *fetching = (struct fetching){service, exchange};
    if (hub_fetch_ask(service->fetch, bytes ? bytes : "", size, on_answer, fetching)) {
        free(fetching);
        service->totals.fetches_refused++;
        busy(exchange, "too many doors fetch at this time");
    }
}
