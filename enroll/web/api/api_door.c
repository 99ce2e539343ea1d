/* The state of the appliance, and the calls of an administrator that concern the door. */
#include <stdlib.h>
#include <string.h>

#include "enroll/web/api/api.h"
#include "enroll/web/api/parts.h"
#include "enroll/web/daemon/feed.h"
#include "firmware/contract/contract.h"

void web_api_get_status(void *context, struct web_exchange *exchange)
{
    const struct web_api *api = context;
    web_exchange_json(exchange, 200, web_feed_state(api->feed));
}

/* ---- changes, which are put on record first ---- */

struct change {
    const struct web_api *api;
    struct web_exchange *exchange;
    const char *method;
    bool on; /* the argument of SetLockdown */
};

static void on_changed(void *context, sd_bus_message *reply, const sd_bus_error *error)
{
    struct change *change = context;
    (void)reply;
    if (error) {
        web_api_daemon_problem(change->exchange, error);
    } else {
        web_exchange_done(change->exchange);
    }
    free(change);
}

static void on_recorded(void *context, sd_bus_message *reply, const sd_bus_error *error)
{
    struct change *change = context;
    const bool is_lockdown = strcmp(change->method, ISO_CONTRACT_SET_LOCKDOWN) == 0;
    if (error) {
        on_changed(context, reply, error);
        return;
    }
    if (!web_api_goes_on(change->api, change->exchange)) {
        free(change);
        return;
    }
    sd_bus_message *call = web_daemon_message(change->api->daemon, change->method);
    if (call && is_lockdown && sd_bus_message_append(call, "b", (int)change->on) < 0) {
        call = sd_bus_message_unref(call);
    }
    web_daemon_send(change->api->daemon, call, 0, on_changed, change);
}

static void begin_change(const struct web_api *api, struct web_exchange *exchange, const char *act,
                         const char *method, bool on)
{
    struct change *change = malloc(sizeof *change);
    if (!change) {
        web_exchange_json(exchange, 500, NULL);
        return;
    }
    *change = (struct change){api, exchange, method, on};
    web_daemon_record(api->daemon, web_exchange_account(exchange), act, "", on_recorded, change);
}

void web_api_set_lockdown(void *context, struct web_exchange *exchange)
{
    bool on = false;
    if (!json_object_get(web_exchange_body(exchange), "on")) {
        web_exchange_problem(exchange, 400, "invalid-member", "The member 'on' is missing.");
    } else if (web__api_flag(exchange, "on", false, &on)) {
        begin_change(context, exchange, on ? "lockdown-on" : "lockdown-off",
                     ISO_CONTRACT_SET_LOCKDOWN, on);
    }
}

void web_api_clear_lockout(void *context, struct web_exchange *exchange)
{
    begin_change(context, exchange, "lockout-clear", ISO_CONTRACT_CLEAR_LOCKOUT, false);
}
