/* Acts that are put on record before they are done, and whether they may still be done then. */
#include <stdlib.h>

#include "enroll/web/api/act.h"
#include "enroll/web/api/api.h"

bool web_api_goes_on(const struct web_api *api, struct web_exchange *exchange)
{
    return web_login_goes_on(&api->login, exchange);
}

struct act {
    struct web_api *api;
    struct web_exchange *exchange;
    void (*go)(struct web_api *api, struct web_exchange *exchange);
};

static void on_recorded(void *context, sd_bus_message *reply, const sd_bus_error *error)
{
    const struct act act = *(struct act *)context;

    (void)reply;
    free(context);
    if (error) {
        web_api_daemon_problem(act.exchange, error);
    } else if (web_api_goes_on(act.api, act.exchange)) {
        act.go(act.api, act.exchange);
    }
}

void web__api_act(struct web_api *api, struct web_exchange *exchange, const char *act,
                  const char *concerned,
                  void (*go)(struct web_api *api, struct web_exchange *exchange))
{
    struct act *context = malloc(sizeof *context);

    if (!context) {
        web_exchange_problem(exchange, 500, "internal", "there is no memory for this");
        return;
    }
    *context = (struct act){.api = api, .exchange = exchange, .go = go};
    web_daemon_record(api->daemon, web_exchange_account(exchange), act, concerned, on_recorded,
                      context);
}
