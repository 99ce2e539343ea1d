#include "firmware/gallery/gallery_db.h"

#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "firmware/gallery/gallery_db_state.h"

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

/* Compares the head on the disk with the anchor. The head may be the same or one change ahead. In
 * the second case the anchor is written before the next change, and not here, because it may be an
 * old anchor; the other stores can tell. */
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

/* Tells the board what the gallery and its anchor know of the other stores, and the count of the
 * gallery, which is the value of the anchor. If another store knows a higher count while the head
 * is ahead of the anchor, the anchor is the old file. */
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

/* ---- checking ---- */

/* *version is the version of the schema: 1, or a sealed one up to ISO_GALLERY_SCHEMA. */
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
    if (!error && (*version < 1 || *version > ISO_GALLERY_SCHEMA)) {
        error = iso_fault_set_code(
            fault, ISO_FAULT_STORE_NEWER, -EPROTONOSUPPORT,
            "%s: of version %s, this program knows version %d; install a newer one", db->path,
            answer, ISO_GALLERY_SCHEMA);
    }
    return error;
}

/* Of a sealed gallery, the loading that follows finds templates of nobody (gallery_load.c) and
 * vectors of no template (iso_gallery_db_load). SQLite's foreign_key_check would read all of them
 * once more.
 */
static int check_whole(const struct iso_gallery_db *db, int version, struct iso_fault *fault)
{
    char answer[96];
    int error = iso__gallery_ask(db, "PRAGMA integrity_check(1)", answer, sizeof answer, fault);
    if (!error && strcmp(answer, "ok") != 0) {
        answer[strcspn(answer, "\n")] = '\0';
        error = iso_gallery_db_damaged(db, answer, fault);
    }
    if (error || version >= ISO_GALLERY_SCHEMA_SEALED) {
        return error;
    }
    error = iso__gallery_ask(db, "PRAGMA foreign_key_check", answer, sizeof answer, fault);
    return error || !*answer ? error
                             : iso_gallery_db_damaged(db, "a template belongs to nobody", fault);
}

/* Checks and reads the head row with the key that it names. */
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

/* Takes the lock, which exclusive locking then keeps, and checks the contents of the database. */
static int check_database(struct iso_gallery_db *db, int *version, struct iso_fault *fault)
{
    if (sqlite3_db_readonly(db->sqlite, "main") == 1) {
        return iso_fault_set_code(fault, ISO_FAULT_DISK_READ_ONLY, -EROFS, "%s: cannot be written",
                                  db->path);
    }
    int error = iso__gallery_execute(db, "BEGIN EXCLUSIVE", fault);
    if (!error) {
        error = check_kind(db, version, fault);
    }
    if (!error) {
        error = check_whole(db, *version, fault);
    }
    if (!error && *version >= ISO_GALLERY_SCHEMA_SEALED) {
        error = iso__gallery_read_head(db, fault);
    }
    if (!error) {
        error = iso__gallery_find_access(db, fault);
    }
    if (!error) {
        error = iso__gallery_find_vectors(db, fault);
    }
    return error ? error : iso__gallery_execute(db, "COMMIT", fault);
}

/* ---- opening ---- */

/* A gallery of version 1 is sealed only while nothing of this appliance is sealed. Later, an
 * attacker may have put it there. */
static int may_migrate(const struct iso_gallery_db *db, bool wanted, struct iso_fault *fault)
{
    const bool first = !db->anchor && iso_key_ring_newest(db->ring, ISO_KEY_GALLERY) == 0;
    if (wanted && (first || iso__gallery_anchor_is_sealing(db))) {
        return 0;
    }
    return iso_fault_set_code(
        fault, ISO_FAULT_STORE_UNSEALED, -ESTALE, "%s: an unsealed gallery, %s", db->path,
        wanted ? "where there was a sealed one" : "and [seal] migrate = no does not accept it");
}

static int connect_and_check(struct iso_gallery_db *db, bool migrate, struct iso_fault *fault)
{
    int version = 0;
    int error = iso__gallery_connect(db, db->path, fault);
    if (!error) {
        error = check_database(db, &version, fault);
    }
    if (error || version >= ISO_GALLERY_SCHEMA_SEALED) {
        return error;
    }
    error = may_migrate(db, migrate, fault);
    if (!error) {
        error = iso__gallery_migrate(db, fault);
    }
    if (!error) {
        error = iso__gallery_connect(db, db->path, fault);
    }
    return error ? error : check_database(db, &version, fault);
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
    db->marks = options->metric && options->adapt;
    iso__gallery_use_metric(db, options->metric, options->algorithm);
    int error = open_anchor(db, fault);
    if (!error) {
        error = iso__gallery_find_or_make(db, fault);
    }
    if (!error) {
        error = connect_and_check(db, options->migrate, fault);
    }
    if (!error) {
        error = iso__gallery_check_anchor(db, fault);
    }
    if (!error) {
        tell_heads(db);
        /* A rotation that was interrupted may have left keys. */
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

bool iso__gallery_roll_back(struct iso_gallery_db *db)
{
    return !sqlite3_get_autocommit(db->sqlite) && iso__gallery_execute(db, "ROLLBACK", NULL) == 0;
}

/* An anchor that cannot be written now is written before the next change. */
int iso_gallery_db_end(struct iso_gallery_db *db, int error, struct iso_fault *fault)
{
    bool tried = false;
    db->draft.changes++;
    if (!error) {
        error = iso__gallery_insert_head(db, fault);
    }
    if (!error) {
        tried = true;
        error = iso__gallery_execute(db, "COMMIT", fault);
    }
    if (error && !tried && iso__gallery_roll_back(db)) {
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
    return error ? error : write_anchor(db, fault); /* the second write fills the other slot */
}

struct iso_gallery_version iso_gallery_db_version(const struct iso_gallery_db *db)
{
    struct iso_gallery_version version = {.changes = db->head.changes};
    (void)sodium_bin2hex(version.gallery, sizeof version.gallery, db->seal.gallery,
                         (sizeof version.gallery - 1) / 2);
    return version;
}

/* ---- the templates that teach ---- */

struct iso_site_record *iso_gallery_db_site(struct iso_gallery_db *db)
{
    return &db->draft.site;
}

void iso_gallery_db_mark(struct iso_gallery_db *db)
{
    if (db->marks) {
        iso_site_record_mark(&db->draft.site, db->draft.next);
    }
}

uint64_t iso_gallery_db_next(const struct iso_gallery_db *db)
{
    return db->draft.next;
}
