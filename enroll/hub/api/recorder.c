/* Acts of accounts (logins, changes of accounts) in the hub's table of acts. Changes of the fleet
 * have their acts in their own transactions. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>

#include "enroll/hub/api/hub_api.h"
#include "enroll/hub/store/hub_act.h"

enum { RECORDS_WAIT_MOST = 40 }; /* then nobody logs in */

struct record {
    char account[WEB_ACCOUNT_NAME_SIZE], act[40], concerned[HUB_ACTOR_SIZE];
    void (*done)(void *context, const struct web_problem *problem);
    void *context;
    int error;
    struct iso_fault fault;
};

static void work(void *context, struct hub_store *store)
{
    struct record *record = context;

    (void)snprintf(store->actor, sizeof store->actor, "%s", record->account);
    record->error = hub__act_add(store, record->act, record->concerned, NULL, NULL, &record->fault);
}

static void on_done(void *context, bool is_done)
{
    struct record *record = context;
    const struct web_problem ends = {503, "busy", "the hub ends"};
    const struct web_problem failed = {503, "no-database", record->fault.text};

    record->done(record->context, !is_done ? &ends : record->error ? &failed : NULL);
    free(record);
}

static void record(void *recorder, const char *account, const char *act, const char *concerned,
                   void (*done)(void *context, const struct web_problem *problem), void *context)
{
    static const struct web_problem busy = {503, "busy", "the hub has too much to do"};
    const struct hub_api *api = recorder;
    struct record *record = calloc(1, sizeof *record);
    const struct hub_task task = {.work = work, .done = on_done, .context = record};

    if (record) {
        (void)snprintf(record->account, sizeof record->account, "%s", account);
        (void)snprintf(record->act, sizeof record->act, "%s", act);
        (void)snprintf(record->concerned, sizeof record->concerned, "%s", concerned);
        record->done = done;
        record->context = context;
    }
    if (!record || hub_worker_do(api->worker, HUB_LANE_CHANGES, &task)) {
        free(record);
        done(context, &busy);
    }
}

/* Somebody who logs in again and again would keep the changes of all others waiting. */
static const struct web_problem *hindrance(void *recorder)
{
    static const struct web_problem busy = {503, "busy", "the hub has too much to do"};
    const struct hub_api *api = recorder;

    return hub_worker_waiting(api->worker, HUB_LANE_CHANGES) >= RECORDS_WAIT_MOST ? &busy : NULL;
}

void hub_api_record_by_worker(struct hub_api *api)
{
    static const struct web_recorder recorder = {"isotherm-hub", record, hindrance};

    api->login.recorder = &recorder;
    api->login.recorder_context = api;
}
