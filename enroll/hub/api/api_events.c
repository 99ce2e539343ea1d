/* Who was where, and who has changed what. */
#include <errno.h>

#include "enroll/hub/answer/hub_event.h"
#include "enroll/hub/api/api_inner.h"
#include "enroll/hub/store/hub_act.h"
#include "enroll/hub/store/hub_door.h"

enum { EVENTS_MOST = 10000, EVENTS_USUAL = 200 };

static int add_event(void *context, const struct hub_event *event)
{
    json_t *record = json_loads(event->record, 0, NULL);

    return json_array_append_new(context,
                                 json_pack("{s:o, s:s, s:I, s:s, s:o}", "door",
                                           hub__api_id(&event->door), "door-name", event->door_name,
                                           "number", (json_int_t)event->number, "time", event->time,
                                           "record", record ? record : json_object()))
               ? -ENOMEM
               : 0;
}

void hub__api_list_events(void *context, struct web_exchange *exchange)
{
    const struct hub_api *api = context;
    const char *name = web_exchange_query(exchange, "door");
    struct hub_event_filter filter = {.person = web_exchange_query(exchange, "person"),
                                      .event = web_exchange_query(exchange, "event"),
                                      .since = web_exchange_query(exchange, "since")};
    struct iso_fault fault = {.text = ""};
    struct hub_door door;
    int64_t most;

    if (!web_exchange_number(exchange, "most", 1, EVENTS_MOST, EVENTS_USUAL, &most)) {
        return;
    }
    filter.most = (uint32_t)most;
    int r = name ? hub_door_find(api->store, name, &door, &fault) : 0;
    filter.door = name ? &door.id : NULL;
    json_t *list = json_array();
    r = r ? r : hub_event_each(api->store, &filter, add_event, list, &fault);
    hub__api_list(exchange, "events", list, r, &fault);
}

static int add_act(void *context, const struct hub_act *act)
{
    json_t *before = json_loads(act->before, JSON_DECODE_ANY, NULL);
    json_t *after = json_loads(act->after, JSON_DECODE_ANY, NULL);

    return json_array_append_new(context,
                                 json_pack("{s:I, s:I, s:s, s:s, s:s, s:o, s:o}", "number",
                                           (json_int_t)act->number, "time", (json_int_t)act->time_s,
                                           "actor", act->actor, "what", act->what, "object",
                                           act->object, "before", before ? before : json_null(),
                                           "after", after ? after : json_null()))
               ? -ENOMEM
               : 0;
}

void hub__api_list_acts(void *context, struct web_exchange *exchange)
{
    const struct hub_api *api = context;
    struct iso_fault fault = {.text = ""};
    int64_t most;

    if (!web_exchange_number(exchange, "most", 1, EVENTS_MOST, EVENTS_USUAL, &most)) {
        return;
    }
    json_t *list = json_array();
    const int r = hub_act_each(api->store, (uint32_t)most, add_act, list, &fault);
    hub__api_list(exchange, "acts", list, r, &fault);
}
