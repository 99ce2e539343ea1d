/* People of the fleet: lists and one person. */
#include <errno.h>
#include <string.h>

#include "enroll/hub/api/api.h"
#include "enroll/hub/api/look.h"

enum { PEOPLE_MOST = 1000, PEOPLE_USUAL = 100 };

struct list {
    json_t *people;
    uint32_t n, most;
    bool has_more;
    char last[ISO_FLEET_NAME_MAX + 1];
};

/* One more than was asked for: then there is a next page. */
static int append_person(void *context, const struct hub_person *person)
{
    struct list *list = context;

    if (list->n == list->most) {
        list->has_more = true;
        return 0;
    }
    list->n++;
    (void)strcpy(list->last, person->name);
    return json_array_append_new(list->people, hub__json_person(person)) ? -ENOMEM : 0;
}

static int list_people(struct hub_call *call, struct hub_store *store, struct iso_fault *fault)
{
    const char *zone_name = web_exchange_query(call->request, "zone");
    struct list list = {.people = json_array()};
    struct hub_person_filter filter = {.part = web_exchange_query(call->request, "search"),
                                       .after = web_exchange_query(call->request, "after"),
                                       .unseen = hub__call_asks(call, "unseen")};
    struct hub_zone zone;
    int error = hub__call_count(call, "max", PEOPLE_MOST, PEOPLE_USUAL, &list.most, fault);

    if (!error && zone_name) {
        error = hub__look_zone(call, store, zone_name, &zone, fault);
        filter.zone = &zone.place.zone;
    }
    filter.most = list.most + 1;
    error = error ? error : hub_person_each(store, &filter, append_person, &list, fault);
    call->json = json_pack("{s:o, s:o}", "people", list.people, "next",
                           list.has_more ? json_string(list.last) : json_null());
    return error == -ENOMEM ? hub__no_memory(fault) : error;
}

void hub__api_list_people(void *api, struct web_exchange *exchange)
{
    hub__call(api, exchange, HUB_LANE_LOOKS, list_people);
}

static int get_person(struct hub_call *call, struct hub_store *store, struct iso_fault *fault)
{
    struct hub_person person;
    const int error = hub__look_person(call, store, web_exchange_part(call->request), &person,
                                       fault);

    call->json = error ? NULL : hub__json_person(&person);
    return error;
}

void hub__api_get_person(void *api, struct web_exchange *exchange)
{
    hub__call(api, exchange, HUB_LANE_LOOKS, get_person);
}
