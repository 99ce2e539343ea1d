/* The state of an open database of the gallery. Internal to firmware/gallery. */
#ifndef ISO_FIRMWARE_GALLERY_GALLERY_DB_STATE_H
#define ISO_FIRMWARE_GALLERY_GALLERY_DB_STATE_H

#include <sqlite3.h>
#include <stdbool.h>

#include "firmware/audit/anchor.h"
#include "firmware/gallery/gallery_db.h"
#include "firmware/gallery/gallery_seal.h"
#include "firmware/keys/key_ring.h"

struct iso_gallery_db {
    sqlite3 *sqlite;
    char *path, *anchor_path;
    struct iso_key_ring *ring;
    struct iso_anchor *anchor;
    struct iso_gallery_seal seal;
    struct iso_gallery_head head, draft;  /* on the disk; with the changes of a transaction */
    const struct iso_metric *metric;      /* of the stored vectors; NULL: none are used */
    uint32_t algorithm;                   /* of the templates that have vectors */
    uint8_t print[ISO_SEAL_DIGEST_BYTES]; /* digest of that metric */
    bool has_vectors;                     /* the table of vectors exists */
    uint64_t vectors_read;                /* the templates read so far that have a stored vector */
    bool marks;                           /* enrolments are marked, because the metric adapts */
    bool lost;                   /* the contents of the disk are not known (gallery_truth.c) */
    struct iso_fault lost_fault; /* the reason for `lost` */
    /* Room for one record. */
    uint8_t plain[ISO_TEMPLATE_BYTES_MAX], sealed[ISO_GALLERY_TEMPLATE_SEALED];
};

/* The kind of a gallery's anchor. Its extra bytes are the gallery's id and then a byte that is 1
 * while a database of version 1 is being sealed. */
#define ISO__GALLERY_ANCHOR "gallery"

/* The state of an anchor with these contents; and whether the anchor says that a database of
 * version 1 is being sealed. */
struct iso_anchor_state iso__gallery_anchor_state(uint64_t changes,
                                                  const uint8_t id[ISO_GALLERY_ID_BYTES],
                                                  bool sealing);
bool iso__gallery_anchor_is_sealing(const struct iso_gallery_db *db);

/* ---- SQLite, with its failures in words (gallery_sql.c) ---- */

/* Sets the fault of the last error of SQLite. Returns it as a negative errno. */
int iso__gallery_fail(const struct iso_gallery_db *db, struct iso_fault *fault);

/* Runs SQL text, or prepares one statement, which the caller finalizes. Errors of
 * iso__gallery_fail. */
int iso__gallery_execute(const struct iso_gallery_db *db, const char *sql, struct iso_fault *fault);
int iso__gallery_prepare(const struct iso_gallery_db *db, const char *sql, sqlite3_stmt **out,
                         struct iso_fault *fault);

/* Runs a prepared statement to its end and finalizes it. */
int iso__gallery_finish(const struct iso_gallery_db *db, sqlite3_stmt *statement,
                        struct iso_fault *fault);

/* Writes the first column of the first row of a query as text; "" if there is no row. */
int iso__gallery_ask(const struct iso_gallery_db *db, const char *sql, char *answer, size_t size,
                     struct iso_fault *fault);

/* Opens the file at `path` with SQLite, which must be a regular file. -EMEDIUMTYPE, or an errno of
 * opening it. */
int iso__gallery_connect(struct iso_gallery_db *db, const char *path, struct iso_fault *fault);
void iso__gallery_disconnect(struct iso_gallery_db *db);

/* ---- what the disk holds (gallery_truth.c, gallery_db.c) ---- */

/* Called after `error` of a change whose outcome is not known, with *fault set. Reads the outcome
 * from the disk. Returns 0 if the change is on the disk, `error` if it is not, and -EIO if this
 * cannot be found out; then the database is out of service. */
int iso__gallery_settle(struct iso_gallery_db *db, int error, struct iso_fault *fault);

/* 0, or -EIO while the database is out of service. */
int iso__gallery_in_service(const struct iso_gallery_db *db, struct iso_fault *fault);

/* Reads the head row with the key that it names; within a transaction. */
int iso__gallery_read_head(struct iso_gallery_db *db, struct iso_fault *fault);

/* Compares the head with the anchor. The head may be one change ahead of it; the anchor is then
 * written before the next change, and not here. It is written here only at the end of the sealing
 * of version 1. -ESTALE, or an error of writing it. */
int iso__gallery_check_anchor(struct iso_gallery_db *db, struct iso_fault *fault);

/* ---- making a database (gallery_make.c) ---- */

/* Makes an empty gallery if there is none. Its anchor is written first, because a database without
 * an anchor is not trusted. -ESTALE: there is no gallery, but the anchor of one that has changed,
 * so the gallery was removed. */
int iso__gallery_find_or_make(struct iso_gallery_db *db, struct iso_fault *fault);

/* Writes the head row from the draft; within a transaction. */
int iso__gallery_insert_head(struct iso_gallery_db *db, struct iso_fault *fault);

/* Makes an empty database of the present version under another name (PATH.new), connected as
 * `beside`, which is otherwise empty. A transaction is open then. */
int iso__gallery_make_beside(struct iso_gallery_db *db, struct iso_gallery_db *beside,
                             struct iso_fault *fault);

/* Ends its transaction with the head in place, and moves it to its place; replaces an existing one
 * only if `replace` is set. Returns the earlier error or its own. After an error nothing of it is
 * left, unless it was moved and only the directory could not be synchronised. */
int iso__gallery_move_in(struct iso_gallery_db *db, struct iso_gallery_db *beside, bool replace,
                         int error, struct iso_fault *fault);

/* ---- version 1 (gallery_migrate.c) ---- */

/* Replaces the connected database of version 1 by a sealed one, which is not connected then. */
int iso__gallery_migrate(struct iso_gallery_db *db, struct iso_fault *fault);

/* ---- rows (rows/gallery_rows.c) ---- */

/* The place of a record, from the first columns of its row: id, person_id, algorithm. */
struct iso_gallery_place iso__gallery_place_of(sqlite3_stmt *row, enum iso_gallery_kind kind);

/* The fault of a record that is not what was stored. Returns -EBADMSG. */
int iso__gallery_changed(const struct iso_gallery_db *db, const char *kind, int64_t number,
                         struct iso_fault *fault);

/* Inserts a template with its number, or a person. The digest of the draft is updated. */
int iso__gallery_insert_person(struct iso_gallery_db *db, int64_t id,
                               const struct iso_person *person, struct iso_fault *fault);
int iso__gallery_insert_template(struct iso_gallery_db *db, const struct iso_gallery_place *place,
                                 const void *bytes, size_t size, struct iso_fault *fault);

/* Seals a record, adds it to the draft's digest, and runs a statement with it: ?1 number, ?2 person
 * and ?3 algorithm of its place, ?4 the sealed record. */
int iso__gallery_write_record(struct iso_gallery_db *db, const char *sql,
                              const struct iso_gallery_place *place, const void *plain, size_t size,
                              struct iso_fault *fault);

/* Removes the rows that a query finds (id, person_id, algorithm, record) for its parameter `id`
 * from the draft's digest. */
int iso__gallery_take_out(struct iso_gallery_db *db, const char *sql, enum iso_gallery_kind kind,
                          int64_t id, struct iso_fault *fault);

/* Takes a metric into use for stored vectors; NULL: none. Looks whether their table exists. */
void iso__gallery_use_metric(struct iso_gallery_db *db, const struct iso_metric *metric,
                             uint32_t algorithm);
int iso__gallery_find_vectors(struct iso_gallery_db *db, struct iso_fault *fault);

/* Opens the stored vector of a row (the columns of a template's row, then the sealed vector).
 * Returns false if there is none for the metric in use and for this very record of the template;
 * otherwise the record is sound, and is added to the digest. (rows/gallery_vector_rows.c) */
bool iso__gallery_stored_vector(const struct iso_gallery_db *db, sqlite3_stmt *row,
                                const struct iso_gallery_place *place, uint8_t *digest,
                                struct iso_gallery_vector *out);

/* Whether a row of a template has a stored vector, of whatever metric. */
bool iso__gallery_has_vector(sqlite3_stmt *row);

/* Expects this number of stored vectors, which all templates together have. -EBADMSG if there is
 * another number, as with a vector of somebody who was removed; or an error of SQLite. */
int iso__gallery_count_vectors(const struct iso_gallery_db *db, uint64_t n,
                               struct iso_fault *fault);

/* Deletes all stored vectors; within a transaction. */
int iso__gallery_drop_vectors(struct iso_gallery_db *db, struct iso_fault *fault);

/* Rolls the transaction back. Returns true if it is certainly undone, and the database is as before
 * it. If the transaction is no longer open, SQLite has ended it because of an error of the disk,
 * and the result is false. (gallery_db.c) */
bool iso__gallery_roll_back(struct iso_gallery_db *db);

/* Looks whether the table of access records exists. (gallery_access_rows.c) */
int iso__gallery_find_access(struct iso_gallery_db *db, struct iso_fault *fault);

#endif
