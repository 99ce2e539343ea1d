/* People, and those who wait for approval. */
#include <errno.h>
#include <stdlib.h>

#include "enroll/hub/api/api_inner.h"
#include "enroll/hub/people/hub_person.h"
#include "enroll/hub/people/hub_request.h"
#include "enroll/hub/store/hub_zone.h"

enum { PEOPLE_MOST = 20000 };

static int add_person(void *context, const struct hub_person *person)
{
    json_t *zones = json_array();

    for (size_t i = 0; i < person->n_zones; i++) {
        (void)json_array_append_new(zones, json_string(person->zone_names[i]));
    }
    return json_array_append_new(
               context, json_pack("{s:o, s:s, s:o, s:I, s:I, s:I, s:b, s:I}", "id",
                                  hub__api_id(&person->id), "name", person->name, "zones", zones,
                                  "valid-from", (json_int_t)person->valid_from_s, "valid-until",
                                  (json_int_t)person->valid_until_s, "enrolled",
                                  (json_int_t)person->enrolled_s, "offline-ok", person->offline_ok,
                                  "templates", (json_int_t)person->templates))
               ? -ENOMEM
               : 0;
}

void hub__api_list_people(void *context, struct web_exchange *exchange)
{
    const struct hub_api *api = context;
    const char *name = web_exchange_query(exchange, "zone");
    struct hub_person_filter filter = {.part = web_exchange_query(exchange, "search")};
    struct iso_fault fault = {.text = ""};
    struct hub_zone zone;
    int64_t most;

    if (!web_exchange_number(exchange, "most", 1, PEOPLE_MOST, PEOPLE_MOST, &most)) {
        return;
    }
    filter.most = (uint32_t)most;
    int r = name ? hub_zone_find(api->store, name, &zone, &fault) : 0;
    filter.zone = name ? &zone.place.zone : NULL;
    json_t *list = json_array();
    r = r ? r : hub_person_each(api->store, &filter, add_person, list, &fault);
    hub__api_list(exchange, "people", list, r, &fault);
}

/* Ends a change of somebody: 204, or the problem. */
static void end(struct hub_api *api, struct web_exchange *exchange,
                const struct hub__api_actor *actor, int error, const struct iso_fault *fault)
{
    hub__api_acted(api, actor);
    if (error) {
        hub__api_problem(exchange, error, fault);
    } else {
        web_exchange_done(exchange);
    }
}

void hub__api_revoke_person(void *context, struct web_exchange *exchange)
{
    struct hub_api *api = context;
    struct iso_fault fault = {.text = ""};
    struct hub__api_actor actor;
    struct hub_person *person = malloc(sizeof *person);
    int r = person ? hub_person_find(api->store, web_exchange_part(exchange), person, &fault)
                   : iso_fault_set(&fault, -ENOMEM, "out of memory");

    hub__api_act(api, exchange, &actor);
    r = r ? r : hub_person_revoke(api->store, &person->id, &fault);
    free(person);
    end(api, exchange, &actor, r, &fault);
}

/* ---- requests ---- */

static int add_request(void *context, const struct hub_request *request)
{
    return json_array_append_new(context, json_pack("{s:o, s:o, s:s, s:s, s:I}", "id",
                                                    hub__api_id(&request->person), "door",
                                                    hub__api_id(&request->door), "name",
                                                    request->name, "door-name", request->door_name,
                                                    "time", (json_int_t)request->time_s))
               ? -ENOMEM
               : 0;
}

void hub__api_list_requests(void *context, struct web_exchange *exchange)
{
    const struct hub_api *api = context;
    struct iso_fault fault = {.text = ""};
    json_t *list = json_array();
    const int r = hub_request_each(api->store, false, add_request, list, &fault);

    hub__api_list(exchange, "requests", list, r, &fault);
}

void hub__api_approve(void *context, struct web_exchange *exchange)
{
    struct hub_api *api = context;
    struct iso_fault fault = {.text = ""};
    struct hub__api_actor actor;
    struct hub_request request;
    int r = hub_request_find(api->store, web_exchange_part(exchange), &request, &fault);

    hub__api_act(api, exchange, &actor);
    r = r ? r : hub_request_approve(api->store, &request.person, NULL, 0, &fault);
    end(api, exchange, &actor, r, &fault);
}

void hub__api_reject(void *context, struct web_exchange *exchange)
{
    struct hub_api *api = context;
    struct iso_fault fault = {.text = ""};
    struct hub__api_actor actor;
    struct hub_request request;
    int r = hub_request_find(api->store, web_exchange_part(exchange), &request, &fault);

    hub__api_act(api, exchange, &actor);
    r = r ? r : hub_request_reject(api->store, &request.person, &fault);
    end(api, exchange, &actor, r, &fault);
}
