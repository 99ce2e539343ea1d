/* Updates of the image: their state, the upload of a bundle, and the restart into an update. The
 * audit log records the act first. Then the bundle is handed over, or the restart is asked for. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/web/api/act.h"
#include "enroll/web/api/api.h"
#include "enroll/web/update/update.h"

/* Who asks, while the daemon or RAUC answers. */
struct asked {
    struct web_api *api;
    struct web_exchange *exchange;
};

/* ---- the state ---- */

static void on_seen(void *context, json_t *state)
{
    web_exchange_json(context, 200, state);
}

void web_api_get_update(void *context, struct web_exchange *exchange)
{
    const struct web_api *api = context;

    web_update_look(api->update, on_seen, exchange);
}

/* ---- the bundle ---- */

static struct web_upload *upload_of(const struct web_api *api)
{
    return web_update_upload(api->update);
}

/* The errors of upload.h. */
static struct web_problem problem_of(int error)
{
    switch (error) {
    case -ENOENT:
        return (struct web_problem){409, "no-image", "this machine takes no updates by its pages"};
    case -EBUSY:
        return (struct web_problem){409, "update-running", "another update goes on"};
    case -ENOSPC:
    case -EDQUOT:
        return (struct web_problem){507, "no-room", "the disk has no room for the update"};
    case -EMSGSIZE:
        return (struct web_problem){400, "incomplete", "the update has another size than was said"};
    default:
        return (struct web_problem){507, "storage", "the update cannot be stored"};
    }
}

static void refuse(struct web_exchange *exchange, int error)
{
    const struct web_problem problem = problem_of(error);

    web_exchange_refuse(exchange, problem.status, problem.code, problem.detail);
}

static bool begin(void *context, struct web_exchange *exchange, uint64_t size)
{
    const int r = web_upload_begin(upload_of(context), exchange, size);

    if (r < 0) {
        refuse(exchange, r);
    }
    return r == 0;
}

static bool take(void *context, struct web_exchange *exchange, const void *bytes, size_t size)
{
    const int r = web_upload_take(upload_of(context), bytes, size);

    if (r < 0) {
        refuse(exchange, r);
    }
    return r == 0;
}

static void drop(void *context, struct web_exchange *exchange)
{
    web_upload_drop(upload_of(context), exchange);
}

const struct web_intake web_api_intakes[] = {
    {.path = "/update",
     .type = "application/octet-stream",
     .most = WEB_UPLOAD_MOST_BYTES,
     .begin = begin,
     .take = take,
     .drop = drop},
    {.path = NULL},
};

static void answer(struct web_exchange *exchange, int error)
{
    const struct web_problem problem = problem_of(error);

    if (error < 0) {
        web_exchange_problem(exchange, problem.status, problem.code, problem.detail);
    } else {
        web_exchange_json(exchange, 202, json_object());
    }
}

static void on_recorded(void *context, sd_bus_message *reply, const sd_bus_error *error)
{
    const struct asked handing = *(struct asked *)context;
    struct web_upload *upload = upload_of(handing.api);

    (void)reply;
    free(context);
    if (error) {
        web_upload_drop(upload, handing.exchange);
        web_api_daemon_problem(handing.exchange, error);
    } else if (web_api_goes_on(handing.api, handing.exchange)) {
        answer(handing.exchange, web_upload_hand_over(upload));
    } else {
        web_upload_drop(upload, handing.exchange);
    }
}

void web_api_take_update(void *context, struct web_exchange *exchange)
{
    struct web_api *api = context;
    struct asked *handing = malloc(sizeof *handing);

    if (!handing || !web_upload_is_complete(upload_of(api))) {
        web_upload_drop(upload_of(api), exchange);
        answer(exchange, handing ? -EMSGSIZE : -ENOMEM);
        free(handing);
        return;
    }
    *handing = (struct asked){api, exchange};
    web_daemon_record(api->daemon, web_exchange_account(exchange), "update", "", on_recorded,
                      handing);
}

/* ---- the restart ---- */

static void go(struct web_api *api, struct web_exchange *exchange)
{
    answer(exchange, web_upload_wish_restart(upload_of(api)));
}

/* Whether the slot that starts next is another one than that which runs. */
static bool waits(const json_t *state)
{
    const json_t *slots = json_object_get(state, "slots"), *slot;
    size_t i;

    json_array_foreach(slots, i, slot)
    {
        if (json_is_true(json_object_get(slot, "next"))) {
            return json_is_false(json_object_get(slot, "running"));
        }
    }
    return false;
}

static void on_seen_before_restart(void *context, json_t *state)
{
    const struct asked restart = *(struct asked *)context;
    const bool goes = waits(state);

    free(context);
    json_decref(state);
    if (goes) {
        web__api_act(restart.api, restart.exchange, "restart", "", go);
    } else {
        web_exchange_problem(restart.exchange, 409, "no-update",
                             "there is no update into which the machine could restart");
    }
}

void web_api_restart(void *context, struct web_exchange *exchange)
{
    struct web_api *api = context;
    struct asked *restart = malloc(sizeof *restart);

    if (!restart) {
        web_exchange_json(exchange, 500, NULL);
        return;
    }
    *restart = (struct asked){api, exchange};
    web_update_look(api->update, on_seen_before_restart, restart);
}
