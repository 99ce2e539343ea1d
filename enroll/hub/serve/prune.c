/* The leader deletes what need not be kept: a bounded number of rows at a time, in the thread of
 * looks, so that neither doors nor administrators wait. */
#include <stdio.h>
#include <stdlib.h>
#include <systemd/sd-daemon.h>

#include "enroll/hub/serve/service.h"

enum { EVERY_S = 600, NEXT_S = 2 };

struct pruning {
    struct hub_service *service;
    struct hub_prune_days days;
    struct hub_pruned pruned;
    int error;
    struct iso_fault fault;
};

static void work(void *context, struct hub_store *store)
{
    struct pruning *p = context;

    p->error = hub_prune(store, &p->days, &p->pruned, &p->fault);
}

/* Goes on soon while there is more. */
static void done(void *context, bool is_done)
{
    struct pruning *p = context;
    struct hub_service *service = p->service;
    const struct hub_pruned *n = &p->pruned;

    service->prunes = false;
    if (is_done && p->error) {
        fprintf(stderr, SD_WARNING "isotherm-hub: old rows: %s\n", p->fault.text);
    } else if (is_done) {
        service->totals.pruned.deltas += n->deltas;
        service->totals.pruned.events += n->events;
        service->totals.pruned.acts += n->acts;
        if (n->deltas == HUB_PRUNE_AT_ONCE || n->events == HUB_PRUNE_AT_ONCE ||
            n->acts == HUB_PRUNE_AT_ONCE) {
            service->pruned_s -= EVERY_S - NEXT_S;
        }
    }
    free(p);
}

void hub__prune(struct hub_service *service)
{
    const int64_t now_s = (int64_t)hub__clock_s();

    if (!service->is_leader || service->prunes ||
        (service->pruned_s && now_s - service->pruned_s < EVERY_S)) {
        return;
    }
    struct pruning *p = calloc(1, sizeof *p);
    const struct hub_task task = {.work = work, .done = done, .context = p};
    if (!p) {
        return;
    }
    p->service = service;
    p->days = service->options->keep;
    if (hub_worker_do(service->api.worker, HUB_LANE_LOOKS, &task)) {
        free(p);
        return;
    }
    service->prunes = true;
    service->pruned_s = now_s;
}
