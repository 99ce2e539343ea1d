#include <errno.h>

#include "enroll/hub/directory/hub_directory.h"
#include "enroll/hub/scim/scim_rows.h"
#include "enroll/hub/store/hub_act.h"

#define SCIM_LOCK "7311466419"

int hub__scim_lock(struct hub_store *store, struct iso_fault *fault)
{
    return hub_db_script(store->db, "SELECT pg_advisory_xact_lock(" SCIM_LOCK ")", fault);
}

int hub__scim_may_enter(struct hub_store *store, const struct iso_fleet_id *id, bool *out,
                        struct iso_fault *fault)
{
    char text[ISO_FLEET_ID_TEXT_SIZE];
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;

    hub_value_text(&values, iso_fleet_id_text(id, text));
    const int error = hub_db_run(store->db,
                                 "SELECT EXISTS (SELECT 1 FROM directory d JOIN directory_zone z "
                                 "ON z.directory = d.id WHERE d.source = '" HUB_SCIM_SOURCE "' "
                                 "AND d.external = $1 AND d.named AND d.active)",
                                 &values, &rows, fault);
    if (!error) {
        *out = hub_row_switch(rows, 0, 0);
        PQclear(rows);
    }
    return error;
}

int hub__scim_lost(struct hub_store *store, const struct iso_fleet_id *id, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};

    hub_value_integer(&values, store->now_s());
    hub_value_id(&values, id);
    return hub_db_run(store->db, "INSERT INTO scim_loss (time_s, member) VALUES ($1, $2)", &values,
                      NULL, fault);
}

/* Who has lost all zones within the last hour, who has some, and whether all is allowed. */
static int read_losses(struct hub_store *store, int64_t *lost, int64_t *left, bool *allowed,
                       struct iso_fault *fault)
{
    struct hub_values values = {.n = 0}, old = {.n = 0};
    PGresult *rows = NULL;
    const int64_t now_s = store->now_s();

    hub_value_integer(&old, now_s - HUB_SCIM_LOSSES_S);
    hub_value_integer(&values, now_s);
    int error = hub_db_run(store->db, "DELETE FROM scim_loss WHERE time_s <= $1", &old, NULL,
                           fault);
    error = error ? error
                  : hub_db_run(store->db,
                               "SELECT (SELECT count(DISTINCT member) FROM scim_loss), "
                               "(SELECT count(*) FROM directory d WHERE d.source = "
                               "'" HUB_SCIM_SOURCE "' AND d.named AND d.active AND EXISTS "
                               "(SELECT 1 FROM directory_zone z WHERE z.directory = d.id)), "
                               "EXISTS (SELECT 1 FROM scim_allowance WHERE until_s > $1)",
                               &values, &rows, fault);
    if (!error) {
        *lost = hub_row_integer(rows, 0, 0);
        *left = hub_row_integer(rows, 0, 1);
        *allowed = hub_row_switch(rows, 0, 2);
        PQclear(rows);
    }
    return error;
}

int hub__scim_guard(struct hub_store *store, struct iso_fault *fault)
{
    int64_t lost = 0, left = 0;
    bool allowed = false;
    const int error = read_losses(store, &lost, &left, &allowed, fault);

    if (error || allowed || lost <= HUB_SCIM_LOSSES_FREE ||
        lost * 100 <= (lost + left) * HUB_DIRECTORY_PERCENT) {
        return error;
    }
    return iso_fault_set(fault, -EPERM,
                         "%lld people would have lost their zones within an hour, which is more "
                         "than %d and %d %%; isotherm-hub scim allow lets it pass",
                         (long long)lost, HUB_SCIM_LOSSES_FREE, HUB_DIRECTORY_PERCENT);
}

int hub__scim_guard_record(struct hub_store *store, const char *why, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;

    hub_value_integer(&values, store->now_s() - HUB_SCIM_LOSSES_S);
    int error = hub_db_run(store->db,
                           "SELECT EXISTS (SELECT 1 FROM act WHERE what = 'scim-stopped' "
                           "AND time_s > $1)",
                           &values, &rows, fault);
    if (!error && !hub_row_switch(rows, 0, 0)) {
        error = hub__act_add(store, "scim-stopped", HUB_SCIM_SOURCE, NULL, json_string(why), fault);
    }
    PQclear(rows);
    return error;
}

static int allow(void *context, struct iso_fault *fault)
{
    struct hub_store *store = context;
    struct hub_values values = {.n = 0};

    hub_value_integer(&values, store->now_s() + HUB_SCIM_LOSSES_S);
    int error = hub_db_script(store->db, "DELETE FROM scim_allowance", fault);
    error = error ? error
                  : hub_db_run(store->db, "INSERT INTO scim_allowance (until_s) VALUES ($1)",
                               &values, NULL, fault);
    return error ? error : hub__act_add(store, "scim-allow", HUB_SCIM_SOURCE, NULL, NULL, fault);
}

int hub_scim_allow(struct hub_store *store, struct iso_fault *fault)
{
    return hub_db_transaction(store->db, HUB_READ_COMMITTED, allow, store, fault);
}
