#include "enroll/hub/people/hub_person.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/hub/people/hub_person_rows.h"
#include "enroll/hub/people/hub_spread.h"
#include "enroll/hub/store/hub_act.h"
#include "enroll/hub/store/hub_policy.h"
#include "firmware/contract/name_folding.h"
#include "firmware/contract/person_name.h"

/* What a transaction of this file works with. */
struct work {
    struct hub_store *store;
    struct iso_fleet_id id;
    const struct iso_fleet_person *person;
    const struct iso_fleet_id *zones;
    size_t n_zones;
    /* The change of one thing: its statement, whose $1 is the person, and what the act says. */
    int (*change)(const struct work *w, struct iso_fault *fault);
    const char *what, *value;
    int64_t from_s, until_s;
    bool ok;
};

static int check_zones(size_t n, struct iso_fault *fault)
{
    return n == 0 || n > HUB_PERSON_ZONES_MAX
               ? iso_fault_set(fault, -EINVAL, "a person is in 1 to %d zones", HUB_PERSON_ZONES_MAX)
               : 0;
}

static int put(void *context, struct iso_fault *fault)
{
    const struct work *w = context;
    struct hub__zones before = {.n = 0};
    bool is_new = false;
    int error = hub__person_lock(w->store, &w->id, &before, NULL, fault);
    error = error == -ENOENT ? 0 : error;
    error = error ? error : hub__person_store(w->store, w->person, &is_new, fault);
    error = error ? error : hub__person_put_zones(w->store, &w->id, w->zones, w->n_zones, fault);
    error = error ? error : hub__person_spread(w->store, &w->id, &before, fault);
    return error ? error
                 : hub__act_add(w->store, is_new ? "person-add" : "person-put",
                                hub__person_name(w->store, &w->id).text, NULL,
                                hub__person_json(w->store, &w->id), fault);
}

int hub_person_put(struct hub_store *store, const struct iso_fleet_person *person,
                   const struct iso_fleet_id *zones, size_t n_zones, struct iso_fault *fault)
{
    struct work w = {
        .store = store, .id = person->id, .person = person, .zones = zones, .n_zones = n_zones};
    char name[ISO_FLEET_NAME_MAX + 1];
    if (person->name_length > ISO_FLEET_NAME_MAX || iso_fleet_id_is_zero(&person->id)) {
        return iso_fault_set(fault, -EINVAL, "a person has an id and a name");
    }
    (void)snprintf(name, sizeof name, "%.*s", (int)person->name_length, person->name);
    if (!iso_person_name_can_be_stored(name)) {
        return iso_fault_set(fault, -EINVAL, "a person: %s",
                             iso_person_name_flaw(name) ? iso_person_name_flaw(name)
                                                        : "the name cannot be stored");
    }
    const int error = check_zones(n_zones, fault);
    return error ? error : hub_db_transaction(store->db, HUB_READ_COMMITTED, put, &w, fault);
}

/* Changes one thing of a person, and spreads it. */
static int change(void *context, struct iso_fault *fault)
{
    const struct work *w = context;
    struct hub__zones zones = {.n = 0};
    json_t *before = NULL;
    int error = hub__person_lock(w->store, &w->id, &zones, &before, fault);
    error = error ? error : w->change(w, fault);
    error = error ? error : hub__person_spread(w->store, &w->id, &zones, fault);
    if (error) {
        json_decref(before);
        return error;
    }
    return hub__act_add(w->store, w->what, hub__person_name(w->store, &w->id).text, before,
                        hub__person_json(w->store, &w->id), fault);
}

static int run_change(struct work *w, struct iso_fault *fault)
{
    return hub_db_transaction(w->store->db, HUB_READ_COMMITTED, change, w, fault);
}

static int change_validity(const struct work *w, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    hub_value_id(&values, &w->id);
    hub_value_integer(&values, w->from_s);
    hub_value_integer(&values, w->until_s);
    return hub_db_run(w->store->db,
                      "UPDATE person SET valid_from_s = $2, valid_until_s = $3 WHERE id = $1",
                      &values, NULL, fault);
}

int hub_person_set_validity(struct hub_store *store, const struct iso_fleet_id *person,
                            int64_t from_s, int64_t until_s, struct iso_fault *fault)
{
    struct work w = {.store = store,
                     .id = *person,
                     .change = change_validity,
                     .what = "person-validity",
                     .from_s = from_s,
                     .until_s = until_s};
    if (from_s < 0 || until_s < 0 || (until_s && until_s <= from_s)) {
        return iso_fault_set(fault, -EINVAL, "the time of a person ends before it begins");
    }
    return run_change(&w, fault);
}

static int change_offline(const struct work *w, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    hub_value_id(&values, &w->id);
    hub_value_switch(&values, w->ok);
    return hub_db_run(w->store->db, "UPDATE person SET offline_ok = $2 WHERE id = $1", &values,
                      NULL, fault);
}

int hub_person_set_offline(struct hub_store *store, const struct iso_fleet_id *person, bool ok,
                           struct iso_fault *fault)
{
    struct work w = {.store = store,
                     .id = *person,
                     .change = change_offline,
                     .what = "person-offline",
                     .ok = ok};
    return run_change(&w, fault);
}

static int change_credential(const struct work *w, struct iso_fault *fault)
{
    struct iso_fleet_bytes sealed = {.bytes = NULL};
    struct hub_values values = {.n = 0};
    int error = hub__credential_seal(w->store, &w->id, w->value, strlen(w->value), &sealed, fault);
    if (error) {
        return error;
    }
    hub_value_id(&values, &w->id);
    hub_value_bytes(&values, sealed.bytes, sealed.size);
    error = hub_db_run(w->store->db, "UPDATE person SET credential = $2 WHERE id = $1", &values,
                       NULL, fault);
    iso_fleet_bytes_free(&sealed);
    return error;
}

int hub_person_set_credential(struct hub_store *store, const struct iso_fleet_id *person,
                              const char *json, struct iso_fault *fault)
{
    struct work w = {.store = store,
                     .id = *person,
                     .change = change_credential,
                     .what = "person-credential",
                     .value = json};
    if (strlen(json) > ISO_FLEET_CREDENTIAL_MAX) {
        return iso_fault_set(fault, -EINVAL, "a credential has at most %d bytes",
                             ISO_FLEET_CREDENTIAL_MAX);
    }
    const int error = hub__credential_check(json, fault);
    return error ? error : run_change(&w, fault);
}

static int change_name(const struct work *w, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    char *folded = NULL;
    int error = iso_name_fold(w->value, &folded);
    if (error) {
        return iso_fault_set(fault, error, "%s: the name cannot be folded", w->value);
    }
    hub_value_id(&values, &w->id);
    hub_value_text(&values, w->value);
    hub_value_text(&values, folded);
    error = hub_db_run(w->store->db, "UPDATE person SET name = $2, folded = $3 WHERE id = $1",
                       &values, NULL, fault);
    free(folded);
    return error == -EEXIST ? hub__person_name_taken(w->value, fault) : error;
}

int hub_person_rename(struct hub_store *store, const struct iso_fleet_id *person, const char *name,
                      struct iso_fault *fault)
{
    struct work w = {.store = store,
                     .id = *person,
                     .change = change_name,
                     .what = "person-rename",
                     .value = name};
    const char *flaw = iso_person_name_flaw(name);
    return flaw ? iso_fault_set(fault, -EINVAL, "a person: %s", flaw) : run_change(&w, fault);
}

static int change_zones(const struct work *w, struct iso_fault *fault)
{
    return hub__person_put_zones(w->store, &w->id, w->zones, w->n_zones, fault);
}

int hub_person_set_zones(struct hub_store *store, const struct iso_fleet_id *person,
                         const struct iso_fleet_id *zones, size_t n_zones, struct iso_fault *fault)
{
    struct work w = {.store = store,
                     .id = *person,
                     .change = change_zones,
                     .what = "person-zones",
                     .zones = zones,
                     .n_zones = n_zones};
    const int error = check_zones(n_zones, fault);
    return error ? error : run_change(&w, fault);
}

static int revoke(void *context, struct iso_fault *fault)
{
    const struct work *w = context;
    struct hub__zones zones = {.n = 0};
    json_t *before = NULL;
    struct hub_values values = {.n = 0};
    int error = hub__person_lock(w->store, &w->id, &zones, &before, fault);
    if (error) {
        return error;
    }
    const struct hub__person_text name = hub__person_name(w->store, &w->id);
    hub_value_id(&values, &w->id);
    error = hub_db_run(w->store->db, "DELETE FROM person WHERE id = $1", &values, NULL, fault);
    error = error ? error : hub__person_remove(w->store, &w->id, &zones, fault);
    if (error) {
        json_decref(before);
        return error;
    }
    return hub__act_add(w->store, "person-revoke", name.text, before, NULL, fault);
}

int hub_person_revoke(struct hub_store *store, const struct iso_fleet_id *person,
                      struct iso_fault *fault)
{
    struct work w = {.store = store, .id = *person};
    return hub_db_transaction(store->db, HUB_READ_COMMITTED, revoke, &w, fault);
}
