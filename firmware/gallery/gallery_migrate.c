/* Seals a gallery of version 1, which was not sealed:
 *
 *   person    id, name, enrolled_s, valid_from_s, valid_until_s
 *   template  id, person_id, algorithm, bytes
 *
 * First the anchor notes that sealing is under way. If the daemon is killed at any moment, either
 * the old database is there, and sealing begins again, or the new one is. Every number is kept. The
 * old file is overwritten; copies that a flash memory keeps elsewhere cannot be reached. */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "drivers/file/data_file.h"
#include "drivers/file/file.h"
#include "firmware/gallery/gallery_db_state.h"

static int copy_person(const struct iso_gallery_db *from, sqlite3_stmt *row,
                       struct iso_gallery_db *to, struct iso_fault *fault)
{
    const unsigned char *name = sqlite3_column_text(row, 1);
    struct iso_person person = {
        .id = sqlite3_column_int64(row, 0),
        .enrolled_s = sqlite3_column_int64(row, 2),
        .valid_from_s = sqlite3_column_int64(row, 3),
        .valid_until_s = sqlite3_column_int64(row, 4),
    };
    if (person.id < 1 || !name || !iso_person_name_can_be_stored((const char *)name)) {
        return iso_gallery_db_damaged(from, "a person has no valid name", fault);
    }
    (void)snprintf(person.name, sizeof person.name, "%s", (const char *)name);
    if ((uint64_t)person.id >= to->draft.next) {
        to->draft.next = (uint64_t)person.id + 1;
    }
    return iso__gallery_insert_person(to, person.id, &person, fault);
}

static int copy_template(const struct iso_gallery_db *from, sqlite3_stmt *row,
                         struct iso_gallery_db *to, struct iso_fault *fault)
{
    const struct iso_gallery_place place = {.kind = ISO_GALLERY_TEMPLATE,
                                            .number = sqlite3_column_int64(row, 0),
                                            .person = sqlite3_column_int64(row, 1),
                                            .algorithm = (uint32_t)sqlite3_column_int64(row, 2)};
    const void *bytes = sqlite3_column_blob(row, 3);
    const size_t size = (size_t)sqlite3_column_bytes(row, 3);
    struct iso_template_facts facts;
    if (place.number < 1 || place.person < 1 || !bytes || size > ISO_TEMPLATE_BYTES_MAX) {
        return iso_gallery_db_damaged(from, "a template cannot be read", fault);
    }
    const int error = iso_template_check(bytes, size, &facts);
    if (error && error != -EPROTONOSUPPORT) {
        /* A template of a newer format cannot be checked and is kept. */
        return iso_gallery_db_damaged(from, "a template cannot be read", fault);
    }
    if ((uint64_t)place.number >= to->draft.next) {
        to->draft.next = (uint64_t)place.number + 1;
    }
    return iso__gallery_insert_template(to, &place, bytes, size, fault);
}

static int copy_rows(const struct iso_gallery_db *from, struct iso_gallery_db *to, const char *sql,
                     int (*copy)(const struct iso_gallery_db *from, sqlite3_stmt *row,
                                 struct iso_gallery_db *to, struct iso_fault *fault),
                     struct iso_fault *fault)
{
    sqlite3_stmt *query = NULL;
    int step = SQLITE_DONE;
    int error = iso__gallery_prepare(from, sql, &query, fault);
    while (!error && (step = sqlite3_step(query)) == SQLITE_ROW) {
        error = copy(from, query, to, fault);
    }
    if (!error && step != SQLITE_DONE) {
        error = iso__gallery_fail(from, fault);
    }
    (void)sqlite3_finalize(query);
    return error;
}

static int set_anchor(struct iso_gallery_db *db, const uint8_t id[ISO_GALLERY_ID_BYTES],
                      struct iso_fault *fault)
{
    const struct iso_anchor_state state = iso__gallery_anchor_state(0, id, true);
    return db->anchor ? iso_anchor_set(db->anchor, &state, fault)
                      : iso_anchor_make(db->anchor_path, ISO__GALLERY_ANCHOR, db->ring, true,
                                        &state, &db->anchor, fault);
}

static int fill(struct iso_gallery_db *db, struct iso_gallery_db *beside, struct iso_fault *fault)
{
    int error = copy_rows(db, beside,
                          "SELECT id, name, enrolled_s, valid_from_s, valid_until_s FROM person",
                          copy_person, fault);
    if (!error) {
        error = copy_rows(db, beside, "SELECT id, person_id, algorithm, bytes FROM template",
                          copy_template, fault);
    }
    return error ? error : set_anchor(db, beside->seal.gallery, fault);
}

/* The old file is kept open during the exchange, so that it can be overwritten when no name leads
 * to it any more. The locks of SQLite on a file end when any descriptor of it is closed; therefore
 * this descriptor is opened last. */
static int exchange(struct iso_gallery_db *db, struct iso_gallery_db *beside, int error,
                    struct iso_fault *fault)
{
    iso__gallery_disconnect(db);
    int old = -1;
    (void)!iso_file_open(db->path, O_RDWR, ISO_FILE_ANY_SIZE, &old, NULL);
    error = iso__gallery_move_in(db, beside, true, error, fault);
    if (old >= 0) {
        if (!error) {
            iso_data_file_overwrite(old);
        }
        (void)close(old);
    }
    return error;
}

int iso__gallery_migrate(struct iso_gallery_db *db, struct iso_fault *fault)
{
    static const uint8_t nobody[ISO_GALLERY_ID_BYTES];
    struct iso_gallery_db *beside = calloc(1, sizeof *beside);
    if (!beside) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", db->path);
    }
    int error = set_anchor(db, nobody, fault);
    if (!error) {
        error = iso__gallery_make_beside(db, beside, fault);
    }
    if (!error) {
        error = fill(db, beside, fault);
    }
    error = exchange(db, beside, error, fault);
    free(beside);
    return error;
}
