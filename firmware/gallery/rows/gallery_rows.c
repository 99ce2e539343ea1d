/* The rows of the gallery's database. Every row is sealed when it is written and opened when it is
 * read, and the digest over all rows is kept up to date. */
#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>

#include "firmware/gallery/gallery_db_state.h"

/* ---- reading ---- */

int iso__gallery_changed(const struct iso_gallery_db *db, const char *kind, int64_t number,
                         struct iso_fault *fault)
{
    char what[80];
    (void)snprintf(what, sizeof what, "the record of %s %lld is not what was stored", kind,
                   (long long)number);
    return iso_gallery_db_damaged(db, what, fault);
}

/* Opens the sealed column of a row into db->plain, and adds it to a digest. Returns its size, or a
 * negative number. */
static int open_column(struct iso_gallery_db *db, sqlite3_stmt *row, int column,
                       const struct iso_gallery_place *place, uint8_t *digest)
{
    const void *sealed = sqlite3_column_blob(row, column);
    const size_t size = (size_t)sqlite3_column_bytes(row, column);
    if (!sealed || size < ISO_SEAL_OVERHEAD || size > sizeof db->sealed ||
        iso_gallery_record_open(&db->seal, place, sealed, size, db->plain)) {
        return -EBADMSG;
    }
    iso_gallery_record_toggle(&db->seal, place, sealed, size, digest);
    return (int)(size - ISO_SEAL_OVERHEAD);
}

struct iso_gallery_place iso__gallery_place_of(sqlite3_stmt *row, enum iso_gallery_kind kind)
{
    return (struct iso_gallery_place){.kind = kind,
                                      .number = sqlite3_column_int64(row, 0),
                                      .person = sqlite3_column_int64(row, 1),
                                      .algorithm = (uint32_t)sqlite3_column_int64(row, 2)};
}

static int visit_person(struct iso_gallery_db *db, sqlite3_stmt *row,
                        const struct iso_gallery_visitor *visitor, uint8_t *digest,
                        struct iso_fault *fault)
{
    const struct iso_gallery_place place = {.number = sqlite3_column_int64(row, 0)};
    struct iso_person person;
    const int size = open_column(db, row, 1, &place, digest);
    if (size < 0) {
        return iso__gallery_changed(db, "person", place.number, fault);
    }
    if (iso_gallery_person_get(db->plain, (size_t)size, &person)) {
        return iso_gallery_db_damaged(db, "a person has no valid name", fault);
    }
    person.id = place.number;
    return visitor->person(visitor->context, &person, fault);
}

static int visit_template(struct iso_gallery_db *db, sqlite3_stmt *row,
                          const struct iso_gallery_visitor *visitor, uint8_t *digest,
                          struct iso_fault *fault)
{
    const struct iso_gallery_place place = iso__gallery_place_of(row, ISO_GALLERY_TEMPLATE);
    struct iso_gallery_vector stored;
    db->vectors_read += iso__gallery_has_vector(row);
    if (visitor->vector && iso__gallery_stored_vector(db, row, &place, digest, &stored)) {
        const int error = visitor->vector(visitor->context, &place, &stored, fault);
        sodium_memzero(&stored, sizeof stored);
        return error;
    }
    const int size = place.person > 0 ? open_column(db, row, 3, &place, digest) : -EBADMSG;
    if (size < 0) {
        return iso__gallery_changed(db, "template", place.number, fault);
    }
    return visitor->template(visitor->context, &place, db->plain, (size_t)size, fault);
}

static int visit_access(struct iso_gallery_db *db, sqlite3_stmt *row,
                        const struct iso_gallery_visitor *visitor, uint8_t *digest,
                        struct iso_fault *fault)
{
    const struct iso_gallery_place place = iso__gallery_place_of(row, ISO_GALLERY_ACCESS);
    const int size = open_column(db, row, 3, &place, digest);
    if (size < 0) {
        return iso__gallery_changed(db, "access", place.number, fault);
    }
    return visitor->access(visitor->context, &place, db->plain, (size_t)size, fault);
}

typedef int (*visit_fn)(struct iso_gallery_db *db, sqlite3_stmt *row,
                        const struct iso_gallery_visitor *visitor, uint8_t *digest,
                        struct iso_fault *fault);

/* `parameter` is bound to the parameter of the statement, if the statement has one. */
static int each_row(struct iso_gallery_db *db, const char *sql, int64_t parameter, visit_fn visit,
                    const struct iso_gallery_visitor *visitor, uint8_t *digest,
                    struct iso_fault *fault)
{
    sqlite3_stmt *query = NULL;
    int error = iso__gallery_in_service(db, fault);
    if (error) {
        return error;
    }
    int step = sqlite3_prepare_v2(db->sqlite, sql, -1, &query, NULL);
    if (step == SQLITE_OK) {
        (void)sqlite3_bind_int64(query, 1, parameter);
        while (!error && (step = sqlite3_step(query)) == SQLITE_ROW) {
            error = visit(db, query, visitor, digest, fault);
        }
    }
    if (!error && step != SQLITE_DONE) {
        error = iso__gallery_fail(db, fault);
    }
    (void)sqlite3_finalize(query);
    sodium_memzero(db->plain, sizeof db->plain);
    return error;
}

static const char all_templates[] =
    "SELECT id, person_id, algorithm, record FROM template ORDER BY person_id, id";
static const char with_vectors[] =
    "SELECT template.id, person_id, algorithm, template.record, vector.record "
    "FROM template LEFT JOIN vector ON vector.id = template.id ORDER BY person_id, template.id";

int iso_gallery_db_load(struct iso_gallery_db *db, const struct iso_gallery_visitor *visitor,
                        struct iso_fault *fault)
{
    uint8_t digest[ISO_SEAL_DIGEST_BYTES] = {0};
    int error = each_row(db, "SELECT id, record FROM person ORDER BY id", 0, visit_person, visitor,
                         digest, fault);
    if (!error) {
        db->vectors_read = 0;
        error = each_row(db, db->has_vectors ? with_vectors : all_templates, 0, visit_template,
                         visitor, digest, fault);
    }
    if (!error && db->draft.has_access) {
        error = each_row(db,
                         "SELECT id, person_id, part, record FROM access ORDER BY person_id, part",
                         0, visit_access, visitor, digest, fault);
    }
    if (!error && sodium_memcmp(digest, db->draft.digest, sizeof digest) != 0) {
        error = iso_gallery_db_damaged(db, "records are missing, or are old ones", fault);
    }
    return error ? error : iso__gallery_count_vectors(db, db->vectors_read, fault);
}

int iso_gallery_db_templates(struct iso_gallery_db *db, int64_t person,
                             const struct iso_gallery_visitor *visitor, struct iso_fault *fault)
{
    /* The digest of some rows cannot be compared with anything. */
    uint8_t digest[ISO_SEAL_DIGEST_BYTES] = {0};
    return each_row(db,
                    "SELECT id, person_id, algorithm, record FROM template "
                    "WHERE person_id = ?1 ORDER BY id",
                    person, visit_template, visitor, digest, fault);
}

/* ---- writing ---- */

int iso__gallery_write_record(struct iso_gallery_db *db, const char *sql,
                              const struct iso_gallery_place *place, const void *plain, size_t size,
                              struct iso_fault *fault)
{
    sqlite3_stmt *statement = NULL;
    const int error = iso__gallery_prepare(db, sql, &statement, fault);
    if (error) {
        return error;
    }
    iso_gallery_record_close(&db->seal, place, plain, size, db->sealed);
    iso_gallery_record_toggle(&db->seal, place, db->sealed, size + ISO_SEAL_OVERHEAD,
                              db->draft.digest);
    (void)sqlite3_bind_int64(statement, 1, place->number);
    if (place->kind != ISO_GALLERY_PERSON) {
        (void)sqlite3_bind_int64(statement, 2, place->person);
        (void)sqlite3_bind_int64(statement, 3, place->algorithm);
    }
    (void)sqlite3_bind_blob64(statement, 4, db->sealed, size + ISO_SEAL_OVERHEAD, SQLITE_STATIC);
    return iso__gallery_finish(db, statement, fault);
}

int iso__gallery_insert_person(struct iso_gallery_db *db, int64_t id,
                               const struct iso_person *person, struct iso_fault *fault)
{
    const struct iso_gallery_place place = {.number = id};
    uint8_t plain[ISO_GALLERY_PERSON_BYTES];
    iso_gallery_person_put(person, plain);
    const int error = iso__gallery_write_record(
        db, "INSERT INTO person (id, record) VALUES (?1, ?4)", &place, plain, sizeof plain, fault);
    sodium_memzero(plain, sizeof plain);
    return error;
}

int iso__gallery_insert_template(struct iso_gallery_db *db, const struct iso_gallery_place *place,
                                 const void *bytes, size_t size, struct iso_fault *fault)
{
    return iso__gallery_write_record(db,
                                     "INSERT INTO template (id, person_id, algorithm, record) "
                                     "VALUES (?1, ?2, ?3, ?4)",
                                     place, bytes, size, fault);
}

int iso__gallery_take_out(struct iso_gallery_db *db, const char *sql, enum iso_gallery_kind kind,
                          int64_t id, struct iso_fault *fault)
{
    sqlite3_stmt *query = NULL;
    int step = SQLITE_DONE;
    int error = iso__gallery_prepare(db, sql, &query, fault);
    if (error) {
        return error;
    }
    (void)sqlite3_bind_int64(query, 1, id);
    while ((step = sqlite3_step(query)) == SQLITE_ROW) {
        const struct iso_gallery_place place = iso__gallery_place_of(query, kind);
        const void *record = sqlite3_column_blob(query, 3);
        iso_gallery_record_toggle(&db->seal, &place, record ? record : "",
                                  (size_t)sqlite3_column_bytes(query, 3), db->draft.digest);
    }
    error = step == SQLITE_DONE ? 0 : iso__gallery_fail(db, fault);
    (void)sqlite3_finalize(query);
    return error;
}

static const char the_person[] = "SELECT id, 0, 0, record FROM person WHERE id = ?1";
static const char their_templates[] =
    "SELECT id, person_id, algorithm, record FROM template WHERE person_id = ?1";

static int update_person(struct iso_gallery_db *db, const struct iso_person *person,
                         struct iso_fault *fault)
{
    const struct iso_gallery_place place = {.number = person->id};
    uint8_t plain[ISO_GALLERY_PERSON_BYTES];
    int error = iso__gallery_take_out(db, the_person, ISO_GALLERY_PERSON, person->id, fault);
    if (error) {
        return error;
    }
    iso_gallery_person_put(person, plain);
    error = iso__gallery_write_record(db, "UPDATE person SET record = ?4 WHERE id = ?1", &place,
                                      plain, sizeof plain, fault);
    sodium_memzero(plain, sizeof plain);
    return error;
}

int iso_gallery_db_put_person(struct iso_gallery_db *db, const struct iso_person *person,
                              int64_t *id, struct iso_fault *fault)
{
    const int64_t number = person->id ? person->id : (int64_t)db->draft.next;
    const int error = person->id ? update_person(db, person, fault)
                                 : iso__gallery_insert_person(db, number, person, fault);
    if (!error) {
        db->draft.next += person->id ? 0 : 1;
        *id = number;
    }
    return error;
}

int iso_gallery_db_put_template(struct iso_gallery_db *db, int64_t person_id, uint32_t algorithm,
                                const void *bytes, size_t size, int64_t *number,
                                struct iso_fault *fault)
{
    const struct iso_gallery_place place = {.kind = ISO_GALLERY_TEMPLATE,
                                            .number = (int64_t)db->draft.next,
                                            .person = person_id,
                                            .algorithm = algorithm};
    const int error = iso__gallery_insert_template(db, &place, bytes, size, fault);
    db->draft.next += error ? 0 : 1;
    *number = place.number;
    return error;
}

int iso_gallery_db_drop_person(struct iso_gallery_db *db, int64_t id, struct iso_fault *fault)
{
    sqlite3_stmt *statement = NULL;
    int error = iso_gallery_db_put_access(db, id, NULL, 0, fault);
    if (!error) {
        error = iso__gallery_take_out(db, their_templates, ISO_GALLERY_TEMPLATE, id, fault);
    }
    if (!error) {
        error = iso__gallery_take_out(db, the_person, ISO_GALLERY_PERSON, id, fault);
    }
    if (!error) {
        error = iso__gallery_prepare(db, "DELETE FROM person WHERE id = ?1", &statement, fault);
    }
    if (error) {
        return error;
    }
    (void)sqlite3_bind_int64(statement, 1, id);
    return iso__gallery_finish(db, statement, fault);
}
