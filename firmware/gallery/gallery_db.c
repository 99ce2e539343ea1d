#include "firmware/gallery/gallery_db.h"

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

_Static_assert(ISO_GALLERY_APPLICATION_ID == 0x49534f54 && ISO_GALLERY_SCHEMA == 2,
               "the schema's text has to say the same");

/* ---- the anchor ---- */

struct iso_anchor_state iso__gallery_anchor_state(uint64_t changes,
                                                  const uint8_t id[ISO_GALLERY_ID_BYTES],
                                                  bool sealing)
{
    struct iso_anchor_state state = {.value = changes};
    memcpy(state.extra, id, ISO_GALLERY_ID_BYTES);
    state.extra[ISO_GALLERY_ID_BYTES] = sealing;
    return state;
}

bool iso__gallery_anchor_is_sealing(const struct iso_gallery_db *db)
{
    return db->anchor && iso_anchor_state(db->anchor)->extra[ISO_GALLERY_ID_BYTES];
}

static int write_anchor(struct iso_gallery_db *db, struct iso_fault *fault)
{
    const struct iso_anchor_state state = iso__gallery_anchor_state(db->head.changes,
                                                                    db->seal.gallery, false);
    const int error = iso_anchor_set(db->anchor, &state, fault);
    if (!error) {
        iso_heads_wrote(iso_key_ring_board(db->ring), ISO_HEAD_GALLERY, state.value, NULL);
    }
    return error;
}

/* The head on the disk against the anchor: the same, or one change ahead. Then the anchor follows
 * before the next change, and not here: it may be an old one, which the other stores know. */
int iso__gallery_check_anchor(struct iso_gallery_db *db, struct iso_fault *fault)
{
    if (!db->anchor) {
        return iso_fault_set_code(
            fault, ISO_FAULT_ANCHOR_DAMAGED, -ESTALE,
            "%s: its anchor %s is gone; it cannot be told whether this is the "
            "newest gallery",
            db->path, db->anchor_path);
    }
    const struct iso_anchor_state *anchor = iso_anchor_state(db->anchor);
    if (memcmp(anchor->extra, db->seal.gallery, ISO_GALLERY_ID_BYTES) != 0) {
        return iso_fault_set_code(fault, ISO_FAULT_GALLERY_OLD, -ESTALE,
                                  "%s: another gallery than that of %s", db->path, db->anchor_path);
    }
    if (db->head.changes < anchor->value) {
        return iso_fault_set_code(
            fault, ISO_FAULT_GALLERY_OLD, -ESTALE,
            "%s: an old gallery, %llu changes behind; put the newest in its place", db->path,
            (unsigned long long)(anchor->value - db->head.changes));
    }
    if (db->head.changes > anchor->value + 1) {
        return iso_fault_set_code(fault, ISO_FAULT_GALLERY_OLD, -ESTALE,
                                  "%s: an old anchor; put the newest in its place",
                                  db->anchor_path);
    }
    return iso__gallery_anchor_is_sealing(db) ? write_anchor(db, fault) : 0;
}

/* What gallery and anchor know of the others, and what the others have to know of them. If one is
 * behind, it is the anchor. */
static void tell_heads(const struct iso_gallery_db *db)
{
    struct iso_heads_board *board = iso_key_ring_board(db->ring);
    const struct iso_anchor_state *anchor = iso_anchor_state(db->anchor);
    iso_heads_found(board, ISO_HEAD_GALLERY,
                    db->head.changes > anchor->value ? db->anchor_path : db->path, anchor->value);
    iso_heads_claim(board, db->path, &db->head.known);
    iso_heads_claim(board, db->anchor_path, iso_anchor_known(db->anchor));
}

static int open_anchor(struct iso_gallery_db *db, struct iso_fault *fault)
{
    const int error = iso_anchor_open(db->anchor_path, ISO__GALLERY_ANCHOR, db->ring, true,
                                      &db->anchor, fault);
    return error == -ENOENT ? 0 : error;
}

/* ---- making ---- */

/* An empty file of our own, for SQLite to fill in: it would make one that all may read. */
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
    (void)unlink(journal); /* of an attempt that was killed */
    int error = new_seal(db, &beside->seal, fault);
    error = error ? error : make_file(path, fault);
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

static int insert_head(struct iso_gallery_db *db, struct iso_fault *fault)
{
    uint8_t sealed[ISO_GALLERY_HEAD_SEALED];
    sqlite3_stmt *statement = NULL;
    const int error = iso__gallery_prepare(
        db, "INSERT OR REPLACE INTO head (id, gallery, key, record) VALUES (1, ?1, ?2, ?3)",
        &statement, fault);
    if (error) {
        return error;
    }
    db->draft.known = iso_heads_now(iso_key_ring_board(db->ring));
    iso_gallery_head_close(&db->seal, &db->draft, sealed);
    (void)sqlite3_bind_blob(statement, 1, db->seal.gallery, ISO_GALLERY_ID_BYTES, SQLITE_STATIC);
    (void)sqlite3_bind_int64(statement, 2, db->seal.key_number);
    (void)sqlite3_bind_blob(statement, 3, sealed, sizeof sealed, SQLITE_STATIC);
    return iso__gallery_finish(db, statement, fault);
}

int iso__gallery_move_in(struct iso_gallery_db *db, struct iso_gallery_db *beside, bool replace,
                         int error, struct iso_fault *fault)
{
    error = error ? error : insert_head(beside, fault);
    error = error ? error : iso__gallery_execute(beside, "COMMIT", fault);
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

/* Makes an empty gallery. Its anchor comes first: a database without one is not trusted. */
static int make(struct iso_gallery_db *db, struct iso_fault *fault)
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

/* An anchor of a gallery that has changed, and no gallery: it was taken away. */
static int find_or_make(struct iso_gallery_db *db, struct iso_fault *fault)
{
    struct stat status;
    if (lstat(db->path, &status) != 0) {
        if (errno != ENOENT) {
            return iso_file_fault(db->path, -errno, fault);
        }
        return db->anchor && iso_anchor_state(db->anchor)->value > 0
                   ? iso_fault_set_code(
                         fault, ISO_FAULT_GALLERY_MISSING, -ESTALE,
                         "%s: is gone; put it back, or move %s away (see --accept-state)", db->path,
                         db->anchor_path)
                   : make(db, fault);
    }
    return S_ISREG(status.st_mode) && status.st_size == 0
               ? iso_gallery_db_damaged(db, "the file is empty", fault)
               : 0;
}

/* ---- checking ---- */

/* *version is that of the schema: 1 or ISO_GALLERY_SCHEMA. */
static int check_kind(const struct iso_gallery_db *db, int *version, struct iso_fault *fault)
{
    char answer[32];
    int error = iso__gallery_ask(db, "PRAGMA application_id", answer, sizeof answer, fault);
    if (error) {
        return error;
    }
    if (atoll(answer) != ISO_GALLERY_APPLICATION_ID) {
        return iso_fault_set_code(fault, ISO_FAULT_GALLERY_DAMAGED, -EMEDIUMTYPE,
                                  "%s: a database of another application", db->path);
    }
    error = iso__gallery_ask(db, "PRAGMA user_version", answer, sizeof answer, fault);
    *version = atoi(answer);
    if (!error && *version != 1 && *version != ISO_GALLERY_SCHEMA) {
        error = iso_fault_set_code(
            fault, ISO_FAULT_STORE_NEWER, -EPROTONOSUPPORT,
            "%s: of version %s, this program knows version %d; install a newer one", db->path,
            answer, ISO_GALLERY_SCHEMA);
    }
    return error;
}

static int check_whole(const struct iso_gallery_db *db, struct iso_fault *fault)
{
    char answer[96];
    int error = iso__gallery_ask(db, "PRAGMA integrity_check(1)", answer, sizeof answer, fault);
    if (!error && strcmp(answer, "ok") != 0) {
        answer[strcspn(answer, "\n")] = '\0';
        error = iso_gallery_db_damaged(db, answer, fault);
    }
    if (error) {
        return error;
    }
    error = iso__gallery_ask(db, "PRAGMA foreign_key_check", answer, sizeof answer, fault);
    return error || !*answer ? error
                             : iso_gallery_db_damaged(db, "a template belongs to nobody", fault);
}

/* The head row, under the key that it names. */
static int take_head(struct iso_gallery_db *db, sqlite3_stmt *row, struct iso_fault *fault)
{
    const void *id = sqlite3_column_blob(row, 0), *record = sqlite3_column_blob(row, 2);
    const uint32_t number = (uint32_t)sqlite3_column_int64(row, 1);
    const struct iso_seal_key *key = iso_key_ring_find(db->ring, ISO_KEY_GALLERY, number);
    if (!id || sqlite3_column_bytes(row, 0) != ISO_GALLERY_ID_BYTES) {
        return iso_gallery_db_damaged(db, "the gallery has no name", fault);
    }
    if (!key) {
        return iso_fault_set_code(fault, ISO_FAULT_KEY_WRONG, -EKEYREJECTED,
                                  "%s: the key ring has no key %u; an old gallery, or another ring",
                                  db->path, number);
    }
    db->seal = iso_gallery_seal_of(id, number, key);
    if (!record ||
        iso_gallery_head_open(&db->seal, record, (size_t)sqlite3_column_bytes(row, 2), &db->head)) {
        return iso_gallery_db_damaged(db, "the head is not what was stored", fault);
    }
    db->draft = db->head;
    return 0;
}

int iso__gallery_read_head(struct iso_gallery_db *db, struct iso_fault *fault)
{
    sqlite3_stmt *query = NULL;
    int error = iso__gallery_prepare(db, "SELECT gallery, key, record FROM head", &query, fault);
    if (error) {
        return error;
    }
    const int step = sqlite3_step(query);
    if (step == SQLITE_ROW) {
        error = take_head(db, query, fault);
    } else {
        error = step == SQLITE_DONE ? iso_gallery_db_damaged(db, "there is no head", fault)
                                    : iso__gallery_fail(db, fault);
    }
    (void)sqlite3_finalize(query);
    return error;
}

/* Takes the lock that exclusive locking then keeps, and checks what is under it. */
static int check(struct iso_gallery_db *db, int *version, struct iso_fault *fault)
{
    if (sqlite3_db_readonly(db->sqlite, "main") == 1) {
        return iso_fault_set_code(fault, ISO_FAULT_DISK_READ_ONLY, -EROFS, "%s: cannot be written",
                                  db->path);
    }
    int error = iso__gallery_execute(db, "BEGIN EXCLUSIVE", fault);
    error = error ? error : check_kind(db, version, fault);
    error = error ? error : check_whole(db, fault);
    if (!error && *version == ISO_GALLERY_SCHEMA) {
        error = iso__gallery_read_head(db, fault);
    }
    return error ? error : iso__gallery_execute(db, "COMMIT", fault);
}

/* ---- opening ---- */

/* A gallery of version 1 is sealed once, when nothing of this appliance was sealed yet: later it
 * would be one that somebody has put there. */
static int may_migrate(const struct iso_gallery_db *db, bool wanted, struct iso_fault *fault)
{
    const bool first = !db->anchor && iso_key_ring_newest(db->ring, ISO_KEY_GALLERY) == 0;
    if (wanted && (first || iso__gallery_anchor_is_sealing(db))) {
        return 0;
    }
    return iso_fault_set_code(
        fault, ISO_FAULT_STORE_UNSEALED, -ESTALE, "%s: an unsealed gallery, %s", db->path,
        wanted ? "where there was a sealed one" : "which [seal] migrate = no does not take");
}

static int connect_and_check(struct iso_gallery_db *db, bool migrate, struct iso_fault *fault)
{
    int version = 0;
    int error = iso__gallery_connect(db, db->path, fault);
    error = error ? error : check(db, &version, fault);
    if (error || version == ISO_GALLERY_SCHEMA) {
        return error;
    }
    error = may_migrate(db, migrate, fault);
    error = error ? error : iso__gallery_migrate(db, fault);
    error = error ? error : iso__gallery_connect(db, db->path, fault);
    return error ? error : check(db, &version, fault);
}

int iso_gallery_db_open(const struct iso_gallery_options *options, struct iso_gallery_db **out,
                        struct iso_fault *fault)
{
    struct iso_gallery_db *db = calloc(1, sizeof *db);
    if (!db || !(db->path = strdup(options->path)) ||
        asprintf(&db->anchor_path, "%s.anchor", options->path) < 0) {
        free(db ? db->path : NULL);
        free(db);
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", options->path);
    }
    db->ring = options->ring;
    int error = open_anchor(db, fault);
    error = error ? error : find_or_make(db, fault);
    error = error ? error : connect_and_check(db, options->migrate, fault);
    error = error ? error : iso__gallery_check_anchor(db, fault);
    if (!error) {
        tell_heads(db);
    }
    if (!error) { /* of a rotation that was cut short */
        error = iso_key_ring_drop(db->ring, ISO_KEY_GALLERY, db->seal.key_number, fault);
    }
    if (error) {
        iso_gallery_db_close(db);
        return error;
    }
    *out = db;
    return 0;
}

void iso_gallery_db_close(struct iso_gallery_db *db)
{
    if (db) {
        iso__gallery_disconnect(db);
        iso_anchor_close(db->anchor);
        free(db->path);
        free(db->anchor_path);
        sodium_memzero(db, sizeof *db);
        free(db);
    }
}

/* ---- transactions ---- */

int iso_gallery_db_begin(struct iso_gallery_db *db, struct iso_fault *fault)
{
    if (db->lost) {
        return iso__gallery_in_service(db, fault);
    }
    if (db->head.changes > iso_anchor_state(db->anchor)->value) {
        const int error = write_anchor(db, fault);
        if (error) {
            return error;
        }
    }
    db->draft = db->head;
    return iso__gallery_execute(db, "BEGIN IMMEDIATE", fault);
}

/* Whether the transaction is certainly gone, and the database as before it. A transaction that is
 * open no more was ended by SQLite, because of an error of the disk. */
static bool roll_back(struct iso_gallery_db *db)
{
    return !sqlite3_get_autocommit(db->sqlite) && iso__gallery_execute(db, "ROLLBACK", NULL) == 0;
}

/* An anchor that cannot be written is written before the next change. */
int iso_gallery_db_end(struct iso_gallery_db *db, int error, struct iso_fault *fault)
{
    bool tried = false;
    db->draft.changes++;
    error = error ? error : insert_head(db, fault);
    if (!error) {
        tried = true;
        error = iso__gallery_execute(db, "COMMIT", fault);
    }
    if (error && !tried && roll_back(db)) {
        db->draft = db->head;
        return error;
    }
    error = error ? iso__gallery_settle(db, error, fault) : 0;
    if (error) {
        return error;
    }
    db->head = db->draft;
    (void)!write_anchor(db, NULL);
    return 0;
}

int iso_gallery_db_renew_anchor(struct iso_gallery_db *db, struct iso_fault *fault)
{
    const int error = write_anchor(db, fault);
    return error ? error : write_anchor(db, fault); /* both of its slots */
}

struct iso_gallery_version iso_gallery_db_version(const struct iso_gallery_db *db)
{
    struct iso_gallery_version version = {.changes = db->head.changes};
    (void)sodium_bin2hex(version.gallery, sizeof version.gallery, db->seal.gallery,
                         (sizeof version.gallery - 1) / 2);
    return version;
}
