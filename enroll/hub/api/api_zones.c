/* Zones: what holds in them, their policy, their epochs. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/hub/api/api.h"
#include "enroll/hub/api/look.h"

enum { LEASE_MOST_S = 366 * 86400 };

static int append_zone(void *list, const struct hub_zone *zone)
{
    return json_array_append_new(list, hub__json_zone(zone)) ? -ENOMEM : 0;
}

static int list_zones(struct hub_call *call, struct hub_store *store, struct iso_fault *fault)
{
    json_t *list = json_array();
    const int error = hub_zone_each(store, append_zone, list, fault);

    call->json = json_pack("{s:o}", "zones", list);
    return error == -ENOMEM ? hub__no_memory(fault) : error;
}

void hub__api_list_zones(void *api, struct web_exchange *exchange)
{
    hub__call(api, exchange, HUB_LANE_LOOKS, list_zones);
}

/* Answers with a zone as it is now. */
static int show(struct hub_call *call, struct hub_store *store, const char *name_or_id,
                struct iso_fault *fault)
{
    struct hub_zone zone;
    json_t *doors = NULL;
    int error = hub__look_zone(call, store, name_or_id, &zone, fault);

    error = error ? error : hub__json_unconfirmed(store, &zone.place.zone, &doors, fault);
    if (error) {
        return error;
    }
    call->json = hub__json_zone(&zone);
    return json_object_set_new(call->json, "unconfirmed", doors) ? hub__no_memory(fault) : 0;
}

static int show_id(struct hub_call *call, struct hub_store *store, const struct iso_fleet_id *id,
                   struct iso_fault *fault)
{
    char text[ISO_FLEET_ID_TEXT_SIZE];

    return show(call, store, iso_fleet_id_text(id, text), fault);
}

static int add_zone(struct hub_call *call, struct hub_store *store, struct iso_fault *fault)
{
    struct iso_fleet_id id;
    int error = 0;
    const char *name = hub__call_text(call, "name", HUB_NAME_SIZE - 1, &error, fault);

    error = name ? hub_zone_add(store, name, &id, fault) : error;
    call->status = 201;
    return error ? error : show_id(call, store, &id, fault);
}

void hub__api_add_zone(void *api, struct web_exchange *exchange)
{
    hub__call(api, exchange, HUB_LANE_CHANGES, add_zone);
}

static int get_zone(struct hub_call *call, struct hub_store *store, struct iso_fault *fault)
{
    return show(call, store, web_exchange_part(call->request), fault);
}

void hub__api_get_zone(void *api, struct web_exchange *exchange)
{
    hub__call(api, exchange, HUB_LANE_LOOKS, get_zone);
}

static int change_zone(struct hub_call *call, struct hub_store *store, struct iso_fault *fault)
{
    struct hub_zone zone;
    bool has_lease, has_local, has_auto;
    int error = hub__look_zone(call, store, web_exchange_part(call->request), &zone, fault);

    if (error) {
        return error;
    }
    struct hub_zone_settings settings = zone.settings;
    int64_t lease_s = settings.lease_s;
    error = hub__call_number(call, "lease_s", LEASE_MOST_S, &has_lease, &lease_s, fault);
    error = error ? error
                  : hub__call_flag(call, "local_people", &has_local, &settings.local_people, fault);
    error = error ? error
                  : hub__call_flag(call, "approve_auto", &has_auto, &settings.approve_auto, fault);
    settings.lease_s = (uint32_t)lease_s;
    error = error ? error : hub_zone_set(store, &zone.place.zone, &settings, fault);
    return error ? error : show_id(call, store, &zone.place.zone, fault);
}

void hub__api_change_zone(void *api, struct web_exchange *exchange)
{
    hub__call(api, exchange, HUB_LANE_CHANGES, change_zone);
}

/* ---- the policy ---- */

static int get_policy(struct hub_call *call, struct hub_store *store, struct iso_fault *fault)
{
    struct hub_zone zone;
    char *document = NULL;
    int error = hub__look_zone(call, store, web_exchange_part(call->request), &zone, fault);

    error = error ? error : hub_zone_get_policy(store, &zone.place.zone, &document, fault);
    if (error) {
        return error;
    }
    json_t *policy = *document ? json_loads(document, 0, NULL) : NULL;
    call->json = json_pack("{s:o}", "document", policy ? policy : json_null());
    free(document);
    return call->json ? 0 : hub__no_memory(fault);
}

void hub__api_get_policy(void *api, struct web_exchange *exchange)
{
    hub__call(api, exchange, HUB_LANE_LOOKS, get_policy);
}

static int set_policy(struct hub_call *call, struct hub_store *store, struct iso_fault *fault)
{
    const json_t *document = json_object_get(web_exchange_body(call->request), "document");
    struct hub_zone zone;
    int error = hub__look_zone(call, store, web_exchange_part(call->request), &zone, fault);

    if (error) {
        return error;
    }
    if (!json_is_object(document) && !json_is_null(document)) {
        return hub__call_refuse(call, fault, 400, "invalid-member",
                                "document has to be an object, or null for no policy");
    }
    char *text = json_is_null(document) ? strdup("") : json_dumps(document, JSON_COMPACT);
    error = text ? hub_zone_set_policy(store, &zone.place.zone, text, fault)
                 : hub__no_memory(fault);
    free(text);
    if (error == -EINVAL) {
        call->refusal = (struct web_problem){400, "invalid-policy", NULL};
    }
    return error ? error : show_id(call, store, &zone.place.zone, fault);
}

void hub__api_set_policy(void *api, struct web_exchange *exchange)
{
    hub__call(api, exchange, HUB_LANE_CHANGES, set_policy);
}

/* ---- epochs ---- */

static int renew_zone(struct hub_call *call, struct hub_store *store, struct iso_fault *fault)
{
    struct hub_zone zone;
    int error = hub__look_zone(call, store, web_exchange_part(call->request), &zone, fault);

    error = error ? error : hub_zone_new_epoch(store, &zone.place.zone, fault);
    return error ? error : show_id(call, store, &zone.place.zone, fault);
}

void hub__api_renew_zone(void *api, struct web_exchange *exchange)
{
    hub__call(api, exchange, HUB_LANE_CHANGES, renew_zone);
}

static int recover_zone(struct hub_call *call, struct hub_store *store, struct iso_fault *fault)
{
    struct hub_zone zone;
    int error = hub__look_zone(call, store, web_exchange_part(call->request), &zone, fault);

    error = error ? error : hub_zone_recover(store, &zone.place.zone, fault);
    return error ? error : show_id(call, store, &zone.place.zone, fault);
}

void hub__api_recover_zone(void *api, struct web_exchange *exchange)
{
    hub__call(api, exchange, HUB_LANE_CHANGES, recover_zone);
}
