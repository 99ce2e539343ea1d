/* Zones and doors. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/hub/api/api_inner.h"
#include "enroll/hub/store/hub_door.h"
#include "enroll/hub/store/hub_zone.h"

static int add_zone(void *context, const struct hub_zone *zone)
{
    return json_array_append_new(
               context,
               json_pack("{s:o, s:s, s:I, s:I, s:b, s:b, s:I, s:b, s:b, s:I, s:I, s:I}", "id",
                         hub__api_id(&zone->place.zone), "name", zone->name, "epoch",
                         (json_int_t)zone->place.epoch, "sequence",
                         (json_int_t)zone->place.sequence, "lockdown", zone->lockdown, "behind",
                         zone->behind, "lease", (json_int_t)zone->settings.lease_s, "local-people",
                         zone->settings.local_people, "approve-auto", zone->settings.approve_auto,
                         "published", (json_int_t)zone->published, "people",
                         (json_int_t)zone->people, "doors", (json_int_t)zone->doors))
               ? -ENOMEM
               : 0;
}

void hub__api_list_zones(void *context, struct web_exchange *exchange)
{
    const struct hub_api *api = context;
    struct iso_fault fault = {.text = ""};
    json_t *list = json_array();
    const int r = hub_zone_each(api->store, add_zone, list, &fault);

    hub__api_list(exchange, "zones", list, r, &fault);
}

/* ---- doors ---- */

/* The ids of zones, and of the doors that have not confirmed one of them. */
struct ids {
    size_t n;
    struct iso_fleet_id *items;
};

static int add_id(struct ids *ids, const struct iso_fleet_id *id)
{
    struct iso_fleet_id *larger = reallocarray(ids->items, ids->n + 1, sizeof *larger);

    if (!larger) {
        return -ENOMEM;
    }
    ids->items = larger;
    ids->items[ids->n++] = *id;
    return 0;
}

static int add_zone_id(void *context, const struct hub_zone *zone)
{
    return add_id(context, &zone->place.zone);
}

static int add_behind(void *context, const struct hub_behind *door)
{
    return add_id(context, &door->door);
}

static int compare(const void *a, const void *b)
{
    return memcmp(a, b, sizeof(struct iso_fleet_id));
}

/* The doors that have not confirmed, sorted. */
static int find_behind(struct hub_store *store, struct ids *behind, struct iso_fault *fault)
{
    struct ids zones = {.n = 0};
    int r = hub_zone_each(store, add_zone_id, &zones, fault);

    for (size_t i = 0; r == 0 && i < zones.n; i++) {
        r = hub_doors_behind(store, &zones.items[i], add_behind, behind, fault);
    }
    free(zones.items);
    if (behind->n > 0) {
        qsort(behind->items, behind->n, sizeof *behind->items, compare);
    }
    return r;
}

struct doors {
    json_t *list;
    struct ids behind;
};

static json_t *door_json(const struct hub_door *door, bool is_confirmed)
{
    json_t *zones = json_array(), *health = json_loads(door->health, 0, NULL);

    for (size_t i = 0; i < door->n_zones; i++) {
        (void)json_array_append_new(zones, json_string(door->zone_names[i]));
    }
    return json_pack("{s:o, s:s, s:o, s:I, s:I, s:b, s:b, s:I, s:I, s:I, s:I, s:I, s:o}", "id",
                     hub__api_id(&door->id), "name", door->name, "zones", zones, "joined",
                     (json_int_t)door->joined_s, "expelled", (json_int_t)door->expelled_s, "online",
                     door->online, "confirmed", is_confirmed, "reported",
                     (json_int_t)door->reported_s, "door-time", (json_int_t)door->door_time_s,
                     "algorithm", (json_int_t)door->algorithm, "last-event",
                     (json_int_t)door->last_event, "acked", (json_int_t)door->acked, "health",
                     health ? health : json_object());
}

static int add_door(void *context, const struct hub_door *door)
{
    struct doors *doors = context;
    const bool is_behind = doors->behind.n > 0 &&
                           bsearch(&door->id, doors->behind.items, doors->behind.n,
                                   sizeof *doors->behind.items, compare) != NULL;

    return json_array_append_new(doors->list, door_json(door, !is_behind && door->joined_s != 0))
               ? -ENOMEM
               : 0;
}

void hub__api_list_doors(void *context, struct web_exchange *exchange)
{
    const struct hub_api *api = context;
    struct iso_fault fault = {.text = ""};
    struct doors doors = {.list = json_array()};
    int r = find_behind(api->store, &doors.behind, &fault);

    r = r ? r : hub_door_each(api->store, false, add_door, &doors, &fault);
    free(doors.behind.items);
    hub__api_list(exchange, "doors", doors.list, r, &fault);
}

/* ---- lockdown ---- */

static void set_lockdown(struct hub_api *api, struct web_exchange *exchange, const char *name)
{
    const json_t *on = json_object_get(web_exchange_body(exchange), "on");
    struct iso_fault fault = {.text = ""};
    struct hub__api_actor actor;
    struct hub_zone zone;

    if (!json_is_boolean(on)) {
        web_exchange_problem(exchange, 400, "invalid-member", "on has to be true or false");
        return;
    }
    int r = name ? hub_zone_find(api->store, name, &zone, &fault) : 0;
    if (r == 0) {
        hub__api_act(api, exchange, &actor);
        r = hub_zone_lockdown(api->store, name ? &zone.place.zone : NULL, json_is_true(on), &fault);
        hub__api_acted(api, &actor);
    }
    if (r) {
        hub__api_problem(exchange, r, &fault);
    } else {
        web_exchange_done(exchange);
    }
}

void hub__api_zone_lockdown(void *context, struct web_exchange *exchange)
{
    set_lockdown(context, exchange, web_exchange_part(exchange));
}

void hub__api_lockdown(void *context, struct web_exchange *exchange)
{
    set_lockdown(context, exchange, NULL);
}
