/* The rows of access records (gallery.h). The table is made by the first of them, so that a gallery
 * that never had one can still be read by earlier programs. */
#include <errno.h>
#include <string.h>

#include "firmware/gallery/gallery_db_state.h"

int iso__gallery_find_access(struct iso_gallery_db *db, struct iso_fault *fault)
{
    char answer[8];
    const int error = iso__gallery_ask(
        db, "SELECT 1 FROM sqlite_schema WHERE type = 'table' AND name = 'access'", answer,
        sizeof answer, fault);
    if (!error) {
        db->head.has_access = db->draft.has_access = *answer != '\0';
    }
    return error;
}

static int make_table(struct iso_gallery_db *db, struct iso_fault *fault)
{
    static const char sql[] = "CREATE TABLE IF NOT EXISTS access ("
                              "  id INTEGER PRIMARY KEY,"
                              "  person_id INTEGER NOT NULL,"
                              "  part INTEGER NOT NULL,"
                              "  record BLOB NOT NULL,"
                              "  UNIQUE (person_id, part)) STRICT";
    const int error = iso__gallery_execute(db, sql, fault);
    if (!error) {
        db->draft.has_access = true;
    }
    return error;
}

static int delete_parts(struct iso_gallery_db *db, int64_t person_id, struct iso_fault *fault)
{
    sqlite3_stmt *statement = NULL;
    int error = iso__gallery_take_out(
        db, "SELECT id, person_id, part, record FROM access WHERE person_id = ?1",
        ISO_GALLERY_ACCESS, person_id, fault);
    if (!error) {
        error = iso__gallery_prepare(db, "DELETE FROM access WHERE person_id = ?1", &statement,
                                     fault);
    }
    if (error) {
        return error;
    }
    (void)sqlite3_bind_int64(statement, 1, person_id);
    return iso__gallery_finish(db, statement, fault);
}

static int insert_parts(struct iso_gallery_db *db, int64_t person_id, const uint8_t *bytes,
                        size_t size, struct iso_fault *fault)
{
    int error = 0;
    struct iso_gallery_place place = {.kind = ISO_GALLERY_ACCESS, .person = person_id};
    for (size_t at = 0; !error && at < size; at += ISO_TEMPLATE_BYTES_MAX) {
        const size_t left = size - at;
        place.number = (int64_t)db->draft.next++;
        error = iso__gallery_write_record(
            db, "INSERT INTO access (id, person_id, part, record) VALUES (?1, ?2, ?3, ?4)", &place,
            bytes + at, left < ISO_TEMPLATE_BYTES_MAX ? left : ISO_TEMPLATE_BYTES_MAX, fault);
        place.algorithm++;
    }
    return error;
}

int iso_gallery_db_put_access(struct iso_gallery_db *db, int64_t person_id, const void *bytes,
                              size_t size, struct iso_fault *fault)
{
    int error = 0;
    if (size > 0 && !db->draft.has_access) {
        error = make_table(db, fault);
    }
    if (!error && db->draft.has_access) {
        error = delete_parts(db, person_id, fault);
    }
    return error ? error : insert_parts(db, person_id, bytes, size, fault);
}
