/* The fleet at a glance, what was done to it, and the description of the API. */
#include <errno.h>
#include <string.h>

#include "enroll/hub/api/api.h"
#include "enroll/hub/api/look.h"

enum { ACTS_MOST = 1000, ACTS_USUAL = 100 };

void hub__api_get_document(void *api, struct web_exchange *exchange)
{
    const char *text = (const char *)hub_api_document;

    (void)api;
    web_exchange_text(exchange, 200, strdup(text), strlen(text));
}

/* Numbers for the pages, in one statement. */
static const char counts[] =
    "SELECT (SELECT count(*) FROM person), (SELECT count(*) FROM request WHERE state = 0), "
    "(SELECT count(*) FROM zone), (SELECT count(*) FROM zone WHERE lockdown), "
    "(SELECT count(*) FROM zone WHERE behind), "
    "(SELECT count(*) FROM door WHERE expelled_s = 0), "
    "(SELECT count(*) FROM door WHERE expelled_s = 0 AND joined_s > 0), "
    "(SELECT count(*) FROM door WHERE expelled_s = 0 AND joined_s > 0 AND online)";

static int get_status(struct hub_call *call, struct hub_store *store, struct iso_fault *fault)
{
    PGresult *rows = NULL;
    const int error = hub_db_run(store->db, counts, NULL, &rows, fault);

    if (error) {
        return error;
    }
    call->json = json_pack(
        "{s:s, s:I, s:I, s:I, s:{s:I, s:I, s:I}, s:{s:I, s:I, s:I}}", "hub", store->hub_name,
        "time_s", (json_int_t)store->now_s(), "people", (json_int_t)hub_row_integer(rows, 0, 0),
        "requests", (json_int_t)hub_row_integer(rows, 0, 1), "zones", "all",
        (json_int_t)hub_row_integer(rows, 0, 2), "lockdown",
        (json_int_t)hub_row_integer(rows, 0, 3), "behind", (json_int_t)hub_row_integer(rows, 0, 4),
        "doors", "all", (json_int_t)hub_row_integer(rows, 0, 5), "joined",
        (json_int_t)hub_row_integer(rows, 0, 6), "online", (json_int_t)hub_row_integer(rows, 0, 7));
    PQclear(rows);
    return call->json ? 0 : hub__no_memory(fault);
}

void hub__api_get_status(void *api, struct web_exchange *exchange)
{
    hub__call(api, exchange, HUB_LANE_LOOKS, get_status);
}

static json_t *value_of(const char *text)
{
    json_t *value = *text ? json_loads(text, JSON_DECODE_ANY, NULL) : NULL;

    return value ? value : json_null();
}

/* The newest first. */
static int insert_act(void *list, const struct hub_act *act)
{
    return json_array_insert_new(list, 0,
                                 json_pack("{s:I, s:I, s:s, s:s, s:s, s:o, s:o}", "number",
                                           (json_int_t)act->number, "time_s",
                                           (json_int_t)act->time_s, "actor", act->actor, "act",
                                           act->what, "object", act->object, "before",
                                           value_of(act->before), "after", value_of(act->after)))
               ? -ENOMEM
               : 0;
}

static int list_acts(struct hub_call *call, struct hub_store *store, struct iso_fault *fault)
{
    json_t *list = json_array();
    uint32_t most = ACTS_USUAL;
    int error = hub__call_count(call, "max", ACTS_MOST, ACTS_USUAL, &most, fault);

    error = error ? error : hub_act_each(store, most, insert_act, list, fault);
    call->json = json_pack("{s:o}", "acts", list);
    return error == -ENOMEM ? hub__no_memory(fault) : error;
}

void hub__api_list_acts(void *api, struct web_exchange *exchange)
{
    hub__call(api, exchange, HUB_LANE_LOOKS, list_acts);
}
