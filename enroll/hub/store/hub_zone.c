#include "enroll/hub/store/hub_zone.h"

#include <errno.h>
#include <sodium.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/hub/store/hub_act.h"
#include "enroll/hub/store/hub_change.h"
#include "enroll/hub/store/hub_policy.h"
#include "firmware/fleet/message/lease.h"

/* What a transaction of this file works with. */
struct work {
    struct hub_store *store;
    struct iso_fleet_id id;
    const char *name, *document;
    const struct hub_zone_settings *settings;
    bool on, all;
};

static int add(void *context, struct iso_fault *fault)
{
    static const uint8_t zeros[ISO_FLEET_DIGEST_BYTES];
    const struct work *w = context;
    struct iso_fleet_zone_key key;
    struct iso_fleet_bytes sealed = {.bytes = NULL};
    struct hub_values values = {.n = 0};
    int error = hub__zone_key_make(w->store, &w->id, &key, &sealed, fault);
    if (error) {
        return error;
    }
    sodium_memzero(&key, sizeof key);
    hub_value_id(&values, &w->id);
    hub_value_text(&values, w->name);
    hub_value_bytes(&values, zeros, sizeof zeros);
    hub_value_bytes(&values, sealed.bytes, sealed.size);
    hub_value_integer(&values, ISO_FLEET_LEASE_DEFAULT_S);
    error = hub_db_run(w->store->db,
                       "INSERT INTO zone (id, name, digest, base_digest, key, lease_s) "
                       "VALUES ($1, $2, $3, $3, $4, $5)",
                       &values, NULL, fault);
    iso_fleet_bytes_free(&sealed);
    if (error == -EEXIST) {
        return iso_fault_set(fault, error, "%s: there is a zone of this name", w->name);
    }
    return error ? error : hub__act_add(w->store, "zone-add", w->name, NULL, NULL, fault);
}

int hub_zone_add(struct hub_store *store, const char *name, struct iso_fleet_id *out,
                 struct iso_fault *fault)
{
    char taken[HUB_NAME_SIZE];
    struct work w = {.store = store, .id = iso_fleet_id_random(), .name = taken};
    int error = hub_name_take("zone", name, taken, fault);
    error = error ? error : hub_db_transaction(store->db, HUB_READ_COMMITTED, add, &w, fault);
    if (!error) {
        *out = w.id;
    }
    return error;
}

static json_t *settings_json(const struct hub_zone_settings *settings)
{
    return json_pack("{s:I,s:b,s:b}", "lease_s", (json_int_t)settings->lease_s, "local_people",
                     settings->local_people, "approve_auto", settings->approve_auto);
}

/* The settings before a change, and the zone's name. */
static int settings_before(struct hub_store *store, const struct iso_fleet_id *id,
                           struct hub_zone *out, struct iso_fault *fault)
{
    char text[ISO_FLEET_ID_TEXT_SIZE];
    return hub_zone_find(store, iso_fleet_id_text(id, text), out, fault);
}

static int set(void *context, struct iso_fault *fault)
{
    const struct work *w = context;
    struct hub_zone before;
    struct hub_values values = {.n = 0};
    int error = settings_before(w->store, &w->id, &before, fault);
    if (error) {
        return error;
    }
    hub_value_id(&values, &w->id);
    hub_value_integer(&values, w->settings->lease_s);
    hub_value_switch(&values, w->settings->local_people);
    hub_value_switch(&values, w->settings->approve_auto);
    error = hub_db_run(w->store->db,
                       "UPDATE zone SET lease_s = $2, local_people = $3, approve_auto = $4 "
                       "WHERE id = $1",
                       &values, NULL, fault);
    return error ? error
                 : hub__act_add(w->store, "zone-set", before.name, settings_json(&before.settings),
                                settings_json(w->settings), fault);
}

int hub_zone_set(struct hub_store *store, const struct iso_fleet_id *zone,
                 const struct hub_zone_settings *settings, struct iso_fault *fault)
{
    struct work w = {.store = store, .id = *zone, .settings = settings};
    return hub_db_transaction(store->db, HUB_READ_COMMITTED, set, &w, fault);
}

/* Documents are long, so the act has their digests. */
static json_t *digest_json(const char *document)
{
    uint8_t digest[ISO_FLEET_DIGEST_BYTES];
    char text[2 * sizeof digest + 1];
    iso_fleet_digest(document, strlen(document), digest);
    return *document ? json_string(sodium_bin2hex(text, sizeof text, digest, sizeof digest))
                     : json_string("");
}

static int set_policy(void *context, struct iso_fault *fault)
{
    const struct work *w = context;
    const struct iso_fleet_change change = {
        .kind = ISO_FLEET_POLICY, .policy = w->document, .policy_length = strlen(w->document)};
    struct hub__zone zone;
    struct hub_values values = {.n = 0};
    char *before = NULL;
    int error = hub__zone_lock(w->store, &w->id, &zone, fault);
    error = error ? error : hub_zone_get_policy(w->store, &w->id, &before, fault);
    error = error ? error : hub__zone_append(w->store, &zone, &change, fault);
    hub_value_id(&values, &w->id);
    hub_value_text(&values, w->document);
    error = error ? error
                  : hub_db_run(w->store->db, "UPDATE zone SET policy = $2 WHERE id = $1", &values,
                               NULL, fault);
    error = error ? error
                  : hub__act_add(w->store, "zone-policy", zone.name, digest_json(before),
                                 digest_json(w->document), fault);
    free(before);
    hub__zone_wipe(&zone);
    return error;
}

int hub_zone_set_policy(struct hub_store *store, const struct iso_fleet_id *zone,
                        const char *document, struct iso_fault *fault)
{
    struct work w = {.store = store, .id = *zone, .document = document};
    const int error = hub__policy_check(document, fault);
    return error ? error : hub_db_transaction(store->db, HUB_READ_COMMITTED, set_policy, &w, fault);
}

static int lock_down(const struct work *w, const struct iso_fleet_id *id, struct iso_fault *fault)
{
    const struct iso_fleet_change change = {.kind = ISO_FLEET_LOCKDOWN, .lockdown = w->on};
    struct hub__zone zone;
    struct hub_values values = {.n = 0};
    int error = hub__zone_lock(w->store, id, &zone, fault);
    if (error || zone.lockdown == w->on) {
        hub__zone_wipe(&zone);
        return error;
    }
    hub_value_id(&values, id);
    hub_value_switch(&values, w->on);
    error = hub__zone_append(w->store, &zone, &change, fault);
    error = error ? error
                  : hub_db_run(w->store->db, "UPDATE zone SET lockdown = $2 WHERE id = $1", &values,
                               NULL, fault);
    error = error ? error
                  : hub__act_add(w->store, "lockdown", zone.name, json_boolean(zone.lockdown),
                                 json_boolean(w->on), fault);
    hub__zone_wipe(&zone);
    return error;
}

static int lockdown(void *context, struct iso_fault *fault)
{
    const struct work *w = context;
    PGresult *rows = NULL;
    if (!w->all) {
        return lock_down(w, &w->id, fault);
    }
    int error = hub_db_run(w->store->db, "SELECT id FROM zone ORDER BY id", NULL, &rows, fault);
    for (int i = 0; !error && i < PQntuples(rows); i++) {
        const struct iso_fleet_id id = hub_row_id(rows, i, 0);
        error = lock_down(w, &id, fault);
    }
    PQclear(rows);
    return error;
}

int hub_zone_lockdown(struct hub_store *store, const struct iso_fleet_id *zone, bool on,
                      struct iso_fault *fault)
{
    struct work w = {.store = store, .on = on, .all = !zone};
    if (zone) {
        w.id = *zone;
    }
    return hub_db_transaction(store->db, HUB_READ_COMMITTED, lockdown, &w, fault);
}
