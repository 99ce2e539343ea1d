#include "firmware/gallery_db.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <sqlite3.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "firmware/directory.h"

enum { BUSY_MS = 1000 }; /* somebody may be making a copy */

struct iso_gallery_db {
    sqlite3 *sqlite;
    char *path;
};

/* The journal goes when a change is complete; EXTRA synchronises the directory then, too. Exclusive
 * locking keeps other writers from changing what the memory holds a copy of. */
static const char settings[] = "PRAGMA locking_mode = EXCLUSIVE;"
                               "PRAGMA journal_mode = DELETE;"
                               "PRAGMA synchronous = EXTRA;"
                               "PRAGMA foreign_keys = ON;"
                               "PRAGMA secure_delete = ON;"
                               "PRAGMA trusted_schema = OFF;"
                               "PRAGMA cell_size_check = ON;";

/* AUTOINCREMENT: the audit log speaks of people who are gone; their numbers are not used again. */
static const char schema[] = "BEGIN;"
                             "CREATE TABLE person ("
                             "  id INTEGER PRIMARY KEY AUTOINCREMENT,"
                             "  name TEXT NOT NULL UNIQUE,"
                             "  enrolled_s INTEGER NOT NULL,"
                             "  valid_from_s INTEGER NOT NULL,"
                             "  valid_until_s INTEGER NOT NULL) STRICT;"
                             "CREATE TABLE template ("
                             "  id INTEGER PRIMARY KEY AUTOINCREMENT,"
                             "  person_id INTEGER NOT NULL"
                             "    REFERENCES person (id) ON DELETE CASCADE,"
                             "  algorithm INTEGER NOT NULL,"
                             "  bytes BLOB NOT NULL) STRICT;"
                             "CREATE INDEX template_of_person ON template (person_id);"
                             "PRAGMA application_id = 0x49534f54;"
                             "PRAGMA user_version = 1;"
                             "COMMIT;";

_Static_assert(ISO_GALLERY_APPLICATION_ID == 0x49534f54 && ISO_GALLERY_SCHEMA == 1,
               "the schema's text has to say the same");

/* ---- failures ---- */

int iso_gallery_db_damaged(const struct iso_gallery_db *db, const char *what,
                           struct iso_fault *fault)
{
    return iso_fault_set(fault, -EBADMSG,
                         "%s: damaged (%s); put a copy in its place, or move it away to begin anew",
                         db->path, what);
}

/* A write error is a full disk, too, if it comes from a quota or a limit on files. */
static int io_error(const struct iso_gallery_db *db)
{
    int system_error = 0;
    if (sqlite3_extended_errcode(db->sqlite) != SQLITE_IOERR_WRITE) {
        return -EIO;
    }
    (void)sqlite3_file_control(db->sqlite, "main", SQLITE_FCNTL_LAST_ERRNO, &system_error);
    return system_error == EDQUOT || system_error == EFBIG ? -ENOSPC : -EIO;
}

/* Negative errno of SQLite's last result, with a line for people. */
static int fail(const struct iso_gallery_db *db, struct iso_fault *fault)
{
    const char *said = sqlite3_errmsg(db->sqlite);
    int error;
    switch (sqlite3_errcode(db->sqlite)) {
    case SQLITE_CORRUPT:
        return iso_gallery_db_damaged(db, said, fault);
    case SQLITE_NOTADB:
        return iso_fault_set(fault, -EMEDIUMTYPE, "%s: no gallery, or its beginning is damaged",
                             db->path);
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
        return iso_fault_set(fault, -EBUSY, "%s: another process uses it", db->path);
    case SQLITE_READONLY:
        return iso_fault_set(fault, -EROFS, "%s: cannot be written", db->path);
    case SQLITE_NOMEM:
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", db->path);
    case SQLITE_FULL:
        error = -ENOSPC;
        break;
    default:
        error = io_error(db);
        break;
    }
    return iso_fault_set(fault, error, "%s: %s", db->path,
                         error == -ENOSPC ? "the disk is full; nothing was changed" : said);
}

static int execute(const struct iso_gallery_db *db, const char *sql, struct iso_fault *fault)
{
    return sqlite3_exec(db->sqlite, sql, NULL, NULL, NULL) == SQLITE_OK ? 0 : fail(db, fault);
}

/* ---- making, opening, checking ---- */

static int connect(struct iso_gallery_db *db, const char *path, struct iso_fault *fault)
{
    if (sqlite3_open_v2(path, &db->sqlite, SQLITE_OPEN_READWRITE, NULL) != SQLITE_OK) {
        return db->sqlite ? fail(db, fault) : iso_fault_set(fault, -ENOMEM, "out of memory");
    }
    (void)sqlite3_busy_timeout(db->sqlite, BUSY_MS);
    return execute(db, settings, fault);
}

static void disconnect(struct iso_gallery_db *db)
{
    (void)sqlite3_close(db->sqlite);
    db->sqlite = NULL;
}

/* An empty file of our own, for SQLite to fill in: it would make one that all may read. */
static int make_file(const char *path, struct iso_fault *fault)
{
    if (unlink(path) && errno != ENOENT) {
        return iso_fault_set(fault, -errno, "%s: %m", path);
    }
    const int fd = open(path, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    if (fd < 0) {
        return iso_fault_set(fault, -errno, "%s: %m", path);
    }
    (void)close(fd);
    return 0;
}

/* Makes an empty gallery beside its place, and moves it there when it is whole. */
static int make(struct iso_gallery_db *db, struct iso_fault *fault)
{
    char beside[PATH_MAX], journal[PATH_MAX];
    if (snprintf(journal, sizeof journal, "%s.new-journal", db->path) >= PATH_MAX) {
        return iso_fault_set(fault, -ENAMETOOLONG, "%s: the name is too long", db->path);
    }
    (void)snprintf(beside, sizeof beside, "%.*s", (int)(strlen(journal) - strlen("-journal")),
                   journal);
    (void)unlink(journal); /* of an attempt that was killed */
    int error = make_file(beside, fault);
    if (error) {
        return error;
    }
    error = connect(db, beside, fault);
    if (!error) {
        error = execute(db, schema, fault);
    }
    disconnect(db);
    if (!error && renameat2(AT_FDCWD, beside, AT_FDCWD, db->path, RENAME_NOREPLACE)) {
        error = iso_fault_set(fault, -errno, "%s: %m", db->path);
    }
    if (error) {
        (void)unlink(beside);
        return error;
    }
    return iso_directory_sync(db->path, fault);
}

static int find_or_make(struct iso_gallery_db *db, struct iso_fault *fault)
{
    struct stat status;
    if (stat(db->path, &status) != 0) {
        return errno == ENOENT ? make(db, fault) : iso_fault_set(fault, -errno, "%s: %m", db->path);
    }
    if (!S_ISREG(status.st_mode)) {
        return iso_fault_set(fault, -EMEDIUMTYPE, "%s: not a file", db->path);
    }
    return status.st_size == 0 ? iso_gallery_db_damaged(db, "the file is empty", fault) : 0;
}

/* The first column of the first row: what a check has to say. */
static int ask(const struct iso_gallery_db *db, const char *sql, char *answer, size_t size,
               struct iso_fault *fault)
{
    sqlite3_stmt *query = NULL;
    int error = 0;
    int step = sqlite3_prepare_v2(db->sqlite, sql, -1, &query, NULL);
    step = step == SQLITE_OK ? sqlite3_step(query) : step;
    if (step == SQLITE_ROW) {
        const unsigned char *text = sqlite3_column_text(query, 0);
        (void)snprintf(answer, size, "%s", text ? (const char *)text : "");
    } else if (step == SQLITE_DONE) {
        *answer = '\0';
    } else {
        error = fail(db, fault);
    }
    (void)sqlite3_finalize(query);
    return error;
}

static int check_kind(const struct iso_gallery_db *db, struct iso_fault *fault)
{
    char answer[32];
    int error = ask(db, "PRAGMA application_id", answer, sizeof answer, fault);
    if (error) {
        return error;
    }
    if (atoll(answer) != ISO_GALLERY_APPLICATION_ID) {
        return iso_fault_set(fault, -EMEDIUMTYPE, "%s: a database of another application",
                             db->path);
    }
    error = ask(db, "PRAGMA user_version", answer, sizeof answer, fault);
    if (!error && atoll(answer) != ISO_GALLERY_SCHEMA) {
        error = iso_fault_set(
            fault, -EPROTONOSUPPORT,
            "%s: of version %s, this program knows version %d; install a newer one", db->path,
            answer, ISO_GALLERY_SCHEMA);
    }
    return error;
}

static int check_whole(const struct iso_gallery_db *db, struct iso_fault *fault)
{
    char answer[96];
    int error = ask(db, "PRAGMA integrity_check(1)", answer, sizeof answer, fault);
    if (!error && strcmp(answer, "ok") != 0) {
        answer[strcspn(answer, "\n")] = '\0';
        error = iso_gallery_db_damaged(db, answer, fault);
    }
    if (error) {
        return error;
    }
    error = ask(db, "PRAGMA foreign_key_check", answer, sizeof answer, fault);
    return error || !*answer ? error
                             : iso_gallery_db_damaged(db, "a template belongs to nobody", fault);
}

/* Takes the lock that exclusive locking then keeps, and checks everything under it. */
static int check(const struct iso_gallery_db *db, struct iso_fault *fault)
{
    if (sqlite3_db_readonly(db->sqlite, "main") == 1) {
        return iso_fault_set(fault, -EROFS, "%s: cannot be written", db->path);
    }
    int error = execute(db, "BEGIN EXCLUSIVE", fault);
    if (!error) {
        error = check_kind(db, fault);
    }
    if (!error) {
        error = check_whole(db, fault);
    }
    if (!error) {
        error = execute(db, "COMMIT", fault);
    }
    return error;
}

int iso_gallery_db_open(const char *path, struct iso_gallery_db **out, struct iso_fault *fault)
{
    struct iso_gallery_db *db = calloc(1, sizeof *db);
    if (!db || !(db->path = strdup(path))) {
        free(db);
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", path);
    }
    int error = find_or_make(db, fault);
    if (!error) {
        error = connect(db, path, fault);
    }
    if (!error) {
        error = check(db, fault);
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
        disconnect(db);
        free(db->path);
        free(db);
    }
}

/* ---- reading ---- */

static int visit_person(struct iso_gallery_db *db, sqlite3_stmt *row,
                        const struct iso_gallery_visitor *visitor, struct iso_fault *fault)
{
    const unsigned char *name = sqlite3_column_text(row, 1);
    struct iso_person person = {
        .id = sqlite3_column_int64(row, 0),
        .enrolled_s = sqlite3_column_int64(row, 2),
        .valid_from_s = sqlite3_column_int64(row, 3),
        .valid_until_s = sqlite3_column_int64(row, 4),
    };
    if (!name || iso_person_name_flaw((const char *)name)) {
        return iso_gallery_db_damaged(db, "a person's name is none", fault);
    }
    (void)snprintf(person.name, sizeof person.name, "%s", (const char *)name);
    return visitor->person(visitor->context, &person, fault);
}

static int visit_template(struct iso_gallery_db *db, sqlite3_stmt *row,
                          const struct iso_gallery_visitor *visitor, struct iso_fault *fault)
{
    (void)db;
    const void *bytes = sqlite3_column_blob(row, 2);
    return visitor->template(visitor->context, sqlite3_column_int64(row, 0),
                             (uint32_t)sqlite3_column_int64(row, 1), bytes ? bytes : "",
                             (size_t)sqlite3_column_bytes(row, 2), fault);
}

static int each_row(struct iso_gallery_db *db, const char *sql,
                    int (*visit)(struct iso_gallery_db *db, sqlite3_stmt *row,
                                 const struct iso_gallery_visitor *visitor,
                                 struct iso_fault *fault),
                    const struct iso_gallery_visitor *visitor, struct iso_fault *fault)
{
    sqlite3_stmt *query = NULL;
    int error = 0;
    int step = sqlite3_prepare_v2(db->sqlite, sql, -1, &query, NULL);
    if (step == SQLITE_OK) {
        while (!error && (step = sqlite3_step(query)) == SQLITE_ROW) {
            error = visit(db, query, visitor, fault);
        }
    }
    if (!error && step != SQLITE_DONE) {
        error = fail(db, fault);
    }
    (void)sqlite3_finalize(query);
    return error;
}

int iso_gallery_db_load(struct iso_gallery_db *db, const struct iso_gallery_visitor *visitor,
                        struct iso_fault *fault)
{
    const int error = each_row(db,
                               "SELECT id, name, enrolled_s, valid_from_s, valid_until_s "
                               "FROM person ORDER BY id",
                               visit_person, visitor, fault);
    return error ? error
                 : each_row(db,
                            "SELECT person_id, algorithm, bytes FROM template "
                            "ORDER BY person_id, id",
                            visit_template, visitor, fault);
}

/* ---- writing ---- */

/* Runs a prepared statement to its end and finalizes it. */
static int finish(struct iso_gallery_db *db, sqlite3_stmt *statement, struct iso_fault *fault)
{
    const int step = sqlite3_step(statement);
    const int error = step == SQLITE_DONE ? 0 : fail(db, fault);
    (void)sqlite3_finalize(statement);
    return error;
}

static int prepare(struct iso_gallery_db *db, const char *sql, sqlite3_stmt **out,
                   struct iso_fault *fault)
{
    return sqlite3_prepare_v2(db->sqlite, sql, -1, out, NULL) == SQLITE_OK ? 0 : fail(db, fault);
}

/* Leaves no transaction open: some failures have rolled it back already. */
static int end(struct iso_gallery_db *db, int error, struct iso_fault *fault)
{
    if (!error) {
        error = execute(db, "COMMIT", fault);
    }
    if (error && !sqlite3_get_autocommit(db->sqlite)) {
        (void)sqlite3_exec(db->sqlite, "ROLLBACK", NULL, NULL, NULL);
    }
    return error;
}

static int write_person(struct iso_gallery_db *db, const struct iso_person *person, int64_t *id,
                        struct iso_fault *fault)
{
    sqlite3_stmt *statement = NULL;
    int error = prepare(db,
                        person->id ? "UPDATE person SET valid_from_s = ?3, valid_until_s = ?4 "
                                     "WHERE id = ?5"
                                   : "INSERT INTO person (name, enrolled_s, valid_from_s, "
                                     "valid_until_s) VALUES (?1, ?2, ?3, ?4)",
                        &statement, fault);
    if (error) {
        return error;
    }
    if (person->id) {
        (void)sqlite3_bind_int64(statement, 5, person->id);
    } else {
        (void)sqlite3_bind_text(statement, 1, person->name, -1, SQLITE_STATIC);
        (void)sqlite3_bind_int64(statement, 2, person->enrolled_s);
    }
    (void)sqlite3_bind_int64(statement, 3, person->valid_from_s);
    (void)sqlite3_bind_int64(statement, 4, person->valid_until_s);
    error = finish(db, statement, fault);
    if (!error) {
        *id = person->id ? person->id : sqlite3_last_insert_rowid(db->sqlite);
    }
    return error;
}

static int write_template(struct iso_gallery_db *db, int64_t person_id, uint32_t algorithm,
                          const void *bytes, size_t size, struct iso_fault *fault)
{
    sqlite3_stmt *statement = NULL;
    const int error = prepare(
        db, "INSERT INTO template (person_id, algorithm, bytes) VALUES (?1, ?2, ?3)", &statement,
        fault);
    if (error) {
        return error;
    }
    (void)sqlite3_bind_int64(statement, 1, person_id);
    (void)sqlite3_bind_int64(statement, 2, algorithm);
    (void)sqlite3_bind_blob64(statement, 3, bytes, size, SQLITE_STATIC);
    return finish(db, statement, fault);
}

int iso_gallery_db_add(struct iso_gallery_db *db, const struct iso_person *person,
                       uint32_t algorithm, const void *bytes, size_t size, int64_t *id,
                       struct iso_fault *fault)
{
    int64_t written = 0;
    int error = execute(db, "BEGIN IMMEDIATE", fault);
    if (error) {
        return error;
    }
    error = write_person(db, person, &written, fault);
    if (!error) {
        error = write_template(db, written, algorithm, bytes, size, fault);
    }
    error = end(db, error, fault);
    if (!error) {
        *id = written;
    }
    return error;
}

int iso_gallery_db_remove(struct iso_gallery_db *db, int64_t id, struct iso_fault *fault)
{
    sqlite3_stmt *statement = NULL;
    int error = prepare(db, "DELETE FROM person WHERE id = ?1", &statement, fault);
    if (error) {
        return error;
    }
    (void)sqlite3_bind_int64(statement, 1, id);
    return finish(db, statement, fault);
}
