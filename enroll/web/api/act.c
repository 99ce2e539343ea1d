/* The recorder of isotherm-web: the daemon puts on record what the accounts do. */
#include "enroll/web/api/act.h"

#include <stdlib.h>

enum { CALLS_WAIT_MOST = 40 }; /* of the daemon; then nobody logs in */

struct record {
    void (*done)(void *context, const struct web_problem *problem);
    void *context;
};

static void on_reply(void *context, sd_bus_message *reply, const sd_bus_error *error)
{
    const struct record record = *(struct record *)context;
    struct web_problem problem;

    (void)reply;
    free(context);
    if (error) {
        problem = web__api_problem_of(error);
    }
    record.done(record.context, error ? &problem : NULL);
}

static void record(void *recorder, const char *account, const char *act, const char *concerned,
                   void (*done)(void *context, const struct web_problem *problem), void *context)
{
    static const struct web_problem no_memory = {500, "internal", "there is no memory for this"};
    const struct web_api *api = recorder;
    struct record *record = malloc(sizeof *record);

    if (!record) {
        done(context, &no_memory);
        return;
    }
    *record = (struct record){done, context};
    web_daemon_record(api->daemon, account, act, concerned, on_reply, record);
}

/* Nobody waits for the record of a login. Somebody who logs in again and again would keep the calls
 * of all others waiting, and fill the memory. */
static const struct web_problem *hindrance(void *recorder)
{
    static const struct web_problem busy = {503, "daemon-busy", "the daemon has too much to do"};
    const struct web_api *api = recorder;

    return web_daemon_waiting(api->daemon) >= CALLS_WAIT_MOST ? &busy : NULL;
}

void web_api_record_by_daemon(struct web_api *api)
{
    static const struct web_recorder recorder = {"isotherm-web", record, hindrance};

    api->login.recorder = &recorder;
    api->login.recorder_context = api;
}
