#include "enroll/hub/api/look.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

int hub__no_memory(struct iso_fault *fault)
{
    return iso_fault_set(fault, -ENOMEM, "out of memory");
}

static int absent(struct hub_call *call, int error, const char *code)
{
    if (error == -ENOENT) {
        call->absent = code;
    }
    return error;
}

int hub__look_zone(struct hub_call *call, struct hub_store *store, const char *name_or_id,
                   struct hub_zone *out, struct iso_fault *fault)
{
    return absent(call, hub_zone_find(store, name_or_id, out, fault), "no-such-zone");
}

int hub__look_door(struct hub_call *call, struct hub_store *store, const char *name_or_id,
                   struct hub_door *out, struct iso_fault *fault)
{
    return absent(call, hub_door_find(store, name_or_id, out, fault), "no-such-door");
}

int hub__look_person(struct hub_call *call, struct hub_store *store, const char *name_or_id,
                     struct hub_person *out, struct iso_fault *fault)
{
    return absent(call, hub_person_find(store, name_or_id, out, fault), "no-such-person");
}

int hub__look_request(struct hub_call *call, struct hub_store *store, const char *name_or_id,
                      struct hub_request *out, struct iso_fault *fault)
{
    return absent(call, hub_request_find(store, name_or_id, out, fault), "no-such-request");
}

int hub__look_zones(struct hub_call *call, struct hub_store *store, size_t most, bool *has,
                    struct iso_fleet_id *out, size_t *n, struct iso_fault *fault)
{
    const json_t *list = json_object_get(web_exchange_body(call->request), "zones"), *value;
    struct hub_zone zone;
    size_t i;
    int error = 0;

    *n = 0;
    *has = list != NULL;
    if (!list) {
        return 0;
    }
    if (!json_is_array(list) || json_array_size(list) == 0 || json_array_size(list) > most) {
        return hub__call_refuse(call, fault, 400, "invalid-member",
                                "zones has to be a list of names or ids, of at least one and not "
                                "too many zones");
    }
    json_array_foreach(list, i, value)
    {
        if (!json_is_string(value)) {
            return hub__call_refuse(call, fault, 400, "invalid-member",
                                    "a zone is named by a text");
        }
        error = hub__look_zone(call, store, json_string_value(value), &zone, fault);
        if (error) {
            return error;
        }
        out[(*n)++] = zone.place.zone;
    }
    return 0;
}

/* ---- doors that have not confirmed ---- */

struct pair {
    struct iso_fleet_id door, zone;
};

struct hub_waits {
    size_t n, room;
    struct pair *pairs; /* sorted */
    struct iso_fleet_id zone;
};

static int compare(const void *a, const void *b)
{
    return memcmp(a, b, sizeof(struct pair));
}

static int add_pair(void *context, const struct hub_behind *door)
{
    struct hub_waits *waits = context;

    if (waits->n == waits->room) {
        const size_t room = waits->room ? 2 * waits->room : 64;
        struct pair *more = reallocarray(waits->pairs, room, sizeof *more);
        if (!more) {
            return -ENOMEM;
        }
        waits->pairs = more;
        waits->room = room;
    }
    waits->pairs[waits->n++] = (struct pair){.door = door->door, .zone = waits->zone};
    return 0;
}

struct zone_ids {
    size_t n, room;
    struct iso_fleet_id *ids;
};

static int add_zone(void *context, const struct hub_zone *zone)
{
    struct zone_ids *zones = context;

    if (zones->n == zones->room) {
        const size_t room = zones->room ? 2 * zones->room : 64;
        struct iso_fleet_id *more = reallocarray(zones->ids, room, sizeof *more);
        if (!more) {
            return -ENOMEM;
        }
        zones->ids = more;
        zones->room = room;
    }
    zones->ids[zones->n++] = zone->place.zone;
    return 0;
}

int hub__waits_read(struct hub_store *store, struct hub_waits **out, struct iso_fault *fault)
{
    struct hub_waits *waits = calloc(1, sizeof *waits);
    struct zone_ids zones = {.n = 0};
    int error = waits ? hub_zone_each(store, add_zone, &zones, fault) : hub__no_memory(fault);

    for (size_t i = 0; !error && i < zones.n; i++) {
        waits->zone = zones.ids[i];
        error = hub_doors_behind(store, &zones.ids[i], add_pair, waits, fault);
    }
    free(zones.ids);
    if (error) {
        hub__waits_free(waits);
        return error == -ENOMEM ? hub__no_memory(fault) : error;
    }
    if (waits->n > 0) {
        qsort(waits->pairs, waits->n, sizeof *waits->pairs, compare);
    }
    *out = waits;
    return 0;
}

void hub__waits_free(struct hub_waits *waits)
{
    if (waits) {
        free(waits->pairs);
        free(waits);
    }
}

bool hub__waits_for(const struct hub_waits *waits, const struct iso_fleet_id *door,
                    const struct iso_fleet_id *zone)
{
    const struct pair wanted = {.door = *door, .zone = *zone};

    return waits->n > 0 &&
           bsearch(&wanted, waits->pairs, waits->n, sizeof *waits->pairs, compare) != NULL;
}
