/* Who was where: the records of all doors' logs, the newest first. */
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "enroll/hub/answer/hub_event.h"
#include "enroll/hub/api/api.h"
#include "enroll/hub/api/look.h"

enum { EVENTS_MOST = 1000, EVENTS_USUAL = 100, PLACE_SIZE = 128, TIME_SIZE = 48 };

struct list {
    json_t *events; /* the oldest first */
};

static int append_event(void *context, const struct hub_event *event)
{
    const struct list *list = context;
    char door[ISO_FLEET_ID_TEXT_SIZE];
    json_t *record = json_loads(event->record, 0, NULL);

    return json_array_insert_new(list->events, 0,
                                 json_pack("{s:{s:s, s:s}, s:I, s:s, s:o}", "door", "id",
                                           iso_fleet_id_text(&event->door, door), "name",
                                           event->door_name, "number", (json_int_t)event->number,
                                           "time", event->time, "record",
                                           record ? record : json_null()))
               ? -ENOMEM
               : 0;
}

/* A place as the answer names it: "NUMBER DOOR TIME". */
struct place_text {
    char time[TIME_SIZE];
    struct hub_event_place place;
};

static bool read_place(const char *text, struct place_text *out)
{
    char door[ISO_FLEET_ID_TEXT_SIZE];

    out->time[0] = '\0';
    const int n = sscanf(text, "%" SCNu64 " %36s %47s", &out->place.number, door, out->time);
    out->place.time = out->time;
    return n >= 2 && out->place.number <= INT64_MAX &&
           iso_fleet_id_read(door, &out->place.door) == 0;
}

/* Where the next page begins; null if this is the last one. */
static json_t *next_of(const json_t *events, uint32_t most)
{
    const json_t *last = json_array_get(events, json_array_size(events) - 1);
    char text[PLACE_SIZE];

    if (json_array_size(events) < most) {
        return json_null();
    }
    (void)snprintf(text, sizeof text, "%lld %s %s",
                   (long long)json_integer_value(json_object_get(last, "number")),
                   json_string_value(json_object_get(json_object_get(last, "door"), "id")),
                   json_string_value(json_object_get(last, "time")));
    return json_string(text);
}

static int list_events(struct hub_call *call, struct hub_store *store, struct iso_fault *fault)
{
    const struct web_exchange *request = call->request;
    const char *door_name = web_exchange_query(request, "door");
    const char *before = web_exchange_query(request, "before");
    struct hub_event_filter filter = {.person = web_exchange_query(request, "person"),
                                      .event = web_exchange_query(request, "event"),
                                      .since = web_exchange_query(request, "since"),
                                      .until = web_exchange_query(request, "until")};
    struct list list = {.events = json_array()};
    struct place_text place;
    struct hub_door door;
    int error = hub__call_count(call, "max", EVENTS_MOST, EVENTS_USUAL, &filter.most, fault);

    if (!error && before && !read_place(before, &place)) {
        error = hub__call_refuse(call, fault, 400, "invalid-parameter",
                                 "before has to be a place that an answer has named");
    }
    filter.before = before ? &place.place : NULL;
    if (!error && door_name) {
        error = hub__look_door(call, store, door_name, &door, fault);
        filter.door = &door.id;
    }
    error = error ? error : hub_event_each(store, &filter, append_event, &list, fault);
    if (error) {
        json_decref(list.events);
        return error == -ENOMEM ? hub__no_memory(fault) : error;
    }
    json_t *next = next_of(list.events, filter.most);
    call->json = json_pack("{s:o, s:o}", "events", list.events, "next", next);
    return call->json ? 0 : hub__no_memory(fault);
}

void hub__api_list_events(void *api, struct web_exchange *exchange)
{
    hub__call(api, exchange, HUB_LANE_LOOKS, list_events);
}
