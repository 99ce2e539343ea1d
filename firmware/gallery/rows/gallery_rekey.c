/* Seals all rows of the gallery's database with another key. */
#include <sodium.h>
#include <stdlib.h>
#include <string.h>

#include "firmware/gallery/gallery_db_state.h"

/* How the rows of a table are sealed again. */
struct reseal_table {
    enum iso_gallery_kind kind;
    const char *name; /* in a fault */
    const char *select, *update;
};

/* Seals one row again: the first whose number is above *after. It was sealed with `old`, and is
 * then sealed with db->seal. *after becomes its number. Returns 1, 0 if there is no such row, or a
 * negative errno. */
static int reseal_next(struct iso_gallery_db *db, const struct iso_gallery_seal *old,
                       const struct reseal_table *table, int64_t *after, struct iso_fault *fault)
{
    sqlite3_stmt *query = NULL;
    int error = iso__gallery_prepare(db, table->select, &query, fault);
    if (error) {
        return error;
    }
    (void)sqlite3_bind_int64(query, 1, *after);
    const int step = sqlite3_step(query);
    if (step != SQLITE_ROW) {
        error = step == SQLITE_DONE ? 0 : iso__gallery_fail(db, fault);
        (void)sqlite3_finalize(query);
        return error;
    }
    const struct iso_gallery_place place = iso__gallery_place_of(query, table->kind);
    const size_t size = (size_t)sqlite3_column_bytes(query, 3);
    const void *sealed = sqlite3_column_blob(query, 3);
    const bool sound = sealed && size >= ISO_SEAL_OVERHEAD && size <= sizeof db->sealed &&
                       iso_gallery_record_open(old, &place, sealed, size, db->plain) == 0;
    (void)sqlite3_finalize(query);
    if (!sound) {
        return iso__gallery_changed(db, table->name, place.number, fault);
    }
    *after = place.number;
    error = iso__gallery_write_record(db, table->update, &place, db->plain,
                                      size - ISO_SEAL_OVERHEAD, fault);
    return error ? error : 1;
}

/* Counts the records to be sealed. */
static int count_records(const struct iso_gallery_db *db, uint64_t *n, struct iso_fault *fault)
{
    char answer[32];
    const int error = iso__gallery_ask(
        db,
        db->draft.has_access
            ? "SELECT (SELECT count(*) FROM person) + (SELECT count(*) FROM template) "
              "+ (SELECT count(*) FROM access)"
            : "SELECT (SELECT count(*) FROM person) + (SELECT count(*) FROM template)",
        answer, sizeof answer, fault);
    *n = error ? 0 : strtoull(answer, NULL, 10);
    return error;
}

static int reseal_rows(struct iso_gallery_db *db, const struct iso_gallery_seal *old,
                       const struct iso_work_listener *listener, struct iso_fault *fault)
{
    static const struct reseal_table tables[] = {
        {ISO_GALLERY_PERSON, "person",
         "SELECT id, 0, 0, record FROM person WHERE id > ?1 ORDER BY id LIMIT 1",
         "UPDATE person SET record = ?4 WHERE id = ?1"},
        {ISO_GALLERY_TEMPLATE, "template",
         "SELECT id, person_id, algorithm, record FROM template WHERE id > ?1 ORDER BY id LIMIT 1",
         "UPDATE template SET record = ?4 WHERE id = ?1 AND person_id = ?2 AND algorithm = ?3"},
        {ISO_GALLERY_ACCESS, "access",
         "SELECT id, person_id, part, record FROM access WHERE id > ?1 ORDER BY id LIMIT 1",
         "UPDATE access SET record = ?4 WHERE id = ?1 AND person_id = ?2 AND part = ?3"},
    };
    const size_t n = sizeof tables / sizeof *tables - (db->draft.has_access ? 0 : 1);
    uint64_t done = 0, total = 0;
    int more = count_records(db, &total, fault);
    for (size_t i = 0; more >= 0 && i < n; i++) {
        int64_t after = 0;
        do {
            more = reseal_next(db, old, &tables[i], &after, fault);
            if (more > 0) {
                iso_work_step(listener, ++done, total);
            }
        } while (more > 0);
    }
    sodium_memzero(db->plain, sizeof db->plain);
    return more;
}

int iso_gallery_db_rotate(struct iso_gallery_db *db, const struct iso_work_listener *listener,
                          struct iso_fault *fault)
{
    uint32_t number = 0;
    int error = iso_key_ring_add(db->ring, ISO_KEY_GALLERY, &number, fault);
    if (!error) {
        error = iso_gallery_db_begin(db, fault);
    }
    if (error) {
        return error;
    }
    struct iso_gallery_seal old = db->seal;
    db->seal = iso_gallery_seal_of(old.gallery, number,
                                   iso_key_ring_find(db->ring, ISO_KEY_GALLERY, number));
    memset(db->draft.digest, 0, sizeof db->draft.digest);
    error = iso__gallery_drop_vectors(db, fault);
    if (!error) {
        error = reseal_rows(db, &old, listener, fault);
    }
    error = iso_gallery_db_end(db, error, fault);
    if (error) {
        iso_gallery_seal_wipe(&db->seal);
        db->seal = old;
    } else if (iso__gallery_execute(db, "VACUUM", NULL)) {
        /* VACUUM removes the free pages. After a failure they stay in the file; their contents are
         * overwritten already (secure_delete). The connection cannot be trusted after the error, so
         * the head is read from the disk again. */
        error = iso__gallery_settle(db, 0, fault);
    }
    if (!error) {
        error = iso_key_ring_drop(db->ring, ISO_KEY_GALLERY, number, fault);
    }
    iso_gallery_seal_wipe(&old);
    return error;
}
