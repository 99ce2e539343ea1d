/* Makes a database for the gallery: an empty one, or a new one that replaces another. */
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "drivers/file/directory.h"
#include "drivers/file/file.h"
#include "firmware/gallery/gallery_db_state.h"

static const char schema[] = "BEGIN EXCLUSIVE;"
                             "CREATE TABLE head ("
                             "  id INTEGER PRIMARY KEY CHECK (id = 1),"
                             "  gallery BLOB NOT NULL,"
                             "  key INTEGER NOT NULL,"
                             "  record BLOB NOT NULL) STRICT;"
                             "CREATE TABLE person ("
                             "  id INTEGER PRIMARY KEY,"
                             "  record BLOB NOT NULL) STRICT;"
                             "CREATE TABLE template ("
                             "  id INTEGER PRIMARY KEY,"
                             "  person_id INTEGER NOT NULL"
                             "    REFERENCES person (id) ON DELETE CASCADE,"
                             "  algorithm INTEGER NOT NULL,"
                             "  record BLOB NOT NULL) STRICT;"
                             "CREATE INDEX template_of_person ON template (person_id);"
                             "PRAGMA application_id = 0x49534f54;"
                             "PRAGMA user_version = 2;";

_Static_assert(ISO_GALLERY_APPLICATION_ID == 0x49534f54 && ISO_GALLERY_SCHEMA_SEALED == 2,
               "the schema's text has to say the same");

/* Makes an empty private file for SQLite, which would itself make a file that everybody can
 * read. */
static int make_file(const char *path, struct iso_fault *fault)
{
    if (unlink(path) && errno != ENOENT) {
        return iso_file_fault(path, -errno, fault);
    }
    int fd = -1;
    const int error = iso_file_open(path, O_RDWR | O_CREAT | O_EXCL, ISO_FILE_ANY_SIZE, &fd, fault);
    if (!error) {
        (void)close(fd);
    }
    return error;
}

static int new_seal(struct iso_gallery_db *db, struct iso_gallery_seal *out,
                    struct iso_fault *fault)
{
    uint8_t id[ISO_GALLERY_ID_BYTES];
    uint32_t number = iso_key_ring_newest(db->ring, ISO_KEY_GALLERY);
    const int error = number ? 0 : iso_key_ring_add(db->ring, ISO_KEY_GALLERY, &number, fault);
    if (!error) {
        randombytes_buf(id, sizeof id);
        *out = iso_gallery_seal_of(id, number,
                                   iso_key_ring_find(db->ring, ISO_KEY_GALLERY, number));
    }
    return error;
}

int iso__gallery_make_beside(struct iso_gallery_db *db, struct iso_gallery_db *beside,
                             struct iso_fault *fault)
{
    char path[PATH_MAX], journal[PATH_MAX];
    if (snprintf(journal, sizeof journal, "%s.new-journal", db->path) >= PATH_MAX) {
        return iso_fault_set(fault, -ENAMETOOLONG, "%s: the name is too long", db->path);
    }
    (void)snprintf(path, sizeof path, "%.*s", (int)(strlen(journal) - strlen("-journal")), journal);
    /* The journal of an earlier attempt that was killed may remain. */
    (void)unlink(journal);
    int error = new_seal(db, &beside->seal, fault);
    if (!error) {
        error = make_file(path, fault);
    }
    if (error) {
        return error;
    }
    beside->path = strdup(path);
    if (!beside->path) {
        (void)unlink(path);
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", db->path);
    }
    beside->ring = db->ring;
    beside->draft.next = 1;
    error = iso__gallery_connect(beside, path, fault);
    return error ? error : iso__gallery_execute(beside, schema, fault);
}

int iso__gallery_insert_head(struct iso_gallery_db *db, struct iso_fault *fault)
{
    uint8_t sealed[ISO_GALLERY_HEAD_SEALED];
    sqlite3_stmt *statement = NULL;
    char version[40];
    (void)snprintf(version, sizeof version, "PRAGMA user_version = %d",
                   iso_gallery_head_version(&db->draft));
    int error = iso__gallery_execute(db, version, fault);
    if (error) {
        return error;
    }
    error = iso__gallery_prepare(
        db, "INSERT OR REPLACE INTO head (id, gallery, key, record) VALUES (1, ?1, ?2, ?3)",
        &statement, fault);
    if (error) {
        return error;
    }
    db->draft.known = iso_heads_now(iso_key_ring_board(db->ring));
    const size_t size = iso_gallery_head_close(&db->seal, &db->draft, sealed);
    (void)sqlite3_bind_blob(statement, 1, db->seal.gallery, ISO_GALLERY_ID_BYTES, SQLITE_STATIC);
    (void)sqlite3_bind_int64(statement, 2, db->seal.key_number);
    (void)sqlite3_bind_blob(statement, 3, sealed, (int)size, SQLITE_STATIC);
    return iso__gallery_finish(db, statement, fault);
}

int iso__gallery_move_in(struct iso_gallery_db *db, struct iso_gallery_db *beside, bool replace,
                         int error, struct iso_fault *fault)
{
    if (!error) {
        error = iso__gallery_insert_head(beside, fault);
    }
    if (!error) {
        error = iso__gallery_execute(beside, "COMMIT", fault);
    }
    iso__gallery_disconnect(beside);
    iso_gallery_seal_wipe(&beside->seal);
    if (beside->path) {
        if (!error &&
            renameat2(AT_FDCWD, beside->path, AT_FDCWD, db->path, replace ? 0 : RENAME_NOREPLACE)) {
            error = iso_file_fault(db->path, -errno, fault);
        }
        if (error) {
            (void)unlink(beside->path);
        }
        free(beside->path);
        beside->path = NULL;
    }
    return error ? error : iso_directory_sync(db->path, fault);
}

/* Makes an empty gallery. Its anchor is written first, because a database without an anchor is not
 * trusted. */
static int make_empty(struct iso_gallery_db *db, struct iso_fault *fault)
{
    struct iso_gallery_db *beside = calloc(1, sizeof *beside);
    if (!beside) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", db->path);
    }
    int error = iso__gallery_make_beside(db, beside, fault);
    if (!error) {
        const struct iso_anchor_state state = iso__gallery_anchor_state(0, beside->seal.gallery,
                                                                        false);
        iso_anchor_close(db->anchor);
        db->anchor = NULL;
        error = iso_anchor_make(db->anchor_path, ISO__GALLERY_ANCHOR, db->ring, true, &state,
                                &db->anchor, fault);
    }
    error = iso__gallery_move_in(db, beside, false, error, fault);
    free(beside);
    return error;
}

int iso__gallery_find_or_make(struct iso_gallery_db *db, struct iso_fault *fault)
{
    struct stat status;
    if (lstat(db->path, &status) != 0) {
        if (errno != ENOENT) {
            return iso_file_fault(db->path, -errno, fault);
        }
        if (db->anchor && iso_anchor_state(db->anchor)->value > 0) {
            return iso_fault_set_code(
                fault, ISO_FAULT_GALLERY_MISSING, -ESTALE,
                "%s: is gone; put it back, or move %s away (see --accept-state)", db->path,
                db->anchor_path);
        }
        return make_empty(db, fault);
    }
    return S_ISREG(status.st_mode) && status.st_size == 0
               ? iso_gallery_db_damaged(db, "the file is empty", fault)
               : 0;
}
