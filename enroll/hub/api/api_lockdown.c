/* Lockdown of a zone or of all zones, and which doors have not confirmed it. */
#include <errno.h>
#include <stdlib.h>

#include "enroll/hub/api/api.h"
#include "enroll/hub/api/look.h"

struct found {
    size_t n, room;
    struct iso_fleet_id *ids;
};

static int add(void *context, const struct hub_zone *zone)
{
    struct found *found = context;

    if (found->n == found->room) {
        const size_t room = found->room ? 2 * found->room : 64;
        struct iso_fleet_id *more = reallocarray(found->ids, room, sizeof *more);
        if (!more) {
            return -ENOMEM;
        }
        found->ids = more;
        found->room = room;
    }
    found->ids[found->n++] = zone->place.zone;
    return 0;
}

/* All zones, each with the doors that have not confirmed its place. */
static int show(struct hub_call *call, struct hub_store *store, struct iso_fault *fault)
{
    struct found found = {.n = 0};
    json_t *zones = NULL;
    int error = hub_zone_each(store, add, &found, fault);

    error = error == -ENOMEM ? hub__no_memory(fault) : error;
    error = error ? error : hub__json_zones_waiting(store, found.ids, found.n, &zones, fault);
    free(found.ids);
    if (error) {
        return error;
    }
    call->json = json_pack("{s:o}", "zones", zones);
    return call->json ? 0 : hub__no_memory(fault);
}

void hub__api_get_lockdown(void *api, struct web_exchange *exchange)
{
    hub__call(api, exchange, HUB_LANE_LOOKS, show);
}

static int set(struct hub_call *call, struct hub_store *store, struct iso_fault *fault)
{
    const json_t *named = json_object_get(web_exchange_body(call->request), "zone");
    struct hub_zone zone;
    bool has = false, on = false;
    int error = hub__call_flag(call, "on", &has, &on, fault);

    if (!error && !has) {
        return hub__call_refuse(call, fault, 400, "invalid-member", "on has to be true or false");
    }
    if (!error && named) {
        const char *name = hub__call_text(call, "zone", HUB_NAME_SIZE - 1, &error, fault);
        error = name ? hub__look_zone(call, store, name, &zone, fault) : error;
    }
    error = error ? error : hub_zone_lockdown(store, named ? &zone.place.zone : NULL, on, fault);
    return error ? error : show(call, store, fault);
}

void hub__api_set_lockdown(void *api, struct web_exchange *exchange)
{
    hub__call(api, exchange, HUB_LANE_CHANGES, set);
}
