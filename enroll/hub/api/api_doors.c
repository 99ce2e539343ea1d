/* Doors: how they are, how they join, and how they leave. */
#include <errno.h>
#include <sodium.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/hub/api/api.h"
#include "enroll/hub/api/hub_join_address.h"
#include "enroll/hub/api/look.h"

struct list {
    json_t *doors;
    const struct hub_waits *waits;
    int64_t now_s;
};

static int append_door(void *context, const struct hub_door *door)
{
    const struct list *list = context;

    return json_array_append_new(list->doors, hub__json_door(door, list->waits, list->now_s, false))
               ? -ENOMEM
               : 0;
}

static int list_doors(struct hub_call *call, struct hub_store *store, struct iso_fault *fault)
{
    struct list list = {.doors = json_array(), .now_s = store->now_s()};
    struct hub_waits *waits = NULL;
    int error = hub__waits_read(store, &waits, fault);

    list.waits = waits;
    error = error
                ? error
                : hub_door_each(store, hub__call_asks(call, "expelled"), append_door, &list, fault);
    hub__waits_free(waits);
    call->json = json_pack("{s:o}", "doors", list.doors);
    return error == -ENOMEM ? hub__no_memory(fault) : error;
}

void hub__api_list_doors(void *api, struct web_exchange *exchange)
{
    hub__call(api, exchange, HUB_LANE_LOOKS, list_doors);
}

static int show(struct hub_call *call, struct hub_store *store, const char *name_or_id,
                struct iso_fault *fault)
{
    struct hub_door door;
    struct hub_waits *waits = NULL;
    int error = hub__look_door(call, store, name_or_id, &door, fault);

    error = error ? error : hub__waits_read(store, &waits, fault);
    if (!error) {
        call->json = hub__json_door(&door, waits, store->now_s(), true);
        error = call->json ? 0 : hub__no_memory(fault);
    }
    hub__waits_free(waits);
    return error;
}

static int show_id(struct hub_call *call, struct hub_store *store, const struct iso_fleet_id *id,
                   struct iso_fault *fault)
{
    char text[ISO_FLEET_ID_TEXT_SIZE];

    return show(call, store, iso_fleet_id_text(id, text), fault);
}

static int get_door(struct hub_call *call, struct hub_store *store, struct iso_fault *fault)
{
    return show(call, store, web_exchange_part(call->request), fault);
}

void hub__api_get_door(void *api, struct web_exchange *exchange)
{
    hub__call(api, exchange, HUB_LANE_LOOKS, get_door);
}

/* Adds the member "join" with the address, once: only the door that is made knows the code. */
static int show_join(struct hub_call *call, struct hub_store *store, const struct iso_fleet_id *id,
                     const char *code, struct iso_fault *fault)
{
    const struct hub_api *api = call->api;
    char address[HUB_JOIN_ADDRESS_SIZE];
    int error = show_id(call, store, id, fault);

    if (error) {
        return error;
    }
    if (hub_join_address(api->host, api->port, api->ca_digest, code, address)) {
        return iso_fault_set(fault, -EIO, "the name of the hub is too long for a join address");
    }
    char *svg = hub_qr_svg(address);
    json_t *join = svg ? json_pack("{s:s, s:s, s:I}", "address", address, "qr_svg", svg, "until_s",
                                   (json_int_t)store->now_s() + HUB_CODE_VALID_S)
                       : NULL;
    error = json_object_set_new(call->json, "join", join) ? hub__no_memory(fault) : 0;
    free(svg);
    sodium_memzero(address, sizeof address);
    return error;
}

static int add_door(struct hub_call *call, struct hub_store *store, struct iso_fault *fault)
{
    struct iso_fleet_id zones[ISO_FLEET_ZONES_MAX], id;
    char code[HUB_CODE_SIZE];
    bool has = false;
    size_t n = 0;
    int error = 0;
    const char *name = hub__call_text(call, "name", HUB_NAME_SIZE - 1, &error, fault);

    error = name ? hub__look_zones(call, store, ISO_FLEET_ZONES_MAX, &has, zones, &n, fault)
                 : error;
    error = error ? error : hub_door_add(store, name, zones, n, &id, code, fault);
    if (!error) {
        call->status = 201;
        error = show_join(call, store, &id, code, fault);
        sodium_memzero(code, sizeof code);
    }
    return error;
}

void hub__api_add_door(void *api, struct web_exchange *exchange)
{
    hub__call(api, exchange, HUB_LANE_CHANGES, add_door);
}

static int new_code(struct hub_call *call, struct hub_store *store, struct iso_fault *fault)
{
    struct hub_door door;
    char code[HUB_CODE_SIZE];
    int error = hub__look_door(call, store, web_exchange_part(call->request), &door, fault);

    error = error ? error : hub_door_new_code(store, &door.id, code, fault);
    if (!error) {
        call->status = 201;
        error = show_join(call, store, &door.id, code, fault);
        sodium_memzero(code, sizeof code);
    }
    return error;
}

void hub__api_new_code(void *api, struct web_exchange *exchange)
{
    hub__call(api, exchange, HUB_LANE_CHANGES, new_code);
}

static int change_door(struct hub_call *call, struct hub_store *store, struct iso_fault *fault)
{
    struct iso_fleet_id zones[ISO_FLEET_ZONES_MAX];
    struct hub_door door;
    bool has = false;
    size_t n = 0;
    int error = hub__look_door(call, store, web_exchange_part(call->request), &door, fault);

    error = error ? error
                  : hub__look_zones(call, store, ISO_FLEET_ZONES_MAX, &has, zones, &n, fault);
    error = error || !has ? error : hub_door_move(store, &door.id, zones, n, fault);
    if (error == -EALREADY) {
        call->refusal = (struct web_problem){409, "door-expelled", NULL};
    }
    return error ? error : show_id(call, store, &door.id, fault);
}

void hub__api_change_door(void *api, struct web_exchange *exchange)
{
    hub__call(api, exchange, HUB_LANE_CHANGES, change_door);
}

/* The doors of the zones that it leaves get new keys; the answer says which do not have them yet.
 */
static int expel_door(struct hub_call *call, struct hub_store *store, struct iso_fault *fault)
{
    struct hub_door door;
    json_t *zones = NULL;
    int error = hub__look_door(call, store, web_exchange_part(call->request), &door, fault);

    error = error ? error : hub_door_expel(store, &door.id, fault);
    error = error ? error : hub__json_zones_waiting(store, door.zones, door.n_zones, &zones, fault);
    if (!error) {
        call->json = json_pack("{s:o}", "zones", zones);
    }
    return error;
}

void hub__api_expel_door(void *api, struct web_exchange *exchange)
{
    hub__call(api, exchange, HUB_LANE_CHANGES, expel_door);
}
