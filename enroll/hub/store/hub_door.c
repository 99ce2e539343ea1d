#include "enroll/hub/store/hub_door.h"

#include <errno.h>
#include <sodium.h>
#include <string.h>

#include "enroll/hub/store/hub_act.h"
#include "enroll/hub/store/hub_change.h"
#include "enroll/hub/store/hub_code.h"

struct work {
    struct hub_store *store;
    struct iso_fleet_id id;
    const char *name;
    const struct iso_fleet_id *zones;
    size_t n_zones;
    uint8_t code_digest[ISO_FLEET_DIGEST_BYTES];
};

static json_t *zones_json(struct hub_store *store, const struct iso_fleet_id *id)
{
    struct hub_door door;
    json_t *names = json_array();
    if (hub_door_get(store, id, &door, NULL) == 0) {
        for (size_t i = 0; i < door.n_zones; i++) {
            (void)json_array_append_new(names, json_string(door.zone_names[i]));
        }
    }
    return names;
}

static int check_zones(const struct iso_fleet_id *zones, size_t n, struct iso_fault *fault)
{
    if (n == 0 || n > ISO_FLEET_ZONES_MAX) {
        return iso_fault_set(fault, -EINVAL, "a door has 1 to %d zones", ISO_FLEET_ZONES_MAX);
    }
    for (size_t i = 0; i < n; i++) {
        for (size_t k = 0; k < i; k++) {
            if (iso_fleet_id_is_same(&zones[i], &zones[k])) {
                return iso_fault_set(fault, -EINVAL, "a door is in each zone once");
            }
        }
    }
    return 0;
}

/* Stores the zones of a door in their order. */
static int put_zones(const struct work *w, struct iso_fault *fault)
{
    struct hub_values door = {.n = 0};
    hub_value_id(&door, &w->id);
    int error = hub_db_run(w->store->db, "DELETE FROM door_zone WHERE door = $1", &door, NULL,
                           fault);
    for (size_t i = 0; !error && i < w->n_zones; i++) {
        struct hub_values values = {.n = 0};
        hub_value_id(&values, &w->id);
        hub_value_id(&values, &w->zones[i]);
        hub_value_integer(&values, (int64_t)i);
        error = hub_db_run(w->store->db,
                           "INSERT INTO door_zone (door, zone, position) VALUES ($1, $2, $3)",
                           &values, NULL, fault);
        if (error == -ENOENT) {
            return iso_fault_set(fault, error, "there is no such zone");
        }
    }
    return error;
}

static int add(void *context, struct iso_fault *fault)
{
    const struct work *w = context;
    struct hub_values values = {.n = 0};
    const int64_t now_s = w->store->now_s();
    hub_value_id(&values, &w->id);
    hub_value_text(&values, w->name);
    hub_value_integer(&values, now_s);
    hub_value_bytes(&values, w->code_digest, sizeof w->code_digest);
    hub_value_integer(&values, now_s + HUB_CODE_VALID_S);
    int error = hub_db_run(w->store->db,
                           "INSERT INTO door (id, name, added_s, code_digest, code_until_s) "
                           "VALUES ($1, $2, $3, $4, $5)",
                           &values, NULL, fault);
    if (error == -EEXIST) {
        return iso_fault_set(fault, error, "%s: there is a door of this name", w->name);
    }
    error = error ? error : put_zones(w, fault);
    return error ? error
                 : hub__act_add(w->store, "door-add", w->name, NULL, zones_json(w->store, &w->id),
                                fault);
}

int hub_door_add(struct hub_store *store, const char *name, const struct iso_fleet_id *zones,
                 size_t n_zones, struct iso_fleet_id *out, char code[HUB_CODE_SIZE],
                 struct iso_fault *fault)
{
    char taken[HUB_NAME_SIZE], made[HUB_CODE_SIZE];
    struct work w = {.store = store,
                     .id = iso_fleet_id_random(),
                     .name = taken,
                     .zones = zones,
                     .n_zones = n_zones};
    int error = hub_name_take("door", name, taken, fault);
    error = error ? error : check_zones(zones, n_zones, fault);
    hub__code_make(made, w.code_digest);
    error = error ? error : hub_db_transaction(store->db, HUB_READ_COMMITTED, add, &w, fault);
    if (!error) {
        *out = w.id;
        memcpy(code, made, sizeof made);
    }
    sodium_memzero(made, sizeof made);
    return error;
}

/* Locks the row of a door that is not expelled. */
static int lock(struct hub_store *store, const struct iso_fleet_id *id, struct hub_door *out,
                struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    hub_value_id(&values, id);
    int error = hub_db_run(store->db, "SELECT id FROM door WHERE id = $1 FOR NO KEY UPDATE",
                           &values, NULL, fault);
    error = error ? error : hub_door_get(store, id, out, fault);
    if (!error && out->expelled_s) {
        return iso_fault_set(fault, -EALREADY, "%s: the door is expelled", out->name);
    }
    return error;
}

static int new_code(void *context, struct iso_fault *fault)
{
    const struct work *w = context;
    struct hub_door door;
    struct hub_values values = {.n = 0};
    int error = lock(w->store, &w->id, &door, fault);
    if (error) {
        return error == -EALREADY ? -EACCES : error;
    }
    hub_value_id(&values, &w->id);
    hub_value_bytes(&values, w->code_digest, sizeof w->code_digest);
    hub_value_integer(&values, w->store->now_s() + HUB_CODE_VALID_S);
    error = hub_db_run(w->store->db,
                       "UPDATE door SET code_digest = $2, code_until_s = $3 WHERE id = $1", &values,
                       NULL, fault);
    return error ? error : hub__act_add(w->store, "door-code", door.name, NULL, NULL, fault);
}

int hub_door_new_code(struct hub_store *store, const struct iso_fleet_id *door,
                      char code[HUB_CODE_SIZE], struct iso_fault *fault)
{
    char made[HUB_CODE_SIZE];
    struct work w = {.store = store, .id = *door};
    hub__code_make(made, w.code_digest);
    const int error = hub_db_transaction(store->db, HUB_READ_COMMITTED, new_code, &w, fault);
    if (!error) {
        memcpy(code, made, sizeof made);
    }
    sodium_memzero(made, sizeof made);
    return error;
}

static bool has_zone(const struct iso_fleet_id *zones, size_t n, const struct iso_fleet_id *zone)
{
    for (size_t i = 0; i < n; i++) {
        if (iso_fleet_id_is_same(&zones[i], zone)) {
            return true;
        }
    }
    return false;
}

/* Each zone of the door that is not among `kept` begins a new epoch. A door that has not joined
 * knows no key. */
static int leave_zones(struct hub_store *store, const struct hub_door *door,
                       const struct iso_fleet_id *kept, size_t n, struct iso_fault *fault)
{
    struct iso_fleet_id left[ISO_FLEET_ZONES_MAX];
    size_t n_left = 0;
    int error = 0;
    for (size_t i = 0; i < door->n_zones && door->joined_s; i++) {
        if (!has_zone(kept, n, &door->zones[i])) {
            left[n_left++] = door->zones[i];
        }
    }
    n_left = hub__ids_in_order(left, n_left);
    for (size_t i = 0; !error && i < n_left; i++) {
        struct hub_values values = {.n = 0};
        hub_value_id(&values, &door->id);
        hub_value_id(&values, &left[i]);
        error = hub__zone_renew(store, &left[i], fault);
        error = error
                    ? error
                    : hub_db_run(store->db, "DELETE FROM door_place WHERE door = $1 AND zone = $2",
                                 &values, NULL, fault);
    }
    return error;
}

static int move(void *context, struct iso_fault *fault)
{
    const struct work *w = context;
    struct hub_door door;
    int error = lock(w->store, &w->id, &door, fault);
    json_t *before = error ? NULL : zones_json(w->store, &w->id);
    error = error ? error : leave_zones(w->store, &door, w->zones, w->n_zones, fault);
    error = error ? error : put_zones(w, fault);
    if (error) {
        json_decref(before);
        return error;
    }
    return hub__act_add(w->store, "door-move", door.name, before, zones_json(w->store, &w->id),
                        fault);
}

int hub_door_move(struct hub_store *store, const struct iso_fleet_id *door,
                  const struct iso_fleet_id *zones, size_t n_zones, struct iso_fault *fault)
{
    struct work w = {.store = store, .id = *door, .zones = zones, .n_zones = n_zones};
    const int error = check_zones(zones, n_zones, fault);
    return error ? error : hub_db_transaction(store->db, HUB_READ_COMMITTED, move, &w, fault);
}

static int expel(void *context, struct iso_fault *fault)
{
    const struct work *w = context;
    struct hub_door door;
    struct hub_values values = {.n = 0};
    int error = lock(w->store, &w->id, &door, fault);
    error = error ? error : leave_zones(w->store, &door, NULL, 0, fault);
    if (error) {
        return error;
    }
    json_t *before = zones_json(w->store, &w->id);
    hub_value_id(&values, &w->id);
    hub_value_integer(&values, w->store->now_s());
    error = hub_db_run(w->store->db,
                       "WITH z AS (DELETE FROM door_zone WHERE door = $1) "
                       "UPDATE door SET expelled_s = $2, code_digest = NULL, code_until_s = 0, "
                       "online = false WHERE id = $1",
                       &values, NULL, fault);
    if (error) {
        json_decref(before);
        return error;
    }
    return hub__act_add(w->store, "door-expel", door.name, before, NULL, fault);
}

int hub_door_expel(struct hub_store *store, const struct iso_fleet_id *door,
                   struct iso_fault *fault)
{
    struct work w = {.store = store, .id = *door};
    return hub_db_transaction(store->db, HUB_READ_COMMITTED, expel, &w, fault);
}

int hub_door_set_online(struct hub_store *store, const struct iso_fleet_id *door, bool online,
                        struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    hub_value_id(&values, door);
    hub_value_switch(&values, online);
    return hub_db_run_often(store->db,
                            "UPDATE door SET online = $2 WHERE id = $1 AND expelled_s = 0 AND "
                            "online <> $2",
                            &values, NULL, fault);
}

int hub_door_all_offline(struct hub_store *store, struct iso_fault *fault)
{
    /* In the order of hub_take_letters(), which another hub may be calling. */
    return hub_db_run(store->db,
                      "UPDATE door SET online = false WHERE id IN "
                      "(SELECT id FROM door WHERE online ORDER BY id FOR NO KEY UPDATE)",
                      NULL, NULL, fault);
}
