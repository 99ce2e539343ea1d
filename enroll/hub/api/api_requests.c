/* People who were enrolled at a door and wait for approval. */
#include <errno.h>

#include "enroll/hub/api/api.h"
#include "enroll/hub/api/look.h"

static json_t *json_of(const struct hub_request *request)
{
    static const char *const states[] = {[HUB_REQUEST_PENDING] = "pending",
                                         [HUB_REQUEST_APPROVED] = "approved",
                                         [HUB_REQUEST_REJECTED] = "rejected"};
    char id[ISO_FLEET_ID_TEXT_SIZE], door[ISO_FLEET_ID_TEXT_SIZE];

    return json_pack("{s:s, s:s, s:{s:s, s:s}, s:I, s:s}", "id",
                     iso_fleet_id_text(&request->person, id), "name", request->name, "door", "id",
                     iso_fleet_id_text(&request->door, door), "name", request->door_name, "time_s",
                     (json_int_t)request->time_s, "state", states[request->state]);
}

static int append_request(void *list, const struct hub_request *request)
{
    return json_array_append_new(list, json_of(request)) ? -ENOMEM : 0;
}

static int list_requests(struct hub_call *call, struct hub_store *store, struct iso_fault *fault)
{
    json_t *list = json_array();
    const int error = hub_request_each(store, hub__call_asks(call, "all"), append_request, list,
                                       fault);

    call->json = json_pack("{s:o}", "requests", list);
    return error == -ENOMEM ? hub__no_memory(fault) : error;
}

void hub__api_list_requests(void *api, struct web_exchange *exchange)
{
    hub__call(api, exchange, HUB_LANE_LOOKS, list_requests);
}

/* Only an administrator chooses zones. Another account may name the one that holds anyway: the home
 * zone of the door at which the person was enrolled. */
static int check_choice(struct hub_call *call, struct hub_store *store,
                        const struct hub_request *request, const struct iso_fleet_id *zones,
                        size_t n, struct iso_fault *fault)
{
    char id[ISO_FLEET_ID_TEXT_SIZE];
    struct hub_door door = {.n_zones = 0};

    if (web_exchange_role(call->request) >= WEB_ROLE_ADMINISTRATOR || n == 0) {
        return 0;
    }
    const int error = hub__look_door(call, store, iso_fleet_id_text(&request->door, id), &door,
                                     fault);
    if (error) {
        return error;
    }
    if (n == 1 && door.n_zones > 0 && iso_fleet_id_is_same(&zones[0], &door.zones[0])) {
        return 0;
    }
    return hub__call_refuse(call, fault, 403, "not-allowed",
                            "only an administrator may choose other zones than the home zone of "
                            "the door");
}

/* Answers with the person who is one of the fleet now. */
static int approve(struct hub_call *call, struct hub_store *store, struct iso_fault *fault)
{
    struct iso_fleet_id zones[HUB_PERSON_ZONES_MAX];
    char id[ISO_FLEET_ID_TEXT_SIZE];
    struct hub_request request;
    struct hub_person person;
    bool has = false;
    size_t n = 0;
    int error = hub__look_request(call, store, web_exchange_part(call->request), &request, fault);

    error = error ? error
                  : hub__look_zones(call, store, HUB_PERSON_ZONES_MAX, &has, zones, &n, fault);
    error = error ? error : check_choice(call, store, &request, zones, n, fault);
    error = error ? error : hub_request_approve(store, &request.person, zones, n, fault);
    error = error ? error
                  : hub__look_person(call, store, iso_fleet_id_text(&request.person, id), &person,
                                     fault);
    call->json = error ? NULL : hub__json_person(&person);
    return error;
}

void hub__api_approve_request(void *api, struct web_exchange *exchange)
{
    hub__call(api, exchange, HUB_LANE_CHANGES, approve);
}

static int reject(struct hub_call *call, struct hub_store *store, struct iso_fault *fault)
{
    struct hub_request request;
    const int error = hub__look_request(call, store, web_exchange_part(call->request), &request,
                                        fault);

    return error ? error : hub_request_reject(store, &request.person, fault);
}

void hub__api_reject_request(void *api, struct web_exchange *exchange)
{
    hub__call(api, exchange, HUB_LANE_CHANGES, reject);
}
