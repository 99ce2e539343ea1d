#include "tests/enroll/hub/rigs/store_rig.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "enroll/hub/store/hub_schema.h"
#include "tests/support/scratch.h"

enum { SKIPPED = 77, TEMPLATE_BYTES = 2000 };

int64_t store_rig_now_s = 1700000000;

static int64_t now_s(void)
{
    return store_rig_now_s;
}

void store_rig_fine(int error, const struct iso_fault *fault)
{
    if (error) {
        fail_msg("%d: %s", error, fault->text);
    }
}

int store_rig_start(void **state)
{
    static struct store_rig rig;
    struct iso_fault fault = {.text = ""};
    struct hub_keys keys;
    if (!rig_postgres_start(&rig.postgres)) {
        exit(SKIPPED);
    }
    (void)snprintf(rig.key_file, sizeof rig.key_file, "/tmp/isotherm-hub-%d.key", (int)getpid());
    store_rig_fine(hub_keys_make(rig.key_file, &keys, &fault), &fault);
    hub_keys_wipe(&keys);
    *state = &rig;
    return 0;
}

int store_rig_stop(void **state)
{
    struct store_rig *rig = *state;
    rig_postgres_stop(&rig->postgres);
    return unlink(rig->key_file);
}

void store_rig_open(struct store_rig *rig, struct hub_store *out)
{
    struct iso_fault fault = {.text = ""};
    const struct hub_store_options options = {.conninfo = rig->postgres.conninfo,
                                              .key_file = rig->key_file,
                                              .hub_name = "head office",
                                              .actor = "anna"};
    store_rig_fine(hub_store_open(&options, out, &fault), &fault);
    out->now_s = now_s;
}

int store_rig_setup(void **state)
{
    struct store_rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    struct hub_db *db = NULL;
    rig_postgres_empty(&rig->postgres);
    store_rig_fine(hub_db_open(rig->postgres.conninfo, &db, &fault), &fault);
    store_rig_fine(hub_schema_migrate(db, (int64_t)hub_migrations_n, &fault), &fault);
    hub_db_close(db);
    store_rig_open(rig, &rig->store);
    return 0;
}

int store_rig_teardown(void **state)
{
    struct store_rig *rig = *state;
    hub_store_close(&rig->store);
    return 0;
}

struct iso_fleet_id store_rig_zone(struct store_rig *rig, const char *name)
{
    struct iso_fault fault = {.text = ""};
    struct iso_fleet_id id;
    store_rig_fine(hub_zone_add(&rig->store, name, &id, &fault), &fault);
    return id;
}

struct hub_zone store_rig_zone_now(struct store_rig *rig, const struct iso_fleet_id *zone)
{
    struct iso_fault fault = {.text = ""};
    struct hub_zone out;
    char text[ISO_FLEET_ID_TEXT_SIZE];
    store_rig_fine(hub_zone_find(&rig->store, iso_fleet_id_text(zone, text), &out, &fault), &fault);
    return out;
}

struct iso_fleet_person store_rig_person(const char *name, uint32_t algorithm, size_t n,
                                         uint8_t fill)
{
    static _Thread_local uint8_t bytes[TEMPLATE_BYTES];
    struct iso_fleet_person person = {.id = iso_fleet_id_of(name, strlen(name)),
                                      .enrolled_s = 1699990000,
                                      .name = name,
                                      .name_length = strlen(name),
                                      .credential = "",
                                      .n = n};
    memset(bytes, fill, sizeof bytes);
    for (size_t i = 0; i < n; i++) {
        person.templates[i] = (struct iso_fleet_template){
            .algorithm = algorithm, .size = TEMPLATE_BYTES, .bytes = bytes};
    }
    return person;
}

struct iso_fleet_id store_rig_put(struct store_rig *rig, const char *name,
                                  const struct iso_fleet_id *zones, size_t n_zones)
{
    struct iso_fault fault = {.text = ""};
    const struct iso_fleet_person person = store_rig_person(name, 3, 2, (uint8_t)name[0]);
    store_rig_fine(hub_person_put(&rig->store, &person, zones, n_zones, &fault), &fault);
    return person.id;
}

int64_t store_rig_number(struct store_rig *rig, const char *sql)
{
    struct iso_fault fault = {.text = ""};
    PGresult *rows = NULL;
    store_rig_fine(hub_db_run(rig->store.db, sql, NULL, &rows, &fault), &fault);
    assert_int_equal(PQntuples(rows), 1);
    const int64_t number = hub_row_integer(rows, 0, 0);
    PQclear(rows);
    return number;
}
