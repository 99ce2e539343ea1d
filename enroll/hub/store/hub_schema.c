#include "enroll/hub/store/hub_schema.h"

#include <errno.h>

int hub_schema_version(struct hub_db *db, int64_t *version, struct iso_fault *fault)
{
    PGresult *result = NULL;
    int error = hub_db_run(db, "SELECT to_regclass('isotherm_schema') IS NOT NULL", NULL, &result,
                           fault);
    if (error) {
        return error;
    }
    const bool exists = hub_row_switch(result, 0, 0);
    PQclear(result);
    if (!exists) {
        *version = 0;
        return 0;
    }
    error = hub_db_run(db, "SELECT coalesce(max(version), 0)::bigint FROM isotherm_schema", NULL,
                       &result, fault);
    if (!error) {
        *version = hub_row_integer(result, 0, 0);
        PQclear(result);
    }
    return error;
}

static int newer(int64_t version, struct iso_fault *fault)
{
    return iso_fault_set(fault, -EPROTONOSUPPORT,
                         "the database is of version %lld, this program knows up to %zu",
                         (long long)version, hub_migrations_n);
}

int hub_schema_check(struct hub_db *db, struct iso_fault *fault)
{
    int64_t version = 0;
    const int error = hub_schema_version(db, &version, fault);
    if (error) {
        return error;
    }
    if (version == 0) {
        return iso_fault_set(fault, -ENODATA,
                             "the database has no tables of a hub; run isotherm-hub init");
    }
    if (version > (int64_t)hub_migrations_n) {
        return newer(version, fault);
    }
    return version == (int64_t)hub_migrations_n
               ? 0
               : iso_fault_set(fault, -EPROTONOSUPPORT,
                               "the database is of version %lld, this program needs %zu; run "
                               "isotherm-hub migrate up",
                               (long long)version, hub_migrations_n);
}

struct step {
    struct hub_db *db;
    int64_t goal;
    bool done;
};

static int set_version(struct hub_db *db, int64_t version, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    if (version == 0) {
        return hub_db_script(db, "DROP TABLE isotherm_schema", fault);
    }
    const int error = hub_db_script(db, "DELETE FROM isotherm_schema", fault);
    hub_value_integer(&values, version);
    return error ? error
                 : hub_db_run(db, "INSERT INTO isotherm_schema (version) VALUES ($1)", &values,
                              NULL, fault);
}

/* One step towards the goal. The lock keeps two processes from making it at once, and the version
 * is read behind it. */
static int make_step(void *context, struct iso_fault *fault)
{
    struct step *step = context;
    int64_t version = 0;
    int error = hub_db_script(step->db, "SELECT pg_advisory_xact_lock(7311466417)", fault);
    error = error ? error : hub_schema_version(step->db, &version, fault);
    if (!error && version > (int64_t)hub_migrations_n) {
        return newer(version, fault);
    }
    step->done = version == step->goal;
    if (error || step->done) {
        return error;
    }
    const bool up = version < step->goal;
    const struct hub_migration *migration = &hub_migrations[up ? version : version - 1];
    if (version == 0) {
        error = hub_db_script(step->db, "CREATE TABLE isotherm_schema (version bigint PRIMARY KEY)",
                              fault);
    }
    error = error ? error : hub_db_script(step->db, up ? migration->up : migration->down, fault);
    return error ? error : set_version(step->db, up ? version + 1 : version - 1, fault);
}

int hub_schema_migrate(struct hub_db *db, int64_t version, struct iso_fault *fault)
{
    struct step step = {.db = db, .goal = version};
    if (version < 0 || version > (int64_t)hub_migrations_n) {
        return iso_fault_set(fault, -EINVAL, "there is no version %lld of the database's tables",
                             (long long)version);
    }
    int error = 0;
    while (!error && !step.done) {
        error = hub_db_transaction(db, HUB_READ_COMMITTED, make_step, &step, fault);
    }
    return error;
}
