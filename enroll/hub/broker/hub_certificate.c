#include "enroll/hub/broker/hub_certificate.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

struct addition {
    struct hub_store *store;
    const struct iso_fleet_id *door;
    const struct hub_door_certificate *certificate;
};

static int add(void *context, struct iso_fault *fault)
{
    const struct addition *a = context;
    struct hub_values old = {.n = 0}, row = {.n = 0};

    hub_value_id(&old, a->door);
    hub_value_integer(&old, a->store->now_s());
    int r = hub_db_run(a->store->db, "DELETE FROM door_certificate WHERE door = $1 AND ends_s < $2",
                       &old, NULL, fault);
    hub_value_id(&row, a->door);
    hub_value_bytes(&row, a->certificate->serial, sizeof a->certificate->serial);
    hub_value_integer(&row, a->certificate->ends_s);
    hub_value_bytes(&row, a->certificate->key, sizeof a->certificate->key);
    return r ? r
             : hub_db_run(a->store->db,
                          "INSERT INTO door_certificate (door, serial, ends_s, key) "
                          "VALUES ($1, $2, $3, $4)",
                          &row, NULL, fault);
}

int hub_certificate_add(struct hub_store *store, const struct iso_fleet_id *door,
                        const struct hub_door_certificate *certificate, struct iso_fault *fault)
{
    struct addition a = {.store = store, .door = door, .certificate = certificate};

    return hub_db_transaction(store->db, HUB_READ_COMMITTED, add, &a, fault);
}

int hub_certificate_owner(struct hub_store *store, const uint8_t key[HUB_CA_DIGEST_BYTES],
                          struct iso_fleet_id *door, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;

    hub_value_bytes(&values, key, HUB_CA_DIGEST_BYTES);
    int r = hub_db_run(store->db,
                       "SELECT d.id FROM door_certificate c JOIN door d ON d.id = c.door "
                       "WHERE c.key = $1 AND d.expelled_s = 0 AND d.joined_s <> 0 LIMIT 1",
                       &values, &rows, fault);
    if (r < 0) {
        return r;
    }
    if (PQntuples(rows) == 1) {
        *door = hub_row_id(rows, 0, 0);
    } else {
        r = iso_fault_set(fault, -ENOENT, "no door of the fleet has this key");
    }
    PQclear(rows);
    return r;
}

int hub_certificate_revoked(struct hub_store *store, uint8_t (**serials)[HUB_CA_SERIAL_BYTES],
                            size_t *n, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;

    hub_value_integer(&values, store->now_s());
    int r = hub_db_run(store->db,
                       "SELECT c.serial FROM door_certificate c JOIN door d ON d.id = c.door "
                       "WHERE d.expelled_s <> 0 AND c.ends_s >= $1 ORDER BY c.serial",
                       &values, &rows, fault);
    if (r < 0) {
        return r;
    }
    const size_t count = (size_t)PQntuples(rows);
    uint8_t(*found)[HUB_CA_SERIAL_BYTES] = calloc(count + 1, sizeof *found);
    r = found ? 0 : iso_fault_set(fault, -ENOMEM, "out of memory for the revoked certificates");
    for (size_t i = 0; r == 0 && i < count; i++) {
        if (hub_row_copy(rows, (int)i, 0, found[i], sizeof found[i])) {
            r = iso_fault_set(fault, -EIO, "the serial number of a certificate is damaged");
        }
    }
    PQclear(rows);
    if (r < 0) {
        free(found);
        return r;
    }
    *serials = found;
    *n = count;
    return 0;
}
