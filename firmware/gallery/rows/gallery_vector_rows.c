/* The vectors that are stored beside the templates.
 *
 * To make the vector of a template by the metric takes most of the time of a start. Therefore a
 * start stores the vectors that it has made, and the next one reads them. A stored vector saves
 * time and nothing else: templates are what is enrolled. (But its pages are pages of the database:
 * if one of them is damaged, the check of the whole database refuses the gallery, as for any page.)
 *
 * Its label has the digest of the sealed template and a digest of the metric. So it opens only
 * beside the very record that it was made of, in the place of that record, and only for the same
 * metric. A template whose stored vector opens is sound and need not be opened itself; of any other
 * template the record is opened, as without vectors, and what was changed is found. Vectors are no
 * part of the digest of all records: to take them away or to bring an old one back changes no
 * result. A program that makes other vectors of the same template by the same metric has to change
 * the number in their label (gallery_seal.c). A template's vector is deleted with it, and a new key
 * deletes all vectors. */
#include <errno.h>
#include <sodium.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/bytes.h"
#include "drivers/file/disk_room.h"
#include "firmware/gallery/gallery_db_state.h"

/* sensor, weight, scale, step, whether the template was learned, then the numbers. */
enum {
    LEARNED_AT = ISO_TEMPLATE_SENSOR_MAX + 4 + 4 + 2,
    NUMBERS_AT = LEARNED_AT + 1,
    PLAIN_MAX = NUMBERS_AT + 4 * ISO_METRIC_DIMENSIONS_MAX,
};

/* ---- the metric ---- */

static void add_number(crypto_generichash_state *state, uint32_t number)
{
    uint8_t bytes[4];
    (void)iso_put_u32(bytes, number);
    (void)crypto_generichash_update(state, bytes, sizeof bytes);
}

static void add_floats(crypto_generichash_state *state, const float *numbers, size_t n)
{
    (void)crypto_generichash_update(state, (const uint8_t *)numbers, n * sizeof *numbers);
}

/* The digest of everything in a metric that a vector depends on. Floats are digested as the machine
 * has them in memory: on a machine with another order of bytes vectors are made again. */
static void digest_metric(const struct iso_metric *metric, uint8_t print[ISO_SEAL_DIGEST_BYTES])
{
    const size_t values = (size_t)metric->n_values, dimensions = (size_t)metric->n_dimensions;
    crypto_generichash_state state;
    (void)crypto_generichash_init(&state, NULL, 0, ISO_SEAL_DIGEST_BYTES);
    add_number(&state, metric->algorithm);
    add_number(&state, metric->landmarks);
    add_number(&state, (uint32_t)metric->n_radii);
    add_number(&state, (uint32_t)metric->n_points);
    add_number(&state, (uint32_t)metric->n_dimensions);
    add_number(&state, (uint32_t)metric->n_nodes);
    for (int i = 0; i < metric->n_nodes; i++) {
        add_number(&state, metric->node[i]);
    }
    add_floats(&state, &metric->weight_min, 1);
    add_floats(&state, metric->curve_mm, (size_t)metric->n_curve_values);
    add_floats(&state, metric->upper_mm, (size_t)metric->n_nodes);
    add_floats(&state, metric->between, dimensions);
    add_floats(&state, metric->centre, dimensions);
    add_floats(&state, metric->axis, values * dimensions);
    (void)crypto_generichash_final(&state, print, ISO_SEAL_DIGEST_BYTES);
}

void iso__gallery_use_metric(struct iso_gallery_db *db, const struct iso_metric *metric,
                             uint32_t algorithm)
{
    db->metric = metric;
    db->algorithm = algorithm;
    if (metric) {
        digest_metric(metric, db->print);
    }
}

/* ---- one vector ---- */

static size_t plain_size(const struct iso_gallery_db *db)
{
    return NUMBERS_AT + 4 * (size_t)db->metric->n_dimensions;
}

static void put_vector(const struct iso_gallery_db *db, const struct iso_gallery_vector *vector,
                       uint8_t plain[PLAIN_MAX])
{
    uint8_t *p = iso_put_bytes(plain, vector->sensor, sizeof vector->sensor);
    p = iso_put_f32(p, vector->vector.weight);
    p = iso_put_f32(p, vector->vector.scale);
    p = iso_put_u16(p, (uint16_t)(vector->vector.step - ISO_METRIC_STEP_MIN));
    *p++ = vector->learned;
    for (int d = 0; d < db->metric->n_dimensions; d++) {
        p = iso_put_f32(p, vector->vector.mean[d]);
    }
}

/* Returns false if no vector of one template has these bytes. */
static bool get_vector(const struct iso_gallery_db *db, const uint8_t plain[PLAIN_MAX],
                       struct iso_gallery_vector *out)
{
    const uint8_t *p = plain + ISO_TEMPLATE_SENSOR_MAX;
    memcpy(out->sensor, plain, sizeof out->sensor);
    out->learned = plain[LEARNED_AT] != 0;
    out->vector = (struct iso_metric_vector){
        .n = 1,
        .weight = iso_get_f32(p),
        .scale = iso_get_f32(p + 4),
        .step = iso_get_u16(p + 8) + ISO_METRIC_STEP_MIN,
    };
    for (int d = 0; d < db->metric->n_dimensions; d++) {
        out->vector.mean[d] = iso_get_f32(plain + NUMBERS_AT + 4 * (size_t)d);
    }
    return out->vector.step <= ISO_METRIC_STEP_ONE_MAX &&
           memchr(out->sensor, '\0', sizeof out->sensor);
}

/* The digest of the sealed template of a row; all zero if there is none. */
static void digest_template(const struct iso_gallery_db *db, sqlite3_stmt *row,
                            const struct iso_gallery_place *place,
                            uint8_t digest[ISO_SEAL_DIGEST_BYTES])
{
    const void *record = sqlite3_column_blob(row, 3);
    memset(digest, 0, ISO_SEAL_DIGEST_BYTES);
    if (record) {
        iso_gallery_record_toggle(&db->seal, place, record, (size_t)sqlite3_column_bytes(row, 3),
                                  digest);
    }
}

bool iso__gallery_has_vector(sqlite3_stmt *row)
{
    return sqlite3_column_count(row) > 4 && sqlite3_column_type(row, 4) != SQLITE_NULL;
}

bool iso__gallery_stored_vector(const struct iso_gallery_db *db, sqlite3_stmt *row,
                                const struct iso_gallery_place *place, uint8_t *digest,
                                struct iso_gallery_vector *out)
{
    uint8_t own[ISO_SEAL_DIGEST_BYTES], plain[PLAIN_MAX];
    const void *sealed = db->metric && iso__gallery_has_vector(row) ? sqlite3_column_blob(row, 4)
                                                                    : NULL;
    if (!sealed || place->person <= 0 || place->algorithm != db->algorithm ||
        (size_t)sqlite3_column_bytes(row, 4) != plain_size(db) + ISO_SEAL_OVERHEAD) {
        return false;
    }
    digest_template(db, row, place, own);
    const bool sound = iso_gallery_vector_open(&db->seal, own, db->print, sealed,
                                               plain_size(db) + ISO_SEAL_OVERHEAD, plain) == 0 &&
                       get_vector(db, plain, out);
    out->number = place->number;
    for (size_t i = 0; sound && i < sizeof own; i++) {
        digest[i] ^= own[i];
    }
    sodium_memzero(plain, sizeof plain);
    if (!sound) {
        sodium_memzero(out, sizeof *out);
    }
    return sound;
}

/* ---- the table ---- */

int iso__gallery_find_vectors(struct iso_gallery_db *db, struct iso_fault *fault)
{
    char answer[8];
    const int error = iso__gallery_ask(
        db, "SELECT 1 FROM sqlite_schema WHERE type = 'table' AND name = 'vector'", answer,
        sizeof answer, fault);
    if (!error) {
        db->has_vectors = *answer != '\0';
    }
    return error;
}

int iso__gallery_count_vectors(const struct iso_gallery_db *db, uint64_t n, struct iso_fault *fault)
{
    char answer[24];
    const int error = db->has_vectors ? iso__gallery_ask(db, "SELECT count(*) FROM vector", answer,
                                                         sizeof answer, fault)
                                      : 0;
    return error || !db->has_vectors || strtoull(answer, NULL, 10) == n
               ? error
               : iso_gallery_db_damaged(db, "a stored vector belongs to no template", fault);
}

int iso__gallery_drop_vectors(struct iso_gallery_db *db, struct iso_fault *fault)
{
    return db->has_vectors ? iso__gallery_execute(db, "DELETE FROM vector", fault) : 0;
}

/* Seals the vector for its template, which is read once more, and inserts it. `query` selects the
 * template and `insert` inserts the vector. */
static bool insert_vector(const struct iso_gallery_db *db, sqlite3_stmt *query,
                          sqlite3_stmt *insert, const struct iso_gallery_vector *vector)
{
    uint8_t own[ISO_SEAL_DIGEST_BYTES], plain[PLAIN_MAX], sealed[PLAIN_MAX + ISO_SEAL_OVERHEAD];
    (void)sqlite3_reset(query);
    (void)sqlite3_bind_int64(query, 1, vector->number);
    if (sqlite3_step(query) != SQLITE_ROW) {
        return false;
    }
    const struct iso_gallery_place place = iso__gallery_place_of(query, ISO_GALLERY_TEMPLATE);
    digest_template(db, query, &place, own);
    put_vector(db, vector, plain);
    iso_gallery_vector_close(&db->seal, own, db->print, plain, plain_size(db), sealed);
    sodium_memzero(plain, sizeof plain);
    (void)sqlite3_reset(insert);
    (void)sqlite3_bind_int64(insert, 1, vector->number);
    (void)sqlite3_bind_blob64(insert, 2, sealed, plain_size(db) + ISO_SEAL_OVERHEAD, SQLITE_STATIC);
    return sqlite3_step(insert) == SQLITE_DONE;
}

/* Called within a transaction. Returns false after a failure. */
static bool insert_all(const struct iso_gallery_db *db, const struct iso_gallery_vector *vectors,
                       size_t n)
{
    static const char table[] = "CREATE TABLE IF NOT EXISTS vector ("
                                "  id INTEGER PRIMARY KEY"
                                "    REFERENCES template (id) ON DELETE CASCADE,"
                                "  record BLOB NOT NULL) STRICT";
    sqlite3_stmt *query = NULL, *insert = NULL;
    bool done = iso__gallery_execute(db, table, NULL) == 0 &&
                iso__gallery_prepare(db,
                                     "SELECT id, person_id, algorithm, record FROM template "
                                     "WHERE id = ?1",
                                     &query, NULL) == 0 &&
                iso__gallery_prepare(db,
                                     "INSERT OR REPLACE INTO vector (id, record) VALUES (?1, ?2)",
                                     &insert, NULL) == 0;
    for (size_t i = 0; done && i < n; i++) {
        done = insert_vector(db, query, insert, &vectors[i]);
    }
    (void)sqlite3_finalize(query);
    (void)sqlite3_finalize(insert);
    return done;
}

/* Whether the disk has room for n vectors, in the log of the database and then in the database. */
static bool has_room(const struct iso_gallery_db *db, size_t n)
{
    const uint64_t needed = 2 * n * (uint64_t)(plain_size(db) + ISO_SEAL_OVERHEAD);
    return iso_disk_room(sqlite3_db_filename(db->sqlite, "main")) >= needed;
}

void iso_gallery_db_store_vectors(struct iso_gallery_db *db,
                                  const struct iso_gallery_vector *vectors, size_t n)
{
    if (!db->metric || !has_room(db, n) || iso__gallery_execute(db, "BEGIN IMMEDIATE", NULL)) {
        return;
    }
    const bool inserted = insert_all(db, vectors, n);
    if (inserted && iso__gallery_execute(db, "COMMIT", NULL) == 0) {
        db->has_vectors = true;
    } else if (inserted || !iso__gallery_roll_back(db)) {
        /* The head did not change. It is read from the disk to find out whether the disk can still
         * be read. */
        (void)!iso__gallery_settle(db, 0, NULL);
    }
}
