/* Changes of a person. */
#include <errno.h>
#include <string.h>

#include "enroll/hub/api/api.h"
#include "enroll/hub/api/look.h"

/* What a request changes; all of it holds, or nothing. */
struct change {
    struct hub_call *call;
    struct hub_store *store;
    struct hub_person person;
    const char *name;
    bool has_from, has_until, has_offline, has_zones, offline_ok;
    int64_t from_s, until_s;
    struct iso_fleet_id zones[HUB_PERSON_ZONES_MAX];
    size_t n_zones;
};

static int read_change(struct change *change, struct iso_fault *fault)
{
    struct hub_call *call = change->call;
    int error = 0;

    if (json_object_get(web_exchange_body(call->request), "name")) {
        change->name = hub__call_text(call, "name", ISO_FLEET_NAME_MAX, &error, fault);
    }
    change->from_s = change->person.valid_from_s;
    change->until_s = change->person.valid_until_s;
    error = error ? error
                  : hub__call_number(call, "valid_from_s", INT64_MAX, &change->has_from,
                                     &change->from_s, fault);
    error = error ? error
                  : hub__call_number(call, "valid_until_s", INT64_MAX, &change->has_until,
                                     &change->until_s, fault);
    error = error ? error
                  : hub__call_flag(call, "offline_ok", &change->has_offline, &change->offline_ok,
                                   fault);
    return error ? error
                 : hub__look_zones(call, change->store, HUB_PERSON_ZONES_MAX, &change->has_zones,
                                   change->zones, &change->n_zones, fault);
}

static int apply(void *context, struct iso_fault *fault)
{
    const struct change *change = context;
    const struct iso_fleet_id *id = &change->person.id;
    struct hub_store *store = change->store;
    int error = 0;

    if (change->name && strcmp(change->name, change->person.name) != 0) {
        error = hub_person_rename(store, id, change->name, fault);
    }
    if (!error && (change->has_from || change->has_until)) {
        error = hub_person_set_validity(store, id, change->from_s, change->until_s, fault);
        if (error == -EINVAL) {
            change->call->refusal = (struct web_problem){400, "invalid-limits", NULL};
        }
    }
    if (!error && change->has_offline && change->offline_ok != change->person.offline_ok) {
        error = hub_person_set_offline(store, id, change->offline_ok, fault);
    }
    if (!error && change->has_zones) {
        error = hub_person_set_zones(store, id, change->zones, change->n_zones, fault);
    }
    return error;
}

/* The zones of a person with the doors that have not confirmed. */
static int show_waiting(struct hub_call *call, struct hub_store *store,
                        const struct hub_person *person, struct iso_fault *fault)
{
    json_t *zones = NULL;
    const int error = hub__json_zones_waiting(store, person->zones, person->n_zones, &zones, fault);

    call->json = error ? NULL : json_pack("{s:s, s:o}", "name", person->name, "zones", zones);
    return error;
}

static int change_person(struct hub_call *call, struct hub_store *store, struct iso_fault *fault)
{
    struct change change = {.call = call, .store = store};
    char id[ISO_FLEET_ID_TEXT_SIZE];
    struct hub_person after;
    int error = hub__look_person(call, store, web_exchange_part(call->request), &change.person,
                                 fault);

    error = error ? error : read_change(&change, fault);
    error = error ? error
                  : hub_db_transaction(store->db, HUB_READ_COMMITTED, apply, &change, fault);
    error = error ? error
                  : hub__look_person(call, store, iso_fleet_id_text(&change.person.id, id), &after,
                                     fault);
    call->json = error ? NULL : hub__json_person(&after);
    return error;
}

void hub__api_change_person(void *api, struct web_exchange *exchange)
{
    hub__call(api, exchange, HUB_LANE_CHANGES, change_person);
}

static int revoke_person(struct hub_call *call, struct hub_store *store, struct iso_fault *fault)
{
    struct hub_person person;
    int error = hub__look_person(call, store, web_exchange_part(call->request), &person, fault);

    error = error ? error : hub_person_revoke(store, &person.id, fault);
    return error ? error : show_waiting(call, store, &person, fault);
}

void hub__api_revoke_person(void *api, struct web_exchange *exchange)
{
    hub__call(api, exchange, HUB_LANE_CHANGES, revoke_person);
}
