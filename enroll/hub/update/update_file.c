/* The files that the hub keeps. */
#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "enroll/hub/store/hub_act.h"
#include "enroll/hub/update/rollout_rows.h"

struct work {
    struct hub_store *store;
    const struct hub_update_file *file;
    const char *version;
    PGresult *digests; /* of the rows that were deleted; the caller clears it */
};

void hub_update_path(const struct hub_store *store, const uint8_t sha256[32],
                     char path[HUB_UPDATE_PATH_SIZE])
{
    char digits[65];
    (void)snprintf(path, HUB_UPDATE_PATH_SIZE, "%s/%s.raucb", store->updates,
                   sodium_bin2hex(digits, sizeof digits, sha256, 32));
}

static int add(void *context, struct iso_fault *fault)
{
    const struct work *w = context;
    const struct hub_update_file *file = w->file;
    struct hub_values values = {.n = 0};
    hub_value_text(&values, file->version);
    hub_value_text(&values, file->board);
    hub_value_integer(&values, (int64_t)file->size);
    hub_value_bytes(&values, file->sha256, sizeof file->sha256);
    hub_value_integer(&values, w->store->now_s());
    const int error = hub_db_run(w->store->db,
                                 "INSERT INTO update_file (version, board, size, sha256, added_s) "
                                 "VALUES ($1, $2, $3, $4, $5)",
                                 &values, NULL, fault);
    if (error == -EEXIST) {
        return iso_fault_set(fault, error, "version %s for the board %s is here already",
                             file->version, file->board);
    }
    return error ? error
                 : hub__act_add(
                       w->store, "update-add", file->version, NULL,
                       json_pack("{s:s,s:I}", "board", file->board, "size", (json_int_t)file->size),
                       fault);
}

int hub_update_add(struct hub_store *store, const struct hub_update_file *file,
                   struct iso_fault *fault)
{
    struct work w = {.store = store, .file = file};
    return hub_db_transaction(store->db, HUB_READ_COMMITTED, add, &w, fault);
}

/* The lock keeps a rollout from beginning with a version that is being removed. */
static int check_unused(const struct work *w, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    int error = hub_db_script(w->store->db, "LOCK TABLE rollout IN SHARE MODE", fault);
    hub_value_text(&values, w->version);
    error = error ? error
                  : hub_db_run(w->store->db,
                               "SELECT z.name FROM rollout r JOIN zone z ON z.id = r.zone WHERE "
                               "r.version = $1 AND r.state = 'running'",
                               &values, &rows, fault);
    if (!error && PQntuples(rows) > 0) {
        error = iso_fault_set(fault, -EALREADY,
                              "zone %s is on the way to version %s; stop it first",
                              hub_row_text(rows, 0, 0), w->version);
    }
    PQclear(rows);
    return error;
}

static int remove_rows(void *context, struct iso_fault *fault)
{
    struct work *w = context;
    struct hub_values values = {.n = 0};
    PQclear(w->digests);
    w->digests = NULL;
    hub_value_text(&values, w->version);
    int error = check_unused(w, fault);
    error = error ? error
                  : hub_db_run(w->store->db,
                               "DELETE FROM update_file WHERE version = $1 RETURNING sha256",
                               &values, &w->digests, fault);
    if (!error && PQntuples(w->digests) == 0) {
        return iso_fault_set(fault, -ENOENT, "there is no update of version %s", w->version);
    }
    return error ? error : hub__act_add(w->store, "update-remove", w->version, NULL, NULL, fault);
}

int hub_update_remove(struct hub_store *store, const char *version, struct iso_fault *fault)
{
    struct work w = {.store = store, .version = version};
    const int error = hub_db_transaction(store->db, HUB_READ_COMMITTED, remove_rows, &w, fault);
    for (int i = 0; !error && i < PQntuples(w.digests); i++) {
        char path[HUB_UPDATE_PATH_SIZE];
        uint8_t digest[32];
        if (hub_row_copy(w.digests, i, 0, digest, sizeof digest) == 0) {
            hub_update_path(store, digest, path);
            (void)unlink(path); /* it may have been copied to other machines only */
        }
    }
    PQclear(w.digests);
    return error;
}

int hub_update_each(struct hub_store *store,
                    int (*each)(void *context, const struct hub_update_file *file), void *context,
                    struct iso_fault *fault)
{
    PGresult *rows = NULL;
    int error = hub_db_run(store->db,
                           "SELECT version, board, size, sha256, added_s FROM update_file "
                           "ORDER BY added_s, version, board",
                           NULL, &rows, fault);
    for (int i = 0; !error && i < PQntuples(rows); i++) {
        struct hub_update_file file;
        error = hub__update_file_row(rows, i, &file, fault);
        error = error ? error : each(context, &file);
    }
    PQclear(rows);
    return error;
}
